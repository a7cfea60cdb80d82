// A segment lit by gradients at points [C 8]. The gradient is linear along a segment, and so is its product with the
// light's direction: with I_f and I_b its values at the ends, what a stretch emits is D_f I_f + D_b I_b, where D_f and
// D_b are its colour weighted by 1-w and w, if I keeps its sign. So the segment is cut where I changes sign, and into as
// many equal samples as asked for, which the highlight alone needs: it is taken at two places of the stretch that have
// the mean and the spread of what is seen there.
uniform int samples; // 1 to 4

vec4 gather(float front, float back, float len, ivec2 range, out vec2 seen) {
  float front_diffuse = dot(gradient_front, towards);
  float back_diffuse = dot(gradient_back, towards);
  float turn = front_diffuse * back_diffuse < 0.0 ? front_diffuse / (front_diffuse - back_diffuse) : 2.0;
  vec4 gathered = vec4(0.0);
  float through = 1.0;
  float begin = 0.0;
  float begin_light = abs(front_diffuse);
  seen = vec2(1.0, 0.0);
  for (int k = 1; begin < 1.0;) {
    float end = k == samples ? 1.0 : float(k) / float(samples);
    bool turns = begin < turn && turn < end;
    if (turns)
      end = turn;
    else
      k++;
    float end_light = turns ? 0.0 : abs(mix(front_diffuse, back_diffuse, end));
    Part part = integrate(mix(front, back, begin), mix(front, back, end), len * (end - begin), range);
    if (part.seen.x <= part.seen.y) {
      vec3 colour = part.front * (shares.x + shares.y * begin_light) + part.back * (shares.x + shares.y * end_light);
      if (shares.z != 0.0) {
        vec2 at = mix(vec2(begin), vec2(end), clamp(part.centre + vec2(-part.spread, part.spread), 0.0, 1.0));
        colour += 0.5 * part.opacity * (highlight(normal_of(mix(gradient_front, gradient_back, at.x))) +
                                        highlight(normal_of(mix(gradient_front, gradient_back, at.y))));
      }
      gathered += through * vec4(colour, part.opacity);
      through *= 1.0 - OPACITY * part.opacity;
      seen = vec2(min(seen.x, mix(begin, end, part.seen.x)), mix(begin, end, part.seen.y));
      if (through <= OPAQUE) break;
    }
    begin = end;
    begin_light = end_light;
  }
  return gathered;
}
