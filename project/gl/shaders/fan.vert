// A corner of a fan's triangle. Depth is 1 everywhere, so everything is interpolated without perspective; to ask for it
// (noperspective) would be the same, but Mesa 22.3 then goes wrong where it clips triangles at the picture's sides.
layout(location = 0) in vec3 corner;
layout(location = 1) in vec4 ends;
layout(location = 2) in float thick;
out vec4 between;
out float thickness;

void main() {
  gl_Position = vec4(corner.xy, 0.0, 1.0);
  hand_on(int(corner.z));
  between = ends;
  thickness = thick;
}
