// What a ray gathers in a cell, exactly for a piecewise linear transfer function: the segment is split where the
// scalar crosses a knot, and each piece has a closed form. Premultiplied colour and opacity.
//
// Three texels an interval between knots: its ends and 1 / width, colour and extinction at the lower end, at the upper.
// LITTLE: the cell lies in one interval or two, which its corners hand on, and no segment is deeper than THICK.
#ifndef LITTLE
uniform samplerBuffer intervals;
#endif

const float OPACITY = 1.0; // of what gather gives as its fourth component

// Depth above which a piece is cut: there the series (of 5th order) errs by some 1e-7 of the opacity. It replaces the
// closed form with erfcx and Dawson's function, which cost a fifth of the frame for pieces that are rare.
const float THICK = 0.5;
// What is seen through less is not seen.
const float OPAQUE = 1.0e-7;
// Depths are cut here, so that their squares fit a float.
const float DEEP = 1.0e15;

// Of a piece whose optical depth would be a if its front end's extinction held along it and b with its back end's:
// opacity = 1 - exp(-m), m = (a+b)/2, and skew = weight of the back colour - weight of the front colour, where
// the piece's colour is (opacity (c_f + c_b) + skew (c_b - c_f)) / 2. For m up to THICK.
//
// Series: with v = -1..1 along the piece, d = (b-a)/2 and E = d/4, skew = exp(-m/2) times the integral over 0..1 of
// (d v^2 cosh(mv/2) - m v sinh(mv/2)) exp(E (1-v^2)), expanded in E and m^2/4; the moments are Beta functions.
vec2 piece_weights(float a, float b) {
  float m = 0.5 * (a + b);
  float d = 0.5 * (b - a);
  float h = 0.5 * m, E = 0.25 * d, x = h * h, EE = E * E, mm = m * m;
  // In short chains, which processors work on side by side.
  float loss = h * ((1.0 - h * 0.5) + x * ((1.66666667e-1 - h * 4.16666667e-2) + x * (8.33333333e-3 - h * 1.38888889e-3)));
  float by_d = (0.333333333 + x * (0.1 + x * 0.00595238095)) +
               E * (0.133333333 + x * (0.0285714286 + x * 0.00132275132)) +
               EE * ((0.0380952381 + x * 0.00634920635) + E * (0.00846560847 + E * 0.00153920154));
  float by_m = (0.166666667 + x * (0.0166666667 + x * 0.000595238095)) +
               E * (0.0666666667 + x * 0.00476190476) + EE * ((0.019047619 + x * 0.00105820106) + E * 0.00423280423);
  return vec2(loss * (2.0 - loss), (1.0 - loss) * (d * by_d - mm * by_m));
}

#ifdef LITTLE
// The transfer function; to both sides of the knot it is linear.
vec4 look_up(float from_knot) {
  vec4 found = middle + below * min(from_knot, 0.0) + above * max(from_knot, 0.0);
  return vec4(found.xyz, max(found.w, 0.0)); // rounding may put it below
}

// As below, without a loop: from the front to the knot, if it is met, and on to the back. Software OpenGL runs every
// branch that any of eight pixels takes.
vec4 gather(float front, float back, float len, ivec2 range, out vec2 seen) {
  float front_place = front - record0.z, back_place = back - record0.z;
  bool crosses = front_place * back_place < 0.0;
  float share = crosses ? front_place / (front_place - back_place) : 1.0;
  float first_len = len * share, second_len = len - first_len;
  vec4 f = look_up(front_place), b = look_up(back_place), m = crosses ? middle : b;
  vec2 first = piece_weights(f.w * first_len, m.w * first_len);
  vec2 second = piece_weights(m.w * second_len, b.w * second_len);
  float through = 1.0 - first.x;
#ifdef WITH_DEPTH
  bool first_seen = f.w + m.w > 0.0, second_seen = crosses && m.w + b.w > 0.0;
  seen = vec2(first_seen ? 0.0 : second_seen ? share : 1.0, second_seen ? 1.0 : first_seen ? share : 0.0);
#else
  seen = vec2(0.0, 1.0); // to blend nothing costs less than to find out
#endif
  return vec4(0.5 * (first.x * (f.xyz + m.xyz) + first.y * (m.xyz - f.xyz) +
                     through * (second.x * (m.xyz + b.xyz) + second.y * (b.xyz - m.xyz))),
              first.x + through * second.x);
}
#else
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
  vec4 gathered = vec4(0.0);
  float through = 1.0;
  seen = vec2(1.0, 0.0);
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
      bool cut = a_depth + b_depth > 2.0 * THICK;
      if (cut) { // where its depth is THICK
        float part = 2.0 * THICK / (a_depth + sqrt(a_depth * a_depth + 2.0 * (b_depth - a_depth) * THICK));
        float cut_end = begin + part * (end - begin);
        b_depth = part * mix(a_depth, b_depth, part);
        a_depth *= part;
        b = mix(f, b, part);
        if (!(cut_end > begin)) { // too deep to tell begin and end apart: opaque here
          gathered += through * vec4(f.xyz, 1.0);
          seen = vec2(min(seen.x, begin), end);
          break;
        }
        end = cut_end;
      }
      vec2 weights = piece_weights(a_depth, b_depth);
      if (f.w + b.w > 0.0) seen = vec2(min(seen.x, begin), end);
      gathered.xyz += 0.5 * through * (weights.x * (f.xyz + b.xyz) + weights.y * (b.xyz - f.xyz));
      gathered.w += through * weights.x;
      through -= through * weights.x;
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
  return gathered;
}
#endif
