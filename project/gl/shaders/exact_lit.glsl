// Exact integration for light: like exact.glsl, with the moments that light needs. On a piece of linear extinction, at
// most THICK deep, Gauss's rule of four points is good to 3e-7 of the opacity; it gives them all at once. With EMISSION
// nothing is absorbed, and the rule is exact.
uniform samplerBuffer intervals; // as in exact.glsl

#ifdef EMISSION
const float OPACITY = 0.0;
#else
const float OPACITY = 1.0;
#endif
const float THICK = 0.5;
const float OPAQUE = 1.0e-7;
const float DEEP = 1.0e15;

const vec4 NODE = vec4(0.0694318442, 0.330009478, 0.669990522, 0.930568156);
const vec4 WEIGHT = vec4(0.173927423, 0.326072577, 0.326072577, 0.173927423);

Part integrate(float front, float back, float len, ivec2 range) {
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
      float a_depth = min(f.w * len * (end - begin), DEEP);
      float b_depth = min(b.w * len * (end - begin), DEEP);
#ifdef EMISSION
      bool cut = false;
      vec4 emitted = WEIGHT * mix(vec4(a_depth), vec4(b_depth), NODE);
#else
      bool cut = a_depth + b_depth > 2.0 * THICK;
      if (cut) {
        float part = 2.0 * THICK / (a_depth + sqrt(a_depth * a_depth + 2.0 * (b_depth - a_depth) * THICK));
        float cut_end = begin + part * (end - begin);
        b_depth = part * mix(a_depth, b_depth, part);
        a_depth *= part;
        b = mix(f, b, part);
        if (!(cut_end > begin)) { // too deep to tell begin and end apart: opaque here
          whole += through * f.xyz;
          at_back += through * begin * f.xyz;
          moments += through * vec3(1.0, begin, begin * begin);
          seen = vec2(min(seen.x, begin), end);
          break;
        }
        end = cut_end;
      }
      vec4 depth = NODE * (a_depth + 0.5 * (b_depth - a_depth) * NODE);
      vec4 emitted = through * WEIGHT * mix(vec4(a_depth), vec4(b_depth), NODE) * exp(-depth);
      through *= exp(-0.5 * (a_depth + b_depth));
#endif
      if (f.w + b.w > 0.0) seen = vec2(min(seen.x, begin), end);
      vec4 w = mix(vec4(begin), vec4(end), NODE);
      float first = dot(emitted, vec4(1.0)), second = dot(emitted, w), tilt = dot(emitted, NODE);
      float second_tilt = dot(emitted * w, NODE);
      whole += first * f.xyz + tilt * (b.xyz - f.xyz);
      at_back += second * f.xyz + second_tilt * (b.xyz - f.xyz);
      moments += vec3(first, second, dot(emitted, w * w));
      if (cut) {
        begin = end;
        if (through > OPAQUE) continue;
        break;
      }
    }
    if (i == last || end >= 1.0) break;
    i += up ? 1 : -1;
    begin = end;
  }
  float centre = moments.x > 0.0 ? moments.y / moments.x : 0.5;
  float variance = moments.x > 0.0 ? moments.z / moments.x - centre * centre : 0.0;
  return Part(whole - at_back, at_back, moments.x, centre, sqrt(max(variance, 0.0)), seen);
}
