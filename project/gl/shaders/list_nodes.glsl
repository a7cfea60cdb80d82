// Per-pixel lists of what cells contribute there, for groups of many cells; OpenGL 4.3.
struct list_node {
  vec4 colour;
  vec2 ends;   // -depth of the first contribution, depth of the last one
  float place; // depth
  uint cell;   // tells apart what has one place
  uint next;   // as heads
};
layout(std430, binding = 0) buffer list_memory {
  uint taken; // may exceed the nodes there are: then the picture's part is drawn again with more memory
  list_node nodes[];
};
layout(std430, binding = 1) buffer list_heads {
  uint heads[]; // of each pixel: 1 + its first node; 0: none
};
uniform int width; // of the picture

int list_pixel() { return int(gl_FragCoord.y) * width + int(gl_FragCoord.x); }
