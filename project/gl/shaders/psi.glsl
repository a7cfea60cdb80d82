// Integration by psi (Moreland, Angel): split at the knots as in exact.glsl, but each piece, however deep, is looked up
// in a table that holds for every transfer function (optics/psi.h).
uniform samplerBuffer intervals; // as in exact.glsl
uniform sampler2D psi;           // means of w and w^2 over what is seen, by depth and by share of the back's extinction

const float OPACITY = 1.0;
const float OPAQUE = 1.0e-7;
const float DEEP = 1.0e15;

Part integrate(float front, float back, float len, ivec2 range) {
  vec2 size = vec2(textureSize(psi, 0));
  float delta = back - front;
  bool up = delta >= 0.0;
  int i = up ? range.x : range.y;
  int last = up ? range.y : range.x;
  float inverse = (up ? 1.0 : -1.0) / max(abs(delta), 1.0e-30);
  float begin = 0.0;
  float through = 1.0;
  vec3 whole = vec3(0.0), at_back = vec3(0.0), moments = vec3(0.0);
  vec2 seen = vec2(1.0, 0.0);
  for (;;) {
    vec4 span = texelFetch(intervals, 3 * i);
    vec4 low = texelFetch(intervals, 3 * i + 1);
    vec4 high = texelFetch(intervals, 3 * i + 2);
    float end = i == last ? 1.0 : clamp(((up ? span.y : span.x) - front) * inverse, begin, 1.0);
    if (end > begin) {
      vec4 f = mix(low, high, clamp((front + begin * delta - span.x) * span.z, 0.0, 1.0));
      vec4 b = mix(low, high, clamp((front + end * delta - span.x) * span.z, 0.0, 1.0));
      float sum = f.w + b.w;
      float depth = min(0.5 * sum * len * (end - begin), DEEP);
      float root = sqrt(depth);
      vec2 at = vec2(root / (1.0 + root), sum > 0.0 ? b.w / sum : 0.5);
      vec2 mean = texture(psi, (at * (size - 1.0) + 0.5) / size).xy;
      float opacity = through * loss_of(depth);
      if (sum > 0.0) seen = vec2(min(seen.x, begin), end);
      vec3 colour = mix(f.xyz, b.xyz, mean.x);
      whole += opacity * colour;
#ifdef LIT
      vec3 tilted = f.xyz * (mean.x - mean.y) + b.xyz * mean.y; // the mean of w times the colour
      at_back += opacity * (begin * colour + (end - begin) * tilted);
      float width = end - begin, centre = begin + width * mean.x;
      moments += opacity * vec3(1.0, centre, centre * centre + width * width * max(mean.y - mean.x * mean.x, 0.0));
#else
      moments.x += opacity;
#endif
      through -= opacity;
      if (through <= OPAQUE) break;
    }
    if (i == last || end >= 1.0) break;
    i += up ? 1 : -1;
    begin = end;
  }
  float centre = moments.x > 0.0 ? moments.y / moments.x : 0.5;
  float variance = moments.x > 0.0 ? moments.z / moments.x - centre * centre : 0.0;
  return Part(whole - at_back, at_back, moments.x, centre, sqrt(max(variance, 0.0)), seen);
}
