// What a cell's corners hand on to its fragments, the same at each of them. On software OpenGL a number that is handed
// on costs a fragment nothing; one from a buffer, and a uniform too, costs a gather over eight pixels.
HANDED int record;
HANDED vec4 record0, record1, record2, record3, record4; // of the record, see cell.glsl
#ifdef LIT_CELLS
HANDED vec4 record5;
#endif
HANDED vec4 ray; // direction across the picture at the record's pixel for depth 1, and its change per pixel
#ifdef FEW
HANDED vec4 knots;                          // three; those that the cell does not reach are far off
HANDED vec4 colour0, colour1, colour2;      // colour and extinction there
HANDED vec4 slope0, slope1, slope2, slope3; // before, between and after them
#endif
#ifdef LITTLE
HANDED vec4 below, middle, above; // colour and extinction at the knot (record0.z), slopes below and above it
#endif
