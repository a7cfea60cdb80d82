// One cell after the other, from far to near, each blended over what is behind it.

layout(location = 0) out vec4 result;
#ifdef WITH_DEPTH
layout(location = 1) out vec4 depth; // -front, back: both blended by their maximum
#endif

void main() {
  segment met;
  vec2 ends;
  if (!meet_here(met)) discard;
  if (!shade(met, result, ends)) discard;
#ifdef WITH_DEPTH
  depth = vec4(ends, 0.0, 0.0);
#endif
}
