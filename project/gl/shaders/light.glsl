// Light on gradients at points: they are linear in a cell, and so on a segment.
uniform samplerBuffer lights; // three texels a cell: x, y, z as the scalar in cell.glsl: on the plane, growth
uniform vec3 towards;         // the light
uniform vec3 halfway;         // between the light and the eye
uniform vec4 shares;          // ambient, diffuse, specular, shininess

vec3 gradient_front, gradient_back;

// The unit vector along a gradient of any length; 0 along 0.
vec3 normal_of(vec3 gradient) {
  float largest = max(max(abs(gradient.x), abs(gradient.y)), abs(gradient.z));
  return largest > 0.0 ? normalize(gradient / largest) : vec3(0.0);
}

float highlight(vec3 normal) {
  return shares.z != 0.0 ? shares.z * pow(abs(dot(normal, halfway)), shares.w) : 0.0;
}
