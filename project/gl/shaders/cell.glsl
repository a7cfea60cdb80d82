// Cells of renderer `faces`: on each pixel of a cell's footprint, where the ray leaves the cell through a back face
// and where it came in. Places on a ray are told by t, the difference of 1 / depth from that at one back face's plane
// (parallel: of depth, towards the eye). In t everything is linear in the picture: where the ray meets each other face,
// scalar / depth, gradient / depth. So a cell is a few triples of numbers (value at a pixel near the cell, change per
// pixel in x and y), made in double precision (records.c), and the length of the segment is 0 at a silhouette without a
// subtraction, however thin the cell.
//
// A record of six texels a cell:
//   0  that pixel's centre, x negative if face 1 is a back face and y if face 2 is; first and last interval of the
//      transfer function in the cell; the first is -1 - itself if the cell has an extra (gl_extra)
//   1  the back face's plane: 1 / depth (parallel: depth); by how much the scalar / depth grows with t
//   2  scalar / depth at that plane (parallel: scalar); first number of face 2
//   3  face 0, always a front face but where an extra says otherwise: t; second number of face 2
//   4  face 1; third number of face 2
//   5  what light multiplies colours by, and the highlight it adds, if there is light on cells' own gradients
// A face seen edge-on has an infinite t; its extra tells on which side of it a pixel lies.
uniform samplerBuffer records;
uniform vec2 centre; // of the image, in pixels
uniform vec2 slope;  // across one pixel at depth 1
#ifdef WITH_LIMITS
uniform sampler2D limits; // near and far limit of each pixel's ray: 1 / depth (parallel: depth)
#endif
#ifndef PLAIN // no cell of the batch has an extra or lies at the near plane
uniform samplerBuffer extras;
uniform float near_distance;
#endif

const float BIG = 1.0e18; // as FAR_OFF in records.c

struct cell {
  vec4 head, base, field, face0, face1, light, ray;
};

// A field's value on the plane, t further towards the eye, where 1 / depth is 1 / scale.
float along(vec3 field, float growth, vec2 offset, float t, float scale) {
  return (field.x + field.y * offset.x + field.z * offset.y + growth * t) * scale;
}

#ifndef PLAIN
// Whether a pixel lies on the cell's side of a face seen edge-on. Where that is within what line.w leaves in doubt, the
// pixel counts as moved to the right and a little upwards, for all such faces by the same: so one of the cells at a face
// owns it, and of all those at an edge that is seen as a point too, of which each line has an error of its own.
bool owns(vec4 line, vec2 pixel) {
  precise float at = line.x + line.y * (pixel.x - centre.x) + line.z * (pixel.y - centre.y);
  precise float aside = (line.y + 0.381 * line.z) * max(1.0 / 512.0, 1.0e-5 * max(centre.x, centre.y));
  if (abs(at) <= line.w) at += aside;
  return (at != 0.0 ? at : line.y != 0.0 ? line.y : line.z) > 0.0;
}
#endif

// Where the ray of a pixel meets a cell; false if it does not.
bool meet_cell(cell c, int record, vec2 pixel, out segment met) {
  vec2 offset = pixel - abs(c.head.xy);
  float plane = c.base.x + c.base.y * offset.x + c.base.z * offset.y;
  float t0 = c.face0.x + c.face0.y * offset.x + c.face0.z * offset.y;
  float t1 = c.face1.x + c.face1.y * offset.x + c.face1.z * offset.y;
  float t2 = c.field.w + c.face0.w * offset.x + c.face1.w * offset.y;
  float entry = t0;
  float exit = 0.0;
  bool inside = true;
#ifndef PLAIN
  if (c.head.z < 0.0) {
    c.head.z = -1.0 - c.head.z;
    for (int i = 0; i < 3; i++) {
      vec4 line = texelFetch(extras, 4 * record + i);
      if (line.w != 0.0 && !owns(line, pixel)) inside = false;
    }
    if (texelFetch(extras, 4 * record + 3).z != 0.0) { // back faces alone
      exit = max(exit, t0);
      entry = BIG;
    }
  }
#endif
  if (c.head.x < 0.0)
    exit = max(exit, t1);
  else
    entry = min(entry, t1);
  if (c.head.y < 0.0)
    exit = max(exit, t2);
  else
    entry = min(entry, t2);
#ifdef WITH_LIMITS
  vec2 seen_between = texelFetch(limits, ivec2(pixel), 0).xy;
#ifdef PARALLEL
  entry = min(entry, plane - seen_between.x);
  exit = max(exit, plane - seen_between.y);
#else
  entry = min(entry, seen_between.x - plane);
  exit = max(exit, seen_between.y - plane);
#endif
#elif !defined(PLAIN)
#ifdef PARALLEL
  entry = min(entry, plane - near_distance);
#else
  if (near_distance > 0.0) entry = min(entry, 1.0 / near_distance - plane);
#endif
#endif
  inside = inside && entry > exit;
  met.range = ivec2(c.head.zw);
#ifdef PARALLEL
  const float exit_scale = 1.0, entry_scale = 1.0;
  met.exit_depth = plane - exit;
  met.thickness = entry - exit;
  met.len = met.thickness;
#else
  float at_exit = plane + exit, at_entry = plane + entry;
#ifndef PLAIN
  inside = inside && at_exit > 0.0;
#endif
  float both = 1.0 / (at_exit * at_entry);
  float exit_scale = both * at_entry, entry_scale = both * at_exit; // the depths
  met.exit_depth = exit_scale;
  met.thickness = (entry - exit) * both;
  met.len = met.thickness * length(vec3(c.ray.xy + offset * c.ray.zw, 1.0));
#endif
  met.front = along(c.field.xyz, c.base.w, offset, entry, entry_scale);
  met.back = along(c.field.xyz, c.base.w, offset, exit, exit_scale);
#ifdef LIT
  for (int i = 0; i < 3; i++) {
    vec4 gradient = texelFetch(lights, 3 * record + i);
    gradient_front[i] = along(gradient.xyz, gradient.w, offset, entry, entry_scale);
    gradient_back[i] = along(gradient.xyz, gradient.w, offset, exit, exit_scale);
  }
#endif
#ifdef LIT_CELLS
  met.light = c.light.xy;
#endif
  return inside;
}

// The cell of any record.
bool meet(int record, vec2 pixel, out segment met) {
  int at = 6 * record;
  cell c;
  c.head = texelFetch(records, at);
  c.base = texelFetch(records, at + 1);
  c.field = texelFetch(records, at + 2);
  c.face0 = texelFetch(records, at + 3);
  c.face1 = texelFetch(records, at + 4);
#ifdef LIT_CELLS
  c.light = texelFetch(records, at + 5);
#endif
  c.ray = vec4((abs(c.head.xy) - centre) * slope, slope);
  return meet_cell(c, record, pixel, met);
}

// The cell that the fragment belongs to.
bool meet_here(out segment met) {
  cell c;
  c.head = record0;
  c.base = record1;
  c.field = record2;
  c.face0 = record3;
  c.face1 = record4;
#ifdef LIT_CELLS
  c.light = record5;
#endif
  c.ray = ray;
  return meet_cell(c, record, gl_FragCoord.xy, met);
}
