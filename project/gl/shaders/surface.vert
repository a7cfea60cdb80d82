// A corner of a surface's triangle. Points are in units of the surface's size, from its middle.
uniform samplerBuffer points;
uniform usamplerBuffer triangles; // three point ids each
uniform vec3 right, up, forward;  // of the view
uniform vec3 eye;
uniform vec2 scale;   // 1 / half of what is seen, at depth 1 (parallel: in units)
uniform float least;  // depth before which nothing is drawn, above 0
flat out int triangle;

void main() {
  triangle = gl_VertexID / 3;
  vec3 from_eye = texelFetch(points, int(texelFetch(triangles, gl_VertexID).x)).xyz - eye;
  vec2 place = vec2(dot(right, from_eye), dot(up, from_eye)) * scale;
#ifdef PARALLEL
  gl_Position = vec4(place, 0.0, 1.0);
#else
  float depth = dot(forward, from_eye);
  gl_Position = vec4(place, depth - 2.0 * least, depth); // beyond -w where depth > least, never beyond w
#endif
}
