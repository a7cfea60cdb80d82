/* SPDX-License-Identifier: BSD-3-Clause
 * Validation of the boundary's contacts with itself: pairs of faces that meet in more than the points they share.
 *
 * A hierarchy of boxes over the boundary faces, implicit like a heap: faces come in Hilbert order already, so eight
 * that follow each other form a leaf and eight nodes that follow each other a node (Lauterbach et al., "Fast BVH
 * construction on GPUs", 2009, without the codes to sort). Each face asks it for the faces after itself; pairs are
 * decided exactly by triangle_pair.c. Points in one place count as one point, so that a seam is not a mass of contacts.
 */
#include "triangle_pair.h"
#include "validate_private.h"

#include <math.h>
#include <stdatomic.h>

enum { FANOUT = 8, MAX_LEVELS = 12 };

struct box {
  double low[3], high[3];
};

struct tree {
  int level_count;
  size_t begin[MAX_LEVELS + 1]; /* of each level in boxes: level 0 has one a face */
  size_t size[MAX_LEVELS];
  struct box *boxes;
};

/* Bits of contacts[face]. */
enum { IS_TOUCHING = 1, IS_SEAM = 2, IS_HANGING = 4, IS_CROSSING = 8 };

struct contact_job {
  validation *run;
  const struct tree *tree;
  _Atomic uint8_t *contacts; /* [face_count]; bits are only ever added, so the order of threads does not show */
};

static void include(struct box *box, const double low[3], const double high[3], bool is_first) {
  for (int k = 0; k < 3; k++) {
    box->low[k] = is_first || low[k] < box->low[k] ? low[k] : box->low[k];
    box->high[k] = is_first || high[k] > box->high[k] ? high[k] : box->high[k];
  }
}

static cellist_result tree_create(const validation *run, struct tree *tree) {
  *tree = (struct tree){0};
  size_t total = 0;
  for (size_t count = run->face_count;; count = (count + FANOUT - 1) / FANOUT) {
    tree->begin[tree->level_count] = total;
    tree->size[tree->level_count++] = count;
    total += count;
    if (count <= 1) break;
  }
  tree->boxes = cellist_allocate(run->context, total, sizeof *tree->boxes);
  if (tree->boxes == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < run->face_count; i++)
    for (int c = 0; c < 3; c++) {
      const double *p = point_of(run->mesh, face_corner(run->mesh, run->faces[i], c));
      include(&tree->boxes[i], p, p, c == 0);
    }
  for (int level = 1; level < tree->level_count; level++)
    for (size_t i = 0; i < tree->size[level - 1]; i++) {
      const struct box *child = &tree->boxes[tree->begin[level - 1] + i];
      include(&tree->boxes[tree->begin[level] + i / FANOUT], child->low, child->high, i % FANOUT == 0);
    }
  return CELLIST_SUCCESS;
}

static bool boxes_meet(const struct box *a, const struct box *b) {
  return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] && b->low[1] <= a->high[1] &&
         a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

static pair_triangle triangle_of(const validation *run, uint32_t face) {
  pair_triangle triangle;
  for (int c = 0; c < 3; c++) {
    const uint32_t point = face_corner(run->mesh, face, c);
    triangle.id[c] = run->place[point];
    triangle.corner[c] = point_of(run->mesh, point);
  }
  return triangle;
}

/* Faces of the very same points are folded or overfull, which adjacency has found. */
static bool is_same_face(const cellist_mesh_arrays *mesh, uint32_t a, uint32_t b) {
  int shared = 0;
  for (int i = 0; i < 9; i++) shared += face_corner(mesh, a, i / 3) == face_corner(mesh, b, i % 3);
  return shared == 3;
}

/* The faces of a flat cell lie on each other and on those of flat neighbours: being flat is the finding. */
static bool is_within_flat(const cellist_mesh_arrays *mesh, size_t a, size_t b, uint8_t contact) {
  const int flat = ((mesh->tet_flags[a] & CELLIST_TET_FLAT) != 0) + ((mesh->tet_flags[b] & CELLIST_TET_FLAT) != 0);
  return flat == 2 || (flat == 1 && contact != IS_CROSSING);
}

static void judge_pair(const struct contact_job *job, const pair_triangle *own, size_t i, size_t j) {
  const validation *run = job->run;
  const pair_triangle other = triangle_of(run, run->faces[j]);
  uint8_t contact = 0;
  switch (pair_classify(own, &other)) {
    case PAIR_APART: return;
    case PAIR_TOUCH: contact = IS_TOUCHING; break;
    case PAIR_FACE: contact = IS_HANGING; break;
    case PAIR_MATCH: contact = IS_SEAM; break;
    case PAIR_CROSS: contact = IS_CROSSING; break;
  }
  const uint32_t face = run->faces[i], against = run->faces[j];
  if (is_within_flat(run->mesh, face / 4, against / 4, contact)) return;
  if (contact != IS_TOUCHING && is_same_face(run->mesh, face, against)) return;
  atomic_fetch_or_explicit(&job->contacts[i], contact, memory_order_relaxed);
  atomic_fetch_or_explicit(&job->contacts[j], contact, memory_order_relaxed);
}

/* All faces after i whose boxes meet i's. */
static void query(const struct contact_job *job, size_t i) {
  const struct tree *tree = job->tree;
  const struct box *box = &tree->boxes[i];
  const pair_triangle own = triangle_of(job->run, job->run->faces[i]);
  struct {
    size_t node, span; /* span: faces under a node of this level */
    int level;
  } stack[FANOUT * MAX_LEVELS];
  size_t depth = 0, span = 1;
  for (int level = 1; level < tree->level_count; level++) span *= FANOUT;
  stack[depth].node = 0;
  stack[depth].span = span;
  stack[depth++].level = tree->level_count - 1;
  while (depth > 0) {
    depth--;
    const size_t node = stack[depth].node;
    const int level = stack[depth].level;
    span = stack[depth].span;
    if ((node + 1) * span <= i + 1 || !boxes_meet(box, &tree->boxes[tree->begin[level] + node])) continue;
    if (level == 0) {
      judge_pair(job, &own, i, node);
      continue;
    }
    const size_t first = node * FANOUT, left = tree->size[level - 1] - first;
    for (size_t k = 0; k < FANOUT && k < left; k++) {
      stack[depth].node = first + k;
      stack[depth].span = span / FANOUT;
      stack[depth++].level = level - 1;
    }
  }
}

static void query_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  for (size_t i = begin; i < end; i++) query(user, i);
}

static void mark_contacts(validation *run, const _Atomic uint8_t *contacts) {
  for (size_t i = 0; i < run->face_count; i++) {
    const uint8_t contact = atomic_load_explicit(&contacts[i], memory_order_relaxed);
    const size_t tet = run->faces[i] / 4;
    run->report->crossing_face_count += (contact & IS_CROSSING) != 0;
    run->report->touching_face_count += contact != 0 && (contact & IS_CROSSING) == 0;
    if (contact & IS_TOUCHING) mark(run, tet, CELLIST_FINDING_TOUCHING);
    if (contact & IS_SEAM) mark(run, tet, CELLIST_FINDING_SEAM);
    if (contact & IS_HANGING) mark(run, tet, CELLIST_FINDING_HANGING);
    if (contact & IS_CROSSING) mark(run, tet, CELLIST_FINDING_CROSSING);
  }
}

cellist_result validate_contacts(validation *run) {
  if (run->face_count == 0) return CELLIST_SUCCESS;
  struct tree tree;
  cellist_result result = tree_create(run, &tree);
  _Atomic uint8_t *contacts = cellist_allocate_zeroed(run->context, run->face_count, sizeof *contacts);
  if (result == CELLIST_SUCCESS && contacts == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) {
    struct contact_job job = {run, &tree, contacts};
    cellist_parallel_for(run->context, run->face_count, 512, query_range, &job);
    mark_contacts(run, contacts);
  }
  cellist_deallocate(run->context, tree.boxes);
  cellist_deallocate(run->context, (void *)contacts);
  return result;
}
