// Emission without absorption: the integral of extinction times colour, both linear between knots, is exact.
uniform samplerBuffer intervals; // as in exact.glsl

const float OPACITY = 0.0; // of what gather gives as its fourth component

vec4 gather(float front, float back, float len, ivec2 range, out vec2 seen) {
  float delta = back - front;
  bool up = delta >= 0.0;
  int i = up ? range.x : range.y;
  int last = up ? range.y : range.x;
  float inverse = (up ? 1.0 : -1.0) / max(abs(delta), 1.0e-30);
  float begin = 0.0;
  vec4 sum = vec4(0.0); // the fourth: the integral of extinction, for highlights
  seen = vec2(1.0, 0.0);
  for (;;) {
    vec4 span = texelFetch(intervals, 3 * i);
    vec4 low = texelFetch(intervals, 3 * i + 1);
    vec4 high = texelFetch(intervals, 3 * i + 2);
    float end = i == last ? 1.0 : clamp(((up ? span.y : span.x) - front) * inverse, begin, 1.0);
    if (end > begin) {
      vec4 f = mix(low, high, clamp((front + begin * delta - span.x) * span.z, 0.0, 1.0));
      vec4 b = mix(low, high, clamp((front + end * delta - span.x) * span.z, 0.0, 1.0));
      sum.xyz += (len * (end - begin) / 6.0) * (f.xyz * (2.0 * f.w + b.w) + b.xyz * (f.w + 2.0 * b.w));
      sum.w += 0.5 * len * (end - begin) * (f.w + b.w);
      if (f.w + b.w > 0.0) seen = vec2(min(seen.x, begin), end);
    }
    if (i == last || end >= 1.0) break;
    i += up ? 1 : -1;
    begin = end;
  }
  return sum;
}
