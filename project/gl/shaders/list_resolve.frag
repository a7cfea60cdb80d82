// Composites a pixel's list in the order of depth, and empties it. The list is sorted by insertion: its nodes come
// nearly in order, as the last cell drawn stands at its head, so it takes little more than one walk.
layout(location = 0) out vec4 result;
#ifdef WITH_DEPTH
layout(location = 1) out vec4 depth;
#endif

bool is_behind(uint a, uint b) {
  return nodes[a].place > nodes[b].place || (nodes[a].place == nodes[b].place && nodes[a].cell < nodes[b].cell);
}

void main() {
  int pixel = list_pixel();
  uint rest = heads[pixel];
  if (rest == 0u) discard;
  heads[pixel] = 0u;
  uint sorted = 0u; // farthest first
  while (rest != 0u) {
    uint node = rest - 1u;
    rest = nodes[node].next;
    uint before = 0u, after = sorted;
    while (after != 0u && is_behind(after - 1u, node)) {
      before = after;
      after = nodes[after - 1u].next;
    }
    nodes[node].next = after;
    if (before == 0u)
      sorted = node + 1u;
    else
      nodes[before - 1u].next = node + 1u;
  }
  vec4 sum = vec4(0.0);
  vec2 all_ends = vec2(-3.0e38, 0.0);
  for (; sorted != 0u; sorted = nodes[sorted - 1u].next) {
    vec4 colour = nodes[sorted - 1u].colour;
    sum = colour + (1.0 - colour.w) * sum;
    all_ends = max(all_ends, nodes[sorted - 1u].ends);
  }
  result = sum;
#ifdef WITH_DEPTH
  depth = vec4(all_ends, 0.0, 0.0);
#endif
}
