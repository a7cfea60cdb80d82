// A corner of a cell's footprint, in the picture (-1..1), and the number of the cell's record.
layout(location = 0) in vec3 corner;
uniform samplerBuffer records;
flat out int record;
flat out vec4 record0, record1, record2, record3, record4; // of the record, see cell.glsl
#ifdef LIT_CELLS
flat out vec4 record5;
#endif

void main() {
  gl_Position = vec4(corner.xy, 0.0, 1.0);
  record = int(corner.z);
  record0 = texelFetch(records, 6 * record);
  record1 = texelFetch(records, 6 * record + 1);
  record2 = texelFetch(records, 6 * record + 2);
  record3 = texelFetch(records, 6 * record + 3);
  record4 = texelFetch(records, 6 * record + 4);
#ifdef LIT_CELLS
  record5 = texelFetch(records, 6 * record + 5);
#endif
}
