// A corner of a fan's triangle. Depth is 1 everywhere, so everything is interpolated without perspective; to ask for it
// (noperspective) would be the same, but Mesa 22.3 then goes wrong where it clips triangles at the picture's sides.
layout(location = 0) in vec3 corner;
layout(location = 1) in vec4 ends;
layout(location = 2) in float thick;
out vec4 between;
out float thickness;
uniform samplerBuffer records;
flat out vec4 record0; // of the record: its intervals
#ifdef LIT_CELLS
flat out vec4 record5; // and its light
#endif

void main() {
  gl_Position = vec4(corner.xy, 0.0, 1.0);
  record0 = texelFetch(records, 6 * int(corner.z));
#ifdef LIT_CELLS
  record5 = texelFetch(records, 6 * int(corner.z) + 5);
#endif
  between = ends;
  thickness = thick;
}
