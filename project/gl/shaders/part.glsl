// What an integrator gives: Part integrate(float front, float back, float len, ivec2 range), where range are the
// intervals of the transfer function that the cell touches.
// What a ray gathers on a stretch of a segment.
struct Part {
  vec3 front, back;     // colour weighted by 1-w and by w, w = 0..1 from front to back: their sum is the colour
  float opacity;        // the integral of what is emitted, colours left aside
  float centre, spread; // mean and standard deviation of the w that it comes from
  vec2 seen;            // where it begins and ends; begins after it ends if there is nothing
};
