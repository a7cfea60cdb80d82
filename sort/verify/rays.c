/* SPDX-License-Identifier: BSD-3-Clause
 * Rays: which cells a ray meets, found without neighbours, planes or predicates.
 *
 * Boxes stand around runs of eight tets, and around runs of eight such boxes, and so on: in Hilbert order that is as
 * good as a built hierarchy. In a ray's own frame a tet's face is crossed if its three edges turn the same way around
 * the ray, and the depth is the corners' depths weighted by the turns, so that two tets which share a face
 * agree on its depth to the last bits, slivers too. */
#include <cellist/sort_verify.h>
#include <math.h>
#include <string.h>

#include <base/random.h>

#include "../memory.h"
#include "../view.h"
#include "ranks.h"

enum { RUN = 8, LEVEL_LIMIT = 12, CHUNK = 64 };

/* Parts of a ray shorter than this part of the mesh's diagonal count as a touch: less, and rounding makes up
 * crossings at edges and vertices; more, and thin cells go unchecked. */
static const double TOUCH = 1e-9;

struct box {
  double low[3], high[3];
};

struct crossing {
  double enter, leave;
  uint32_t tet;
};

struct crossings {
  struct crossing *list;
  size_t count, capacity;
};

/* One worker's scratch and counts. */
struct tally {
  struct crossings crossings;
  cellist_verification found;
  cellist_result result;
};

struct cellist_verifier {
  cellist_context *context;
  cellist_sorter_desc mesh;
  double diagonal;
  size_t level_count; /* level 0 holds runs of tets */
  size_t box_counts[LEVEL_LIMIT];
  struct box *boxes[LEVEL_LIMIT];
  uint32_t *ranks;
  unsigned worker_count;
  struct tally *tallies;
};

struct ray {
  double from[3], axes[3][3]; /* axes[2] is the direction, of unit length */
  bool line;                  /* both ways */
};

struct check {
  cellist_verifier *verifier;
  const cellist_viewpoint *viewpoint;
  uint64_t seed;
};

static void add_point(struct box *box, const double *p) {
  for (int k = 0; k < 3; k++) {
    box->low[k] = fmin(box->low[k], p[k]);
    box->high[k] = fmax(box->high[k], p[k]);
  }
}

static void fill_level(cellist_verifier *verifier, size_t level) {
  const cellist_sorter_desc *mesh = &verifier->mesh;
  const size_t below = level == 0 ? mesh->tet_count : verifier->box_counts[level - 1];
  for (size_t i = 0; i < verifier->box_counts[level]; i++) {
    struct box *box = &verifier->boxes[level][i];
    *box = (struct box){{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    for (size_t j = RUN * i; j < RUN * (i + 1) && j < below; j++) {
      for (size_t c = 0; level == 0 && c < 4; c++) add_point(box, &mesh->points[3 * (size_t)mesh->tets[4 * j + c]]);
      if (level == 0) continue;
      add_point(box, verifier->boxes[level - 1][j].low);
      add_point(box, verifier->boxes[level - 1][j].high);
    }
  }
}

cellist_result cellist_verifier_create(cellist_context *context, const cellist_sorter_desc *mesh,
                                       cellist_verifier **verifier) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || verifier == NULL || (mesh->tet_count > 0 && (mesh->points == NULL || mesh->tets == NULL)))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_verifier_create: NULL");
  cellist_verifier *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->mesh = *mesh;
  created->worker_count = cellist_context_worker_count(context);
  created->ranks = cellist_allocate(context, mesh->tet_count, sizeof *created->ranks);
  created->tallies = cellist_allocate_zeroed(context, created->worker_count, sizeof *created->tallies);
  bool ok = created->ranks != NULL && created->tallies != NULL;
  size_t count = mesh->tet_count;
  while (ok && count > 0 && (count > 1 || created->level_count == 0)) {
    count = (count + RUN - 1) / RUN;
    const size_t level = created->level_count++;
    created->box_counts[level] = count;
    created->boxes[level] = cellist_allocate(context, count, sizeof *created->boxes[level]);
    ok = created->boxes[level] != NULL;
    if (ok) fill_level(created, level);
  }
  if (!ok) {
    cellist_verifier_destroy(created);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  if (created->level_count > 0) {
    const struct box *box = created->boxes[created->level_count - 1];
    double squared = 0;
    for (int k = 0; k < 3; k++) squared += (box->high[k] - box->low[k]) * (box->high[k] - box->low[k]);
    created->diagonal = sqrt(squared);
  }
  *verifier = created;
  return CELLIST_SUCCESS;
}

void cellist_verifier_destroy(cellist_verifier *verifier) {
  if (verifier == NULL) return;
  for (size_t i = 0; i < verifier->level_count; i++) cellist_deallocate(verifier->context, verifier->boxes[i]);
  for (unsigned i = 0; verifier->tallies != NULL && i < verifier->worker_count; i++)
    cellist_deallocate(verifier->context, verifier->tallies[i].crossings.list);
  cellist_deallocate(verifier->context, verifier->tallies);
  cellist_deallocate(verifier->context, verifier->ranks);
  cellist_deallocate(verifier->context, verifier);
}

/* The ray of the view through a random place of a random tet; false if that place is the eye. */
static bool make_ray(const cellist_sorter_desc *mesh, const cellist_viewpoint *viewpoint, random_state *random,
                     struct ray *ray) {
  const uint32_t *v = &mesh->tets[4 * random_below(random, mesh->tet_count)];
  double weight[4], sum = 0, through[3] = {0, 0, 0}, length = 0;
  for (int c = 0; c < 4; c++) sum += weight[c] = 0.001 + random_unit(random);
  for (int c = 0; c < 4; c++)
    for (int k = 0; k < 3; k++) through[k] += weight[c] / sum * mesh->points[3 * (size_t)v[c] + (size_t)k];
  ray->line = viewpoint->parallel;
  for (int k = 0; k < 3; k++) {
    ray->from[k] = viewpoint->parallel ? through[k] : viewpoint->position[k];
    ray->axes[2][k] = viewpoint->parallel ? viewpoint->position[k] : through[k] - viewpoint->position[k];
    length = fmax(length, fabs(ray->axes[2][k]));
  }
  if (!(length > 0) || !isfinite(length)) return false;
  double squared = 0;
  for (int k = 0; k < 3; k++) {
    ray->axes[2][k] /= length;
    squared += ray->axes[2][k] * ray->axes[2][k];
  }
  int smallest = 0;
  for (int k = 0; k < 3; k++) {
    ray->axes[2][k] /= sqrt(squared);
    if (fabs(ray->axes[2][k]) < fabs(ray->axes[2][smallest])) smallest = k;
  }
  const double *d = ray->axes[2];
  double axis[3] = {0, 0, 0};
  axis[smallest] = 1;
  squared = 1 - d[smallest] * d[smallest];
  for (int k = 0; k < 3; k++)
    ray->axes[0][k] = (axis[(k + 1) % 3] * d[(k + 2) % 3] - axis[(k + 2) % 3] * d[(k + 1) % 3]) / sqrt(squared);
  const double *x = ray->axes[0];
  for (int k = 0; k < 3; k++) ray->axes[1][k] = d[(k + 1) % 3] * x[(k + 2) % 3] - d[(k + 2) % 3] * x[(k + 1) % 3];
  return true;
}

/* Does the ray come near the box? Wider by `margin`, so that rounding misses nothing. */
static bool meets_box(const struct ray *ray, const struct box *box, double margin) {
  double enter = ray->line ? -HUGE_VAL : 0, leave = HUGE_VAL;
  for (int k = 0; k < 3; k++) {
    const double low = box->low[k] - margin - ray->from[k], high = box->high[k] + margin - ray->from[k];
    const double speed = ray->axes[2][k];
    if (speed == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const double a = low / speed, b = high / speed;
    enter = fmax(enter, fmin(a, b));
    leave = fmin(leave, fmax(a, b));
  }
  return enter <= leave;
}

static bool cross_tet(const cellist_sorter_desc *mesh, const struct ray *ray, uint32_t tet, struct crossing *crossing) {
  double x[4], y[4], z[4];
  for (size_t c = 0; c < 4; c++) {
    const double *p = &mesh->points[3 * (size_t)mesh->tets[4 * (size_t)tet + c]];
    double v[3];
    for (int k = 0; k < 3; k++) v[k] = p[k] - ray->from[k];
    x[c] = v[0] * ray->axes[0][0] + v[1] * ray->axes[0][1] + v[2] * ray->axes[0][2];
    y[c] = v[0] * ray->axes[1][0] + v[1] * ray->axes[1][1] + v[2] * ray->axes[1][2];
    z[c] = v[0] * ray->axes[2][0] + v[1] * ray->axes[2][1] + v[2] * ray->axes[2][2];
  }
  double depths[4];
  int count = 0;
  for (size_t k = 0; k < 4; k++) {
    const size_t a = SORT_TET_FACE[k][0], b = SORT_TET_FACE[k][1], c = SORT_TET_FACE[k][2];
    const double ab = x[a] * y[b] - x[b] * y[a], bc = x[b] * y[c] - x[c] * y[b], ca = x[c] * y[a] - x[a] * y[c];
    if (!((ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0))) continue;
    depths[count++] = (z[a] * bc + z[b] * ca + z[c] * ab) / (ab + bc + ca);
  }
  if (count != 2) return false; /* the ray misses the tet, or touches an edge */
  *crossing = (struct crossing){fmin(depths[0], depths[1]), fmax(depths[0], depths[1]), tet};
  if (!ray->line) crossing->enter = fmax(crossing->enter, 0);
  return true;
}

static cellist_result add_crossing(cellist_context *context, struct crossings *crossings,
                                   const struct crossing *crossing) {
  const cellist_result result = sort_reserve(context, &crossings->list, &crossings->capacity, crossings->count,
                                             crossings->count + 1, sizeof *crossings->list);
  if (result == CELLIST_SUCCESS) crossings->list[crossings->count++] = *crossing;
  return result;
}

/* All crossings of a ray that are more than a touch. */
static cellist_result cast(const cellist_verifier *verifier, const struct ray *ray, struct crossings *crossings) {
  const double touch = TOUCH * verifier->diagonal;
  struct {
    size_t level, box;
  } stack[LEVEL_LIMIT * RUN];
  size_t depth = 0;
  stack[depth].level = verifier->level_count - 1;
  stack[depth++].box = 0;
  crossings->count = 0;
  while (depth > 0) {
    const size_t level = stack[--depth].level, box = stack[depth].box;
    if (!meets_box(ray, &verifier->boxes[level][box], touch)) continue;
    const size_t below = level == 0 ? verifier->mesh.tet_count : verifier->box_counts[level - 1];
    for (size_t j = RUN * box; j < RUN * (box + 1) && j < below; j++) {
      if (level > 0) {
        stack[depth].level = level - 1;
        stack[depth++].box = j;
        continue;
      }
      struct crossing crossing;
      if (!cross_tet(&verifier->mesh, ray, (uint32_t)j, &crossing) || crossing.leave - crossing.enter <= touch)
        continue;
      const cellist_result result = add_crossing(verifier->context, crossings, &crossing);
      if (result != CELLIST_SUCCESS) return result;
    }
  }
  return CELLIST_SUCCESS;
}

/* Shell sort (Ciura's steps): rays meet tens to hundreds of cells. */
static void sort_crossings(struct crossing *list, size_t count) {
  static const size_t steps[] = {701, 301, 132, 57, 23, 10, 4, 1};
  for (size_t s = 0; s < sizeof steps / sizeof steps[0]; s++) {
    for (size_t i = steps[s]; i < count; i++) {
      const struct crossing moving = list[i];
      size_t at = i;
      while (at >= steps[s] && list[at - steps[s]].enter + list[at - steps[s]].leave > moving.enter + moving.leave) {
        list[at] = list[at - steps[s]];
        at -= steps[s];
      }
      list[at] = moving;
    }
  }
}

static void check_range(void *user, size_t begin, size_t end, unsigned worker) {
  const struct check *check = user;
  const cellist_verifier *verifier = check->verifier;
  struct tally *tally = &verifier->tallies[worker];
  const double touch = TOUCH * verifier->diagonal;
  for (size_t i = begin; i < end && tally->result == CELLIST_SUCCESS; i++) {
    random_state random = {check->seed + i};
    random.state = random_bits(&random); /* seeds in a row give rays that have nothing in common */
    struct ray ray;
    if (!make_ray(&verifier->mesh, check->viewpoint, &random, &ray)) continue;
    tally->result = cast(verifier, &ray, &tally->crossings);
    struct crossing *list = tally->crossings.list;
    const size_t count = tally->crossings.count;
    sort_crossings(list, count);
    tally->found.ray_count += count > 0;
    for (size_t j = 0; j + 1 < count; j++) {
      const uint32_t near = verifier->ranks[list[j].tet], far = verifier->ranks[list[j + 1].tet];
      if (list[j].leave - list[j + 1].enter > touch)
        tally->found.overlaps++;
      else if (near == far)
        tally->found.group_pairs++;
      else
        tally->found.pairs++, tally->found.inversions += near < far;
    }
  }
}

cellist_result cellist_verifier_check(cellist_verifier *verifier, const cellist_viewpoint *viewpoint,
                                      const uint32_t *order, const cellist_group *groups, size_t group_count,
                                      size_t ray_count, uint64_t seed, cellist_verification *found) {
  if (verifier == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  cellist_context *context = verifier->context;
  if (viewpoint == NULL || found == NULL || (order == NULL && verifier->mesh.tet_count > 0) ||
      (groups == NULL && group_count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_verifier_check: NULL");
  cellist_result result = sort_ranks(context, verifier->mesh.tet_count, order, groups, group_count, verifier->ranks);
  if (result != CELLIST_SUCCESS) return result;
  for (unsigned i = 0; i < verifier->worker_count; i++) {
    verifier->tallies[i].found = (cellist_verification){0};
    verifier->tallies[i].result = CELLIST_SUCCESS;
  }
  struct check check = {verifier, viewpoint, seed};
  if (verifier->mesh.tet_count > 0) cellist_parallel_for(context, ray_count, CHUNK, check_range, &check);
  cellist_verification sum = {0};
  for (unsigned i = 0; i < verifier->worker_count; i++) {
    const struct tally *tally = &verifier->tallies[i];
    if (tally->result != CELLIST_SUCCESS) result = tally->result;
    sum.ray_count += tally->found.ray_count;
    sum.pairs += tally->found.pairs;
    sum.inversions += tally->found.inversions;
    sum.group_pairs += tally->found.group_pairs;
    sum.overlaps += tally->found.overlaps;
  }
  if (result == CELLIST_SUCCESS) *found = sum;
  return result;
}
