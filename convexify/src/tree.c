/* SPDX-License-Identifier: BSD-3-Clause
 * Tree: halves of equal size along the widest axis of the centres, so node i has children 2 i + 1 and 2 i + 2 and no
 * links are stored. */
#include "tree.h"

static size_t node_count(size_t count) { return count <= TREE_LEAF ? 1 : 2 * node_count(count - count / 2) + 1; }

size_t tree_box_count(size_t count) { return 6 * node_count(count); }

static void enclose(const uint32_t *ids, size_t count, const double *boxes, double *box) {
  for (int k = 0; k < 3; k++) {
    box[k] = HUGE_VAL;
    box[3 + k] = -HUGE_VAL;
  }
  for (size_t i = 0; i < count; i++) {
    const double *own = &boxes[6 * (size_t)ids[i]];
    for (int k = 0; k < 3; k++) {
      box[k] = fmin(box[k], own[k]);
      box[3 + k] = fmax(box[3 + k], own[3 + k]);
    }
  }
}

/* Twice the centre. */
static double centre(const double *boxes, uint32_t id, int axis) {
  return boxes[6 * (size_t)id + (size_t)axis] + boxes[6 * (size_t)id + 3 + (size_t)axis];
}

/* Hoare's selection: ids before nth are not above it, those after not below. */
static void select_nth(uint32_t *ids, size_t count, size_t nth, const double *boxes, int axis) {
  size_t low = 0, high = count - 1;
  while (low < high) {
    const double pivot = centre(boxes, ids[low + (high - low) / 2], axis);
    size_t i = low, j = high;
    for (;;) {
      while (centre(boxes, ids[i], axis) < pivot) i++;
      while (centre(boxes, ids[j], axis) > pivot) j--;
      if (i >= j) break;
      const uint32_t swap = ids[i];
      ids[i++] = ids[j];
      ids[j--] = swap;
      if (j == SIZE_MAX) break;
    }
    if (i == j) {
      if (nth == i) return;
      i++;
      if (j > 0) j--;
    }
    if (nth <= j && j < high)
      high = j;
    else if (nth >= i && i > low)
      low = i;
    else
      return;
  }
}

static void build(uint32_t *ids, size_t count, const double *boxes, double *node_boxes, size_t node) {
  double *box = &node_boxes[6 * node];
  enclose(ids, count, boxes, box);
  if (count <= TREE_LEAF) return;
  int axis = 0;
  for (int k = 1; k < 3; k++)
    if (box[3 + k] - box[k] > box[3 + axis] - box[axis]) axis = k;
  const size_t half = count / 2;
  select_nth(ids, count, half, boxes, axis);
  build(ids, half, boxes, node_boxes, 2 * node + 1);
  build(ids + half, count - half, boxes, node_boxes, 2 * node + 2);
}

void tree_build(uint32_t *ids, size_t count, const double *boxes, double *node_boxes) {
  if (count > 0) build(ids, count, boxes, node_boxes, 0);
}

static bool meets(const double *a, const double *b) {
  for (int k = 0; k < 3; k++)
    if (a[k] > b[3 + k] || b[k] > a[3 + k]) return false;
  return true;
}

static void visit(work *w, const uint32_t *ids, size_t count, const double *boxes, const double *node_boxes,
                  size_t node, const double *box, id_list *out) {
  if (!meets(&node_boxes[6 * node], box)) return;
  if (count > TREE_LEAF) {
    const size_t half = count / 2;
    visit(w, ids, half, boxes, node_boxes, 2 * node + 1, box, out);
    visit(w, ids + half, count - half, boxes, node_boxes, 2 * node + 2, box, out);
    return;
  }
  for (size_t i = 0; i < count; i++)
    if (meets(&boxes[6 * (size_t)ids[i]], box)) list_push(w, out, ids[i]);
}

void tree_meeting(work *w, const uint32_t *ids, size_t count, const double *boxes, const double *node_boxes,
                  const double box[6], id_list *out) {
  if (count > 0) visit(w, ids, count, boxes, node_boxes, 0, box, out);
}
