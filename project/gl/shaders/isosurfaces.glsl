// Isosurfaces, flat or lit: where the scalar passes a value, its colour and opacity, from front to back. A surface
// belongs to the values from the segment's lower end on, below its upper end, so that none is met twice where two cells
// meet.
//
// Two texels a surface: value; colour and opacity.
uniform samplerBuffer intervals;

const float OPACITY = 1.0; // of what gather gives as its fourth component

// range: the first surface at or above the cell's least scalar, and the first at or above its greatest.
vec4 gather(float front, float back, float len, ivec2 range, out vec2 seen) {
  bool up = back >= front;
  float least = min(front, back), most = max(front, back);
  vec4 gathered = vec4(0.0);
  seen = vec2(1.0, 0.0);
  for (int n = 0; n < range.y - range.x; n++) {
    int i = up ? range.x + n : range.y - 1 - n;
    float value = texelFetch(intervals, 2 * i).x;
    if (value >= least && value < most) {
      vec4 surface = texelFetch(intervals, 2 * i + 1);
      float at = clamp((value - front) / (back - front), 0.0, 1.0);
#ifdef LIT
      vec3 normal = normal_of(mix(gradient_front, gradient_back, at));
      surface.xyz = surface.xyz * (shares.x + shares.y * abs(dot(normal, towards))) + highlight(normal);
#endif
      gathered += (1.0 - gathered.w) * vec4(surface.xyz * surface.w, surface.w);
      seen = vec2(min(seen.x, at), max(seen.y, at));
    }
  }
  return gathered;
}
