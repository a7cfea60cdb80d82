// Cells that lie in front of each other in a circle [C 4], a few of them: on each pixel, the first member that the ray
// meets draws the whole group, in the order of the depths there; the others draw nothing.

layout(location = 0) out vec4 result;
#ifdef WITH_DEPTH
layout(location = 1) out vec4 depth;
#endif

const int MOST = 16; // members, as GL_SMALL_GROUP

void main() {
  vec4 colours[MOST]; // near to far
  float places[MOST];
  int count = 0;
  int first = -1;
  vec2 all_ends = vec2(-BIG, 0.0);
  ivec2 group = ivec2(texelFetch(extras, 4 * record + 3).xy);
  for (int member = group.x; member < group.x + group.y; member++) {
    segment met;
    vec4 colour;
    vec2 ends;
    if (!meet(member, gl_FragCoord.xy, met) || met.range.y < met.range.x || !shade(met, colour, ends)) continue;
    if (count == 0) first = member;
    float place = middle_depth(met);
    int at = count;
    for (; at > 0 && places[at - 1] > place; at--) {
      colours[at] = colours[at - 1];
      places[at] = places[at - 1];
    }
    colours[at] = colour;
    places[at] = place;
    count++;
    all_ends = max(all_ends, ends);
  }
  if (first != record) discard;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; i++) sum += (1.0 - sum.w) * colours[i];
  result = sum;
#ifdef WITH_DEPTH
  depth = vec4(all_ends, 0.0, 0.0);
#endif
}
