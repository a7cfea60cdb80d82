// The opaque surface: where the pixel's own ray meets the triangle's plane, which the rasteriser's grid does not move;
// lit, kept by the depth test if it is the nearest that the ray sees.
uniform samplerBuffer points, normals, colours;
uniform usamplerBuffer triangles;
uniform vec3 right, up, forward, eye;
uniform vec2 centre, slope; // as for cells (parallel: in units)
uniform float unit;         // length of the surface's size, in what limits are in
uniform vec2 nearness;      // perspective: depth that becomes 1; parallel: depth that becomes 0, 1 / range of depths
uniform sampler2D limits;   // of each pixel's ray: near and far, 1 / depth (parallel: depth), of clip planes
uniform bool smooth_shaded;
uniform vec3 towards, halfway;
uniform vec4 shares; // ambient, diffuse, specular, shininess
flat in int triangle;

layout(location = 0) out vec4 result; // colour, depth
layout(location = 1) out vec4 seen;   // the ray's limits, the surface being the far one

const float MARGIN = 2.0e-7;

void main() {
  int id[3];
  vec3 corner[3];
  for (int i = 0; i < 3; i++) {
    id[i] = int(texelFetch(triangles, 3 * triangle + i).x);
    corner[i] = texelFetch(points, id[i]).xyz;
  }
  vec2 across = (gl_FragCoord.xy - centre) * slope;
#ifdef PARALLEL
  vec3 origin = eye + across.x * right + across.y * up, direction = forward;
#else
  vec3 origin = eye, direction = forward + across.x * right + across.y * up;
#endif
  vec3 u = corner[1] - corner[0], v = corner[2] - corner[0], n = cross(u, v);
  float a = dot(forward, corner[0] - eye), b = a + dot(forward, u), c = a + dot(forward, v);
  // Seen edge-on, rounding may put it anywhere; it lies between the corners' depths.
  float speed = dot(n, direction);
  float offset = dot(n, corner[0] - origin);
  float depth = speed != 0.0 ? offset / speed : a;
  // How far rounding may move it: the more obliquely the plane is seen, the further.
  float doubt = length(corner[0] - origin) + abs(depth) * length(direction);
  doubt *= MARGIN * min(length(n) / max(abs(speed), 1.0e-37), 1.0e2);
  depth = clamp(depth, min(a, min(b, c)), max(a, max(b, c)));
  vec3 q = origin + depth * direction - corner[0];
  float size = max(dot(n, n), 1.0e-37);
  vec3 weight = vec3(0.0, dot(cross(q, v), n) / size, dot(cross(u, q), n) / size);
  weight.x = 1.0 - weight.y - weight.z;
  weight = clamp(weight, 0.0, 1.0);
  weight /= weight.x + weight.y + weight.z;

  depth *= unit;
  vec2 between = texelFetch(limits, ivec2(gl_FragCoord.xy), 0).xy;
#ifdef PARALLEL
  float place = depth;
  if (!(place >= between.x && place <= between.y)) discard;
  gl_FragDepth = 1.0 - (depth - nearness.x) * nearness.y;
#else
  float place = 1.0 / depth;
  if (!(depth > 0.0 && place <= between.x && place >= between.y)) discard;
  gl_FragDepth = nearness.x * place;
#endif
  vec3 normal = vec3(0.0), colour = vec3(0.0);
  for (int i = 0; i < 3; i++) {
    colour += weight[i] * texelFetch(colours, id[i]).xyz;
    if (smooth_shaded) normal += weight[i] * texelFetch(normals, id[i]).xyz;
  }
  if (dot(normal, normal) < 1.0e-12) normal = n;
  normal *= inversesqrt(max(dot(normal, normal), 1.0e-37));
  colour *= shares.x + shares.y * abs(dot(normal, towards));
  if (shares.z != 0.0) colour += shares.z * pow(abs(dot(normal, halfway)), shares.w);
  result = vec4(colour, depth);
  // Rays end a few roundings before the surface: see surface_layer_limit.
#ifdef PARALLEL
  place -= doubt * unit;
#else
  place *= 1.0 + doubt * unit * place;
#endif
  seen = vec4(between.x, place, 0.0, 0.0);
}
