// Cells of renderer `faces`: on each pixel of a cell's footprint, where the ray leaves the cell through a back face
// and where it came in. All is said in barycentric coordinates, which know no cancellation: along the ray towards the eye they
// change linearly from those at a back face (0 for the corner opposite to it) to those of the eye, and the entry is
// where the first one reaches 0. So the length of the segment is 0 at a silhouette without a subtraction, however thin
// the cell.
//
// A record of seven texels a cell, made in double precision (cells.c), speaks of one back face and its opposite corner:
//   0  pixel to which the next three refer, first and last interval of the transfer function in the cell; the first is
//      -1 - itself if the cell has faces seen edge-on
//   1-3 one corner of the face each: its barycentric coordinate / depth at that pixel, the change per pixel in x and
//      in y (parallel: not divided by depth); the eye's coordinate (parallel: the change per unit towards the eye)
//   4  the scalar at the three corners and at the opposite one
//   5  depth of the three corners; the eye's coordinate of the opposite one
//   6  what light multiplies colours by, and the highlight it adds (1 and 0 without light)
uniform samplerBuffer records;
uniform samplerBuffer extras; // four texels a cell, for some: see gl_extra
flat in int record;
uniform vec2 centre;         // of the image, in pixels
uniform vec2 slope;          // across one pixel at depth 1
#ifdef WITH_LIMITS
uniform sampler2D limits;    // near and far limit of each pixel's ray: 1 / depth (parallel: depth)
#else
uniform float near_distance;
#endif

const float BIG = 3.0e38;

// Whether a pixel lies on the cell's side of a face seen edge-on. On the line itself the pixel counts as moved by an
// infinitesimal to the right, and by a smaller one upwards: so one of the cells at a face owns it, and of those at an
// edge too.
bool owns(vec4 line, vec2 pixel) {
  precise float at = line.x + line.y * (pixel.x - centre.x) + line.z * (pixel.y - centre.y);
  return (at != 0.0 ? at : line.y != 0.0 ? line.y : line.z) > 0.0;
}

// Where the ray of a pixel meets the cell of a record; false if it does not.
bool meet(int record, vec2 pixel, out segment met) {
  int at = 7 * record;
  vec4 head = texelFetch(records, at);
  vec4 a = texelFetch(records, at + 1);
  vec4 b = texelFetch(records, at + 2);
  vec4 c = texelFetch(records, at + 3);
  vec4 scalar = texelFetch(records, at + 4);
  vec4 tail = texelFetch(records, at + 5);
  vec4 light = texelFetch(records, at + 6);

  vec2 offset = pixel - head.xy;
  vec3 weight = vec3(a.x + dot(a.yz, offset), b.x + dot(b.yz, offset), c.x + dot(c.yz, offset));
  vec3 eye_weight = vec3(a.w, b.w, c.w);
  // How far before the face's plane the ray leaves and enters the cell: in perspective as a difference of 1 / depth,
  // in parallel of depth. It leaves before the plane where another back face is nearer, or where it never meets the
  // plane (sum < 0).
  float sum = weight.x + weight.y + weight.z;
  float exit = 0.0;
#ifdef WITH_LIMITS
  vec2 seen_between = texelFetch(limits, ivec2(pixel), 0).xy;
#endif
#ifdef PARALLEL
  weight /= sum;
  float face_depth = dot(weight, tail.xyz);
#ifdef WITH_LIMITS
  float entry = face_depth - seen_between.x;
  exit = max(exit, face_depth - seen_between.y);
#else
  float entry = face_depth - near_distance;
#endif
#else
#ifdef WITH_LIMITS
  float entry = seen_between.x - sum;
  exit = max(exit, seen_between.y - sum);
#else
  float entry = near_distance > 0.0 ? 1.0 / near_distance - sum : BIG;
#endif
#endif
  vec3 height = weight, speed = eye_weight; // what decides: of a face seen edge-on, the side alone
  if (head.z < 0.0) {
    head.z = -1.0 - head.z;
    for (int i = 0; i < 3; i++) {
      vec4 line = texelFetch(extras, 4 * record + i);
      if (line.w == 0.0) continue;
      height[i] = owns(line, pixel) ? 0.0 : -1.0;
      speed[i] = 0.0;
    }
  }
  for (int i = 0; i < 3; i++) {
    if (speed[i] < 0.0)
      entry = min(entry, max(height[i], 0.0) / -speed[i]);
    else if (height[i] < 0.0)
      exit = speed[i] > 0.0 ? max(exit, -height[i] / speed[i]) : BIG;
  }
  bool inside = entry > exit;

#ifdef PARALLEL
  vec3 exit_weight = weight + eye_weight * exit;
  vec3 entry_weight = weight + eye_weight * entry;
  float exit_opposite = tail.w * exit;
  float entry_opposite = tail.w * entry;
  met.exit_depth = face_depth - exit;
  met.thickness = entry - exit;
  met.len = met.thickness;
#else
  float at_exit = sum + exit;
  inside = inside && at_exit > 0.0;
  met.exit_depth = 1.0 / at_exit;
  vec3 exit_weight = (weight + eye_weight * exit) * met.exit_depth;
  float exit_opposite = tail.w * exit * met.exit_depth;
  float before = 1.0 / (sum + entry); // depth of the entry
  float share = entry < BIG ? entry * before : 1.0;
  vec3 entry_weight = weight * before + eye_weight * share;
  float entry_opposite = tail.w * share;
  met.thickness = met.exit_depth * (share - exit * before);
  met.len = met.thickness * length(vec3((pixel - centre) * slope, 1.0));
#endif
  met.front = dot(entry_weight, scalar.xyz) + entry_opposite * scalar.w;
  met.back = dot(exit_weight, scalar.xyz) + exit_opposite * scalar.w;
#ifdef LIT
  set_gradients(record, vec4(entry_weight, entry_opposite), vec4(exit_weight, exit_opposite));
#endif
  met.range = ivec2(head.zw);
  met.light = light.xy;
  return inside;
}

bool meet_here(out segment met) { return meet(record, gl_FragCoord.xy, met); }
