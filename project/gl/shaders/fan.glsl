// Cells of renderer `fan`: what the corners of a fan's triangle say is interpolated over the picture [C 2]; in
// perspective scalars come divided by their own depth.
in vec4 between;    // scalar / depth, 1 / depth at the front, at the back; parallel: scalar, depth
in float thickness; // difference of 1 / depth; parallel: of depth
#ifdef WITH_LIMITS
uniform sampler2D limits;    // near and far limit of each pixel's ray: 1 / depth (parallel: depth)
uniform float subpixel;      // pixels by which corners may be moved
#elif !defined(PLAIN)        // no fan lies at the near plane
uniform float near_distance;
#endif

const float BIG = 1.0e18;

bool meet_here(out segment met) {
#ifdef PARALLEL
  met.front = between.x;
  met.back = between.z;
  met.exit_depth = between.w;
  met.thickness = thickness;
#else
  float front_depth = 1.0 / between.y;
  met.exit_depth = 1.0 / between.w;
  met.front = between.x * front_depth;
  met.back = between.z * met.exit_depth;
  met.thickness = thickness * front_depth * met.exit_depth;
#endif
  bool inside = thickness > 0.0;
  // What lies before the near plane or outside limits is cut off; the scalar is linear along the ray.
#ifdef WITH_LIMITS
  vec2 kept = texelFetch(limits, ivec2(gl_FragCoord.xy), 0).xy;
#ifndef PARALLEL
  kept = vec2(kept.x > 0.0 ? 1.0 / kept.x : BIG, kept.y > 0.0 ? 1.0 / kept.y : BIG);
#endif
#elif !defined(PLAIN)
  vec2 kept = vec2(near_distance, BIG);
#endif
#if defined(WITH_LIMITS) || !defined(PLAIN)
  float from = met.exit_depth - met.thickness;
  float inverse = 1.0 / max(met.thickness, 1.0e-37);
  float begin = clamp((kept.x - from) * inverse, 0.0, 1.0);
  float end = clamp((kept.y - from) * inverse, 0.0, 1.0);
  inside = inside && begin < end;
#ifdef WITH_LIMITS
  // Where a corner is moved its depth moves along, and a cell just behind a surface seems to begin before it.
#ifdef PARALLEL
  float doubt = subpixel * fwidth(between.y);
#else
  float doubt = subpixel * fwidth(between.y) * front_depth * front_depth;
#endif
  inside = inside && from + doubt < kept.y;
#endif
  float change = met.back - met.front;
  met.back = met.front + end * change;
  met.front = met.front + begin * change;
  met.exit_depth = from + end * met.thickness;
  met.thickness = (end - begin) * met.thickness;
#endif
#ifdef PARALLEL
  met.len = met.thickness;
#else
  met.len = met.thickness * length(vec3(ray.xy + gl_FragCoord.xy * ray.zw, 1.0)); // a fan's record has pixel 0, 0
#endif
  met.range = ivec2(record0.zw);
#ifdef LIT_CELLS
  met.light = record5.xy;
#endif
  return inside;
}
