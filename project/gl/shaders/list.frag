// Puts a cell's fragment at the head of its pixel's list.
uniform int first_record; // number of record 0 in the group
layout(location = 0) out vec4 result; // masked

void main() {
  segment met;
  vec4 colour;
  vec2 ends;
  if (!meet_here(met) || !shade(met, colour, ends)) discard;
  result = vec4(0.0);
  uint at = atomicAdd(taken, 1u);
  if (at < uint(nodes.length())) {
    nodes[at].colour = colour;
    nodes[at].ends = ends;
    nodes[at].place = middle_depth(met);
    nodes[at].cell = uint(first_record + record);
    nodes[at].next = atomicExchange(heads[list_pixel()], at + 1u);
  }
}
