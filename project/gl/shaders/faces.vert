// A corner of a cell's footprint, in the picture (-1..1), and the number of the cell's record.
layout(location = 0) in vec3 corner;

void main() {
  gl_Position = vec4(corner.xy, 0.0, 1.0);
  hand_on(int(corner.z));
}
