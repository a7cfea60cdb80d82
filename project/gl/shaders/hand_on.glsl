// Hands on what is the same for all of a cell.
uniform samplerBuffer records;
uniform samplerBuffer intervals; // as in exact.glsl
uniform vec2 centre;             // of the image, in pixels
uniform vec2 slope;              // across one pixel at depth 1

void hand_on(int number) {
  record = number;
  record0 = texelFetch(records, 6 * number);
  record1 = texelFetch(records, 6 * number + 1);
  record2 = texelFetch(records, 6 * number + 2);
  record3 = texelFetch(records, 6 * number + 3);
  record4 = texelFetch(records, 6 * number + 4);
#ifdef LIT_CELLS
  record5 = texelFetch(records, 6 * number + 5);
#endif
  ray = vec4((abs(record0.xy) - centre) * slope, slope);
#ifdef FEW
  ivec4 which = min(ivec2(record0.zw).xxxx + ivec4(0, 1, 2, 3), ivec2(record0.zw).yyyy);
  vec4 widths, ends;
  vec4 lows[4], highs[4];
  for (int i = 0; i < 4; i++) {
    vec4 span = texelFetch(intervals, 3 * which[i]);
    lows[i] = texelFetch(intervals, 3 * which[i] + 1);
    highs[i] = texelFetch(intervals, 3 * which[i] + 2);
    widths[i] = span.z;
    ends[i] = i == 0 && which.x == which.w ? span.x : i > 0 && which[i] == which.w ? 1.0e18 : span.y;
  }
  knots = ends;
  colour0 = which.x == which.w ? lows[0] : highs[0]; // of one interval, the lower end stands for a knot
  colour1 = highs[1];
  colour2 = highs[2];
  slope0 = (highs[0] - lows[0]) * widths[0];
  slope1 = (highs[1] - lows[1]) * widths[1];
  slope2 = (highs[2] - lows[2]) * widths[2];
  slope3 = (highs[3] - lows[3]) * widths[3];
#endif
#ifdef LITTLE
  // Two intervals meet at the knot; if there is one, the knot is its lower end.
  ivec2 range = ivec2(record0.zw);
  vec4 span = texelFetch(intervals, 3 * range.x);
  vec4 low = texelFetch(intervals, 3 * range.x + 1), high = texelFetch(intervals, 3 * range.x + 2);
  bool one = range.x == range.y;
  below = (high - low) * span.z;
  above = below;
  middle = one ? low : high;
  record0.z = one ? span.x : span.y;
  if (!one) above = (texelFetch(intervals, 3 * range.y + 2) - high) * texelFetch(intervals, 3 * range.y).z;
#endif
}
