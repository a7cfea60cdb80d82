// Maximum intensity: the largest scalar of the ray, blended by its maximum; the processor gives it its colour.
const float OPACITY = 1.0; // of what gather gives as its fourth component

vec4 gather(float front, float back, float len, ivec2 range, out vec2 seen) {
  seen = vec2(0.0, 1.0);
  return vec4(max(front, back), 0.0, 0.0, 1.0);
}
