// What an integrator gives: Part integrate(float front, float back, float len, ivec2 range), where front and back are
// scaled scalars and range are the intervals of the transfer function that the cell touches.
struct Part {
  vec3 front, back;     // colour weighted by 1-w and by w, w = 0..1 from front to back: their sum is the colour
  float opacity;        // the integral of what is emitted, colours left aside
  float centre, spread; // mean and standard deviation of the w that it comes from
  vec2 seen;            // where it begins and ends; begins after it ends if there is nothing
};

// 1 - exp(-m), also of thin pieces to float's digits.
float loss_of(float m) {
  float thin = m * (1.0 - m * (0.5 - m * (1.66666667e-1 - m * (4.16666667e-2 - m * 8.33333333e-3))));
  return m < 0.25 ? thin : 1.0 - exp(-m);
}
