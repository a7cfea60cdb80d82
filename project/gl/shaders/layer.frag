// The next layer of a group of many cells from the far side, where there is no OpenGL 4.3: of what lies before the last
// layer the depth test keeps the farthest; of one depth, the cell that is drawn first.
uniform int first_record;     // number of record 0 in the group
uniform sampler2D last_layer; // its places and cells
uniform float place_scale;    // a power of two: places become 0..1 without rounding

layout(location = 0) out vec4 result;
layout(location = 1) out vec4 placed; // depth, number of the cell, -depth of the first contribution, depth of the last

void main() {
  segment met;
  vec2 ends;
  if (!meet_here(met) || !shade(met, result, ends)) discard;
  float place = middle_depth(met);
  float cell = float(first_record + record + 1);
  vec2 last = texelFetch(last_layer, ivec2(gl_FragCoord.xy), 0).xy;
  if (!(place < last.x || (place == last.x && cell > last.y))) discard;
  placed = vec4(place, cell, ends);
  gl_FragDepth = place * place_scale;
}
