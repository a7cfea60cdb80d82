// What a ray gathers in a cell, exactly for a piecewise linear transfer function: the segment is split where the
// scalar crosses a knot, and each piece has a closed form. Premultiplied colour and opacity.
//
// Three texels an interval between knots: its ends and 1 / width, colour and extinction at the lower end, at the upper.
uniform samplerBuffer intervals;

// exp(x) for x <= 0, to 2e-7 relative on every driver (llvmpipe's own has 20 bits).
float exp_negative(float x) {
  float k = floor(x * 1.44269504 + 0.5);
  float r = x - k * 0.693359375 + k * 2.12194440e-4;
  float p = 1.0 + r * (1.0 + r * (0.5 + r * (1.66666667e-1 + r * (4.16666667e-2 + r * (8.33333333e-3 + r * 1.38888889e-3)))));
  return p * intBitsToFloat((int(max(k, -126.0)) + 127) << 23);
}

// exp(x^2) erfc(x) for x >= 0: (1 + 2x) times it is a polynomial of (x-2)/(x+2), fitted at Chebyshev points; 2e-7.
float erfcx(float x) {
  float y = (x - 2.0) / (x + 2.0);
  float p = 6.33694584e-05;
  p = p * y + 0.000160803582;
  p = p * y - 0.000357920448;
  p = p * y - 0.00139570695;
  p = p * y + 0.00121741059;
  p = p * y + 0.00868915966;
  p = p * y - 0.00801896308;
  p = p * y - 0.0542119585;
  p = p * y + 0.164049454;
  p = p * y - 0.166031096;
  p = p * y - 0.0927637628;
  p = p * y + 1.27697839;
  return p / (1.0 + 2.0 * x);
}

// Dawson's integral for x >= 0: (1 + 2x^2)/x times it is a polynomial of (x^2-5)/(x^2+5); 1.2e-6.
float dawson(float x) {
  float q = x * x;
  float y = (q - 5.0) / (q + 5.0);
  float p = -0.106672597;
  p = p * y - 0.0220915281;
  p = p * y + 0.544832167;
  p = p * y + 0.17736538;
  p = p * y - 1.17557806;
  p = p * y - 0.57962765;
  p = p * y + 1.35527915;
  p = p * y + 1.06557447;
  p = p * y - 0.792886613;
  p = p * y - 1.29814224;
  p = p * y - 0.026670039;
  p = p * y + 1.28430179;
  p = p * y + 0.488567721;
  p = p * y - 1.53342351;
  p = p * y + 0.399339825;
  p = p * y + 0.633288354;
  p = p * y - 0.686211791;
  p = p * y + 1.27275524;
  return p * x / (1.0 + 2.0 * q);
}

// Depth above which the closed form is used, below it the series: at 0.5 both err by some 1e-7 of the opacity. The
// closed form loses digits as the depth shrinks, the series (cut at 5th order) as it grows.
const float THICK = 0.5;
// Depths are cut here: nothing behind is seen, and larger ones would overflow.
const float DEEP = 1.0e6;

// Of a piece whose optical depth would be a if its front end's extinction held along it and b with its back end's:
// opacity = 1 - exp(-m), m = (a+b)/2, and skew = weight of the back colour - weight of the front colour, where
// the piece's colour is (opacity (c_f + c_b) + skew (c_b - c_f)) / 2.
//
// Series: with v = -1..1 along the piece, d = (b-a)/2 and E = d/4, skew = exp(-m/2) times the integral over 0..1 of
// (d v^2 cosh(mv/2) - m v sinh(mv/2)) exp(E (1-v^2)), expanded in E and m^2/4; the moments are Beta functions.
vec2 piece_weights(float a, float b) {
  float m = 0.5 * (a + b);
  float scale = min(1.0, DEEP / max(m, 1.0));
  a *= scale;
  b *= scale;
  m *= scale;
  float d = 0.5 * (b - a);
  float h = 0.5 * min(m, THICK);
  float loss = h * (1.0 - h * (0.5 - h * (1.66666667e-1 - h * (4.16666667e-2 - h * (8.33333333e-3 - h * 1.38888889e-3)))));
  float E = 0.25 * d, x = h * h, mm = m * m;
  float by_d = 0.333333333 + x * (0.1 + x * 0.00595238095) +
               E * (0.133333333 + x * (0.0285714286 + x * 0.00132275132) +
                    E * (0.0380952381 + x * 0.00634920635 + E * (0.00846560847 + E * 0.00153920154)));
  float by_m = 0.166666667 + x * (0.0166666667 + x * 0.000595238095) +
               E * (0.0666666667 + x * 0.00476190476 + E * (0.019047619 + x * 0.00105820106 + E * 0.00423280423));
  vec2 weights = vec2(loss * (2.0 - loss), (1.0 - loss) * (d * by_d - mm * by_m));
  // A loop, not a branch: llvmpipe runs both sides of a branch for every pixel, but skips a loop that none enters.
  for (bool thick = m > THICK; thick; thick = false) {
    float zeta = exp_negative(-m);
    // Below 1e-6 of the depth the difference cannot be told from 0 in float.
    float D = max(abs(b - a), 1.0e-6 * m);
    float root = inversesqrt(2.0 * D);
    float psi = b >= a ? 1.77245385 * root * (erfcx(a * root) - zeta * erfcx(b * root))
                       : 2.0 * root * (dawson(a * root) - zeta * dawson(b * root));
    weights = vec2(1.0 - zeta, 2.0 * psi - 1.0 - zeta);
  }
  return weights;
}

// range: the intervals that the cell's scalars touch. seen: where on the segment the first contribution begins and
// the last one ends, 0..1 from front to back; begins after it ends if there is none.
vec4 gather(float front, float back, float len, ivec2 range, out vec2 seen) {
  float delta = back - front;
  bool up = delta >= 0.0;
  int i = up ? range.x : range.y;
  int last = up ? range.y : range.x;
  // 1e-30: a scalar that is constant along the ray lies before or behind a knot, never on the way.
  float inverse = (up ? 1.0 : -1.0) / max(abs(delta), 1.0e-30);
  float begin = 0.0;
  vec4 sum = vec4(0.0);
  seen = vec2(1.0, 0.0);
  for (;;) {
    vec4 span = texelFetch(intervals, 3 * i);
    vec4 low = texelFetch(intervals, 3 * i + 1);
    vec4 high = texelFetch(intervals, 3 * i + 2);
    float end = i == last ? 1.0 : clamp(((up ? span.y : span.x) - front) * inverse, begin, 1.0);
    if (end > begin) {
      vec4 f = mix(low, high, clamp((front + begin * delta - span.x) * span.z, 0.0, 1.0));
      vec4 b = mix(low, high, clamp((front + end * delta - span.x) * span.z, 0.0, 1.0));
      float piece = len * (end - begin);
      vec2 weights = piece_weights(f.w * piece, b.w * piece);
      float through = 1.0 - sum.w;
      sum.xyz += 0.5 * through * (weights.x * (f.xyz + b.xyz) + weights.y * (b.xyz - f.xyz));
      sum.w += through * weights.x;
      if (f.w + b.w > 0.0) seen = vec2(min(seen.x, begin), end);
    }
    if (i == last || end >= 1.0) break;
    i += up ? 1 : -1;
    begin = end;
  }
  return sum;
}
