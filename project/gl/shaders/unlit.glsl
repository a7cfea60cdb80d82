// A segment without light, by an integrator that gives a Part.
vec4 gather(float front, float back, float len, ivec2 range, out vec2 seen) {
  Part part = integrate(front, back, len, range);
  seen = part.seen;
  return vec4(part.front + part.back, part.opacity);
}
