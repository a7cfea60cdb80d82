// What a ray meets of a cell, and what it gathers there.
struct segment {
  float front, back;           // scalars where it enters and leaves
  float len;                   // in world units
  float exit_depth, thickness; // along the line of sight
  ivec2 range;                 // intervals of the transfer function that the cell's scalars touch
#ifdef LIT_CELLS
  vec2 light;                  // what light multiplies colours by, and the highlight it adds
#endif
};

// Premultiplied colour, and -depth of the first contribution and depth of the last one; false if there is none.
bool shade(segment met, out vec4 colour, out vec2 ends) {
  vec2 seen;
  vec4 gathered = gather(met.front, met.back, met.len, met.range, seen);
#ifdef LIT_CELLS
  gathered.xyz = gathered.xyz * met.light.x + gathered.w * met.light.y;
#endif
  colour = vec4(gathered.xyz, OPACITY * gathered.w);
  ends = vec2(-(met.exit_depth - met.thickness * (1.0 - seen.x)), met.exit_depth - met.thickness * (1.0 - seen.y));
  return seen.x <= seen.y;
}

// Of cells that do not overlap, the one whose segment's middle is nearer stands in front on this ray.
float middle_depth(segment met) { return met.exit_depth - 0.5 * met.thickness; }
