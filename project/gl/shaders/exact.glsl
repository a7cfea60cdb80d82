// What a ray gathers in a cell, exactly for a piecewise linear transfer function: the segment is split where the
// scalar crosses a knot, and each piece has a closed form. Premultiplied colour and opacity.
//
// Three texels an interval between knots: its ends and 1 / width, colour and extinction at the lower end, at the upper.
// LITTLE: the cell lies in one interval or two, which its corners hand on, and no segment is deeper than 1 by the
// extinction anywhere in the cell; with STEPS it may be somewhat deeper. FEW: it lies in four intervals at most.
#if !defined(LITTLE) && !defined(FEW)
uniform samplerBuffer intervals;
#endif

const float OPACITY = 1.0; // of what gather gives as its fourth component

// Optical depth above which the loop below cuts a piece, so that neither end's extinction makes more than 1 of it.
const float THICK = 0.5;
// Steps of a cell's segment, at most: some more than FEW_STEPS in cells.c says.
const int MOST_STEPS = 64;
// What is seen through less is not seen.
const float OPAQUE = 1.0e-7;
// Depths are cut here, so that their squares fit a float.
const float DEEP = 1.0e15;
const float FARTHEST = 1.0e18; // scalars; as FAR_VALUE in intervals.c

// Of a piece whose optical depth would be a if its front end's extinction held along it and b with its back end's:
// opacity = 1 - exp(-m), m = (a+b)/2, and skew = weight of the back colour - weight of the front colour, where
// the piece's colour is (opacity (c_f + c_b) + skew (c_b - c_f)) / 2. For a and b in 0..1.
//
// Polynomials in m and d = (b-a)/2, the best there for the largest error: 2e-9 m and 1.2e-7 m. In short chains, which
// processors work on side by side.
vec2 piece_weights(float a, float b) {
  float m = 0.5 * (a + b), d = 0.5 * (b - a), mm = m * m, dd = d * d;
  float by_m = (1.0 - m * 0.49999986) + mm * ((0.16666399 - m * 0.041648960) +
               mm * ((0.0082791621 - m * 0.0013037895) + mm * 0.00013002610));
  float skew0 = (m * 0.083280605 - 0.16666232) + mm * ((m * 0.0051484490 - 0.024782741) - mm * 0.00062240156);
  float skew1 = (0.33333321 - m * 0.16666009) + mm * ((0.049917974 - m * 0.010787286) + mm * 0.0014777205);
  float skew2 = (0.033327650 - m * 0.016594796) + mm * (0.0045163998 - m * 0.00067064826);
  float skew3 = (0.0023962579 - m * 0.0012379976) + (mm * 0.00033350705 + d * 0.00010526459);
  return vec2(m * by_m, (mm * skew0 + d * skew1) + dd * (skew2 + d * skew3));
}

#ifdef LITTLE
// Extinction of a scalar this far from the knot; to both sides of it the transfer function is linear.
float extinction_at(float place) {
  return max(middle.w + below.w * min(place, 0.0) + above.w * max(place, 0.0), 0.0); // rounding may put it below
}

// From the front to the knot, if it is met, and on to the back. Colours are what they are at the knot and, for what is
// summed up for each side of it, a slope times a scalar. A loop's body is worked on at least once by software OpenGL,
// and again where any of eight pixels needs it.
vec4 gather(float front, float back, float len, ivec2 range, out vec2 seen) {
  float x = front - record0.z, y = back - record0.z;
  bool crosses = x * y < 0.0;
  float share = crosses ? x / (x - y) : 1.0;
  float x_extinction = extinction_at(x), y_extinction = extinction_at(y);
  float to = crosses ? 0.0 : y, to_extinction = crosses ? middle.w : y_extinction;
#ifdef WITH_DEPTH
  bool first_seen = x_extinction + to_extinction > 0.0, second_seen = crosses && to_extinction + y_extinction > 0.0;
  seen = vec2(first_seen ? 0.0 : second_seen ? share : 1.0, second_seen ? 1.0 : first_seen ? share : 0.0);
#else
  seen = vec2(0.0, 1.0); // to blend nothing costs less than to find out
#endif
  float left = len * share, rest = len - left;
  float opacity = 0.0, under = 0.0, over = 0.0;
  for (int step = 0; step < MOST_STEPS; step++) {
    float end = to, end_extinction = to_extinction, piece = left;
#ifdef STEPS
    float deepest = max(x_extinction, to_extinction) * left;
    bool cut = deepest > 1.0;
    float part = 1.0 / max(deepest, 1.0);
    end = cut ? mix(x, to, part) : to;
    end_extinction = cut ? mix(x_extinction, to_extinction, part) : to_extinction;
    piece = left * part;
    left -= piece;
#endif
    vec2 weights = piece_weights(x_extinction * piece, end_extinction * piece);
    float sum = x + end;
    float tilt = 0.5 * (1.0 - opacity) * (weights.x * sum + weights.y * (end - x));
    under += sum < 0.0 ? tilt : 0.0;
    over += sum < 0.0 ? 0.0 : tilt;
    opacity += (1.0 - opacity) * weights.x;
    x = end;
    x_extinction = end_extinction;
#ifdef STEPS
    if (cut) continue;
#endif
    if (!crosses) break;
    crosses = false;
    to = y;
    to_extinction = y_extinction;
    left = rest;
  }
  return vec4(opacity * middle.xyz + under * below.xyz + over * above.xyz, opacity);
}
#elif defined(FEW)
// From knot to knot.
vec4 gather(float front, float back, float len, ivec2 range, out vec2 seen) {
  bool up = back >= front;
  float inverse = 1.0 / (back == front ? 1.0 : back - front);
  float x = front, begin = 0.0;
  vec4 gathered = vec4(0.0);
#ifdef WITH_DEPTH
  seen = vec2(1.0, 0.0);
#else
  seen = vec2(0.0, 1.0);
#endif
  for (int step = 0; step < MOST_STEPS; step++) {
    // Which knots lie behind, seen from the lowest scalar: at a knot, on the way up it does, on the way down not.
    bool past0 = up ? x >= knots.x : x > knots.x;
    bool past1 = up ? x >= knots.y : x > knots.y;
    bool past2 = up ? x >= knots.z : x > knots.z;
    float above = past1 ? past2 ? FARTHEST : knots.z : past0 ? knots.y : knots.x;
    float below = past1 ? past2 ? knots.z : knots.y : past0 ? knots.x : -FARTHEST;
    float to = up ? min(above, back) : max(below, back);
    vec4 slope = past1 ? past2 ? slope3 : slope2 : past0 ? slope1 : slope0;
    vec4 colour = past1 ? past2 ? colour2 : colour1 : colour0;
    float knot = past1 ? past2 ? knots.z : knots.y : knots.x;
    float end = to == back ? 1.0 : (to - front) * inverse;
    float x_extinction = max(colour.w + slope.w * (x - knot), 0.0);
    float to_extinction = max(colour.w + slope.w * (to - knot), 0.0);
    float piece = max(len * (end - begin), 0.0);
    float deepest = max(x_extinction, to_extinction) * piece;
    bool cut = deepest > 1.0;
    float part = 1.0 / max(deepest, 1.0);
    to = cut ? mix(x, to, part) : to;
    end = cut ? mix(begin, end, part) : end;
    to_extinction = cut ? mix(x_extinction, to_extinction, part) : to_extinction;
    vec2 weights = piece_weights(x_extinction * piece * part, to_extinction * piece * part);
    float through = 1.0 - gathered.w;
    float tilt = 0.5 * through * (weights.x * (x + to - 2.0 * knot) + weights.y * (to - x));
    gathered += vec4(through * weights.x * colour.xyz + tilt * slope.xyz, through * weights.x);
#ifdef WITH_DEPTH
    if (x_extinction + to_extinction > 0.0) seen = vec2(min(seen.x, begin), end);
#endif
    if (end >= 1.0) break;
    x = to;
    begin = end;
  }
  return gathered;
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
