// Blends a layer over what is behind it.
uniform sampler2D layer_colour, last_layer;

layout(location = 0) out vec4 result;
#ifdef WITH_DEPTH
layout(location = 1) out vec4 depth;
#endif

void main() {
  vec4 placed = texelFetch(last_layer, ivec2(gl_FragCoord.xy), 0);
  if (placed.y == 0.0) discard;
  result = texelFetch(layer_colour, ivec2(gl_FragCoord.xy), 0);
#ifdef WITH_DEPTH
  depth = vec4(placed.zw, 0.0, 0.0);
#endif
}
