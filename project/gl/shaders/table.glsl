// Pre-integration [C 8]: one look-up of the segment's scalars and length in tables made for the transfer function
// (cellist/preintegration.h). They hold colours as seen, and the density for a length unit; the opacity is made here.
uniform sampler3D ambient_table; // R G B, density
#ifdef LIT
uniform sampler3D front_table;   // R G B weighted by 1-w, mean of w
uniform sampler3D back_table;    // R G B weighted by w, standard deviation of w
#endif
uniform float per_length_unit;

const float OPACITY = 1.0;
const float OPAQUE = 1.0e-7;

Part integrate(float front, float back, float len, ivec2 range) {
  vec3 size = vec3(textureSize(ambient_table, 0));
  float scaled = len * per_length_unit;
  vec3 at = vec3(1.0 - exp2(-scaled), 0.5 + 0.5 * front, 0.5 + 0.5 * back);
  at = (at * (size - 1.0) + 0.5) / size; // nodes at both ends
  vec4 ambient = texture(ambient_table, at);
  float opacity = loss_of(ambient.w * scaled);
  vec2 seen = opacity > 0.0 ? vec2(0.0, 1.0) : vec2(1.0, 0.0);
#ifdef LIT
  vec4 at_front = texture(front_table, at);
  vec4 at_back = texture(back_table, at);
  return Part(opacity * at_front.xyz, opacity * at_back.xyz, opacity, at_front.w, at_back.w, seen);
#else
  return Part(opacity * ambient.xyz, vec3(0.0), opacity, 0.5, 0.0, seen);
#endif
}
