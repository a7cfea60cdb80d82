/* SPDX-License-Identifier: BSD-3-Clause
 * Fast walk for AVX2: eight rays to a vector, two vectors in turn.
 *
 * While one group waits for its cells and vertices, the processor works on the other: their steps do not depend on
 * one another, and both fit into its window. A lane whose ray has ended takes the tile's next ray at once, so that
 * lanes stay busy whatever the lengths of rays. Side tests use no fused operation and the same order of operands as
 * fast_side, so that cells are passed exactly as in the portable walk; depths and colours differ by rounding.
 * Compiled with -mavx2 -mfma; see fast_walk.h for the walk itself. */
#include <string.h>

#include "../optics/fast_optics_avx2.h"
#include "fast_walk.h"

enum { LANES = 8, GROUPS = 2 };

/* Eight rays on their way. */
struct group {
  __m256 rx, ry, stretch;
  __m256i cell, apex, prior, id[3];
  __m256 x[3], y[3], a[3], b[3], w[3]; /* of the entry face's corners */
  __m256 z, s;                         /* where the ray entered the cell */
  fast_light8 light;
  fast_interval8 interval;
  __m256 first_z, last_z;
  __m256 near, far; /* what is seen of the ray; only if the scene clips */
  __m256i cell_count, piece_count;
  __m256 active;
  uint32_t pixel[LANES], entry[LANES];
  bool folded[LANES];
};

/* The tile's rays, handed out in order. */
struct queue {
  const fast_scene *scene;
  fast_tile *tile;
  uint32_t next; /* index of fast_tile_pixel */
};

/* ---- Lanes one by one ------------------------------------------------------------------------------- */

static inline __m256 lane_mask(int lane) {
  return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_set1_epi32(lane), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)));
}

/* Written by blending whole vectors: a narrow store would stall the vector load that follows it. */
static inline void put(__m256 *vector, __m256 mask, float value) {
  *vector = fast_select(mask, _mm256_set1_ps(value), *vector);
}

static inline void put_id(__m256i *vector, __m256 mask, uint32_t value) {
  *vector = _mm256_blendv_epi8(*vector, _mm256_set1_epi32((int)value), _mm256_castps_si256(mask));
}

/* Read where they are: groups stay in memory. */
static inline float lane_of(const __m256 *vector, int lane) {
  float value;
  memcpy(&value, (const char *)vector + (size_t)lane * sizeof value, sizeof value);
  return value;
}

static inline uint32_t lane_id_of(const __m256i *vector, int lane) {
  uint32_t value;
  memcpy(&value, (const char *)vector + (size_t)lane * sizeof value, sizeof value);
  return value;
}

/* Sets a lane to where its ray enters a boundary face. Returns false if the face has no say in it. */
static bool enter(const fast_scene *scene, const fast_tile *tile, struct group *group, int lane, bool is_first) {
  const __m256 mask = lane_mask(lane);
  const uint32_t at = group->pixel[lane];
  const float rx = scene->ray_x[tile->left + at % FAST_TILE], ry = scene->ray_y[tile->top + at / FAST_TILE];
  fast_stand stand;
  if (!fast_enter(scene, tile->entries[group->entry[lane]].face, rx, ry, &stand)) return false;
  if (fast_is_edge_on(stand.p, stand.w)) return false;
  put_id(&group->cell, mask, stand.place.cell);
  put_id(&group->apex, mask, stand.place.apex);
  put_id(&group->prior, mask, CELLIST_NONE);
  for (int k = 0; k < 3; k++) {
    put_id(&group->id[k], mask, stand.id[k]);
    put(&group->x[k], mask, stand.p[k].x);
    put(&group->y[k], mask, stand.p[k].y);
    put(&group->a[k], mask, stand.p[k].a);
    put(&group->b[k], mask, stand.p[k].b);
    put(&group->w[k], mask, stand.w[k]);
  }
  if (is_first) {
    put(&group->rx, mask, rx);
    put(&group->ry, mask, ry);
    put(&group->stretch, mask, fast_ray_stretch(scene, rx, ry));
    for (int k = 0; k < 3; k++) put(&group->light.colour[k], mask, 0);
    put(&group->light.transmittance, mask, 1);
    put(&group->light.alpha, mask, 0);
    put(&group->first_z, mask, INFINITY);
    put(&group->last_z, mask, -INFINITY);
    if (scene->clips) {
      put(&group->near, mask, tile->near[at]);
      put(&group->far, mask, tile->far[at]);
    }
    put_id(&group->cell_count, mask, 0);
    put_id(&group->piece_count, mask, 0);
    group->folded[lane] = false;
  } else {
    const float reached = lane_of(&group->z, lane);
    if (stand.now.z < reached - FAST_FOLD_TOLERANCE * (1 + fabsf(reached))) group->folded[lane] = true;
  }
  put(&group->z, mask, stand.now.z);
  put(&group->s, mask, stand.now.s);
  const uint32_t index = isnan(stand.now.s) ? 0 : fast_find_interval(&scene->transfer, stand.now.s);
  put_id(&group->interval.index, mask, index); /* the rest of it is loaded for all lanes that enter */
  group->active = _mm256_or_ps(group->active, mask);
  return true;
}

/* Gives the lane the tile's next ray, or puts it to rest. Rays that get lost at once are listed and passed over. */
static void take_next(struct queue *queue, struct group *group, int lane) {
  fast_tile *tile = queue->tile;
  while (queue->next < FAST_TILE_PIXELS) {
    const uint32_t at = fast_tile_pixel(queue->next++);
    if (tile->first[at] == CELLIST_NONE) continue;
    group->pixel[lane] = at;
    group->entry[lane] = tile->first[at];
    if (enter(queue->scene, tile, group, lane, true)) return;
    tile->pixels[at] = (fast_pixel){.light.transmittance = 1};
    tile->retries[tile->retry_count++] = (uint16_t)at;
  }
  /* Idle lanes keep stepping inside cell 0, where every load is legal. */
  const __m256 mask = lane_mask(lane);
  group->active = _mm256_andnot_ps(mask, group->active);
  put_id(&group->cell, mask, 0);
  put_id(&group->apex, mask, 0);
  put_id(&group->prior, mask, 0);
  for (int k = 0; k < 3; k++) put_id(&group->id[k], mask, 0);
}

static void finish(struct queue *queue, struct group *group, int lane) {
  fast_pixel *pixel = &queue->tile->pixels[group->pixel[lane]];
  for (int k = 0; k < 3; k++) pixel->light.colour[k] = lane_of(&group->light.colour[k], lane);
  pixel->light.transmittance = lane_of(&group->light.transmittance, lane);
  pixel->light.alpha = lane_of(&group->light.alpha, lane);
  pixel->z = lane_of(&group->first_z, lane);
  pixel->z_back = lane_of(&group->last_z, lane);
  pixel->cell_count = lane_id_of(&group->cell_count, lane);
  pixel->piece_count = lane_id_of(&group->piece_count, lane);
  queue->tile->fold_ray_count += group->folded[lane];
}

/* A lane whose ray left the mesh, got lost, or cannot see farther. */
static void end_chain(struct queue *queue, struct group *group, int lane, bool is_lost) {
  fast_tile *tile = queue->tile;
  if (!is_lost) {
    const uint32_t next = tile->entries[group->entry[lane]].next;
    if (next == CELLIST_NONE || lane_of(&group->light.transmittance, lane) < queue->scene->transfer.opaque ||
        (queue->scene->clips && tile->entries[next].z >= tile->far[group->pixel[lane]])) {
      finish(queue, group, lane);
      take_next(queue, group, lane);
      return;
    }
    group->entry[lane] = next;
    if (enter(queue->scene, tile, group, lane, false)) return;
  }
  finish(queue, group, lane);
  tile->retries[tile->retry_count++] = (uint16_t)group->pixel[lane];
  take_next(queue, group, lane);
}

/* ---- Eight lanes at once ---------------------------------------------------------------------------- */

struct points {
  __m256 x, y, a, b;
};

/* Loads a vertex for each lane, and sees it along the lane's ray. */
static inline struct points see(const fast_scene *scene, const struct group *group, __m256i vertex) {
  uint32_t id[LANES];
  _mm256_storeu_si256((__m256i *)id, vertex);
  __m256 row[4];
  for (int i = 0; i < 4; i++)
    row[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(&scene->vertices[id[i]].x)),
                                  _mm_loadu_ps(&scene->vertices[id[i + 4]].x), 1);
  const __m256 low[2] = {_mm256_unpacklo_ps(row[0], row[1]), _mm256_unpacklo_ps(row[2], row[3])};
  const __m256 high[2] = {_mm256_unpackhi_ps(row[0], row[1]), _mm256_unpackhi_ps(row[2], row[3])};
  struct points p = {_mm256_shuffle_ps(low[0], low[1], 0x44), _mm256_shuffle_ps(low[0], low[1], 0xee),
                     _mm256_shuffle_ps(high[0], high[1], 0x44), _mm256_shuffle_ps(high[0], high[1], 0xee)};
  const __m256 rx = scene->sheared ? _mm256_mul_ps(group->rx, p.a) : group->rx;
  const __m256 ry = scene->sheared ? _mm256_mul_ps(group->ry, p.a) : group->ry;
  p.x = _mm256_sub_ps(p.x, rx);
  p.y = _mm256_sub_ps(p.y, ry);
  return p;
}

/* fast_side where a determinant was 0. */
static void break_ties(const struct group *group, const struct points *p, __m256 side[3]) {
  uint32_t apex[LANES], id[LANES];
  float sides[LANES], x[2][LANES], y[2][LANES];
  _mm256_storeu_si256((__m256i *)apex, group->apex);
  _mm256_storeu_ps(x[0], p->x);
  _mm256_storeu_ps(y[0], p->y);
  for (int k = 0; k < 3; k++) {
    _mm256_storeu_si256((__m256i *)id, group->id[k]);
    _mm256_storeu_ps(sides, side[k]);
    _mm256_storeu_ps(x[1], group->x[k]);
    _mm256_storeu_ps(y[1], group->y[k]);
    for (int i = 0; i < LANES; i++)
      if (sides[i] == 0)
        sides[i] =
            fast_side((fast_point){x[0][i], y[0][i], 0, 0}, (fast_point){x[1][i], y[1][i], 0, 0}, apex[i], id[i]);
    side[k] = _mm256_loadu_ps(sides);
  }
}

static inline __m256i blend_id(__m256i no, __m256i yes, __m256 mask) {
  return _mm256_castps_si256(fast_select(mask, _mm256_castsi256_ps(yes), _mm256_castsi256_ps(no)));
}

/* fast_cells_next for eight lanes; lanes of rest go to cell 0. */
static inline void next_cells(const fast_scene *scene, fast_layout layout, struct group *group, __m256i leaving) {
  const __m256i below[3] = {_mm256_cmpgt_epi32(leaving, group->id[0]), _mm256_cmpgt_epi32(leaving, group->id[1]),
                            _mm256_cmpgt_epi32(leaving, group->id[2])};
  /* Comparisons give -1: this is minus the rank. */
  const __m256i rank = _mm256_add_epi32(_mm256_add_epi32(below[0], below[1]), below[2]);
  const __m256i rest = _mm256_castps_si256(group->active);
  __m256i next, apex;
  if (layout == FAST_RANKED) {
    uint32_t pair[LANES];
    _mm256_storeu_si256((__m256i *)pair, _mm256_sub_epi32(_mm256_slli_epi32(group->cell, 2), rank));
    __m128 two[4];
    for (int i = 0; i < 4; i++) {
      const double *pairs = (const double *)(const void *)scene->cells.words;
      two[i] = _mm_castpd_ps(_mm_loadh_pd(_mm_load_sd(&pairs[pair[2 * i]]), &pairs[pair[2 * i + 1]]));
    }
    const __m256 even = _mm256_insertf128_ps(_mm256_castps128_ps256(two[0]), two[2], 1);
    const __m256 odd = _mm256_insertf128_ps(_mm256_castps128_ps256(two[1]), two[3], 1);
    next = _mm256_castps_si256(_mm256_shuffle_ps(even, odd, 0x88));
    apex = _mm256_castps_si256(_mm256_shuffle_ps(even, odd, 0xdd));
  } else {
    const uint32_t stride = (uint32_t)FAST_CELL_SIZE[layout] / 4;
    const uint32_t *words = scene->cells.words;
    uint32_t cell[LANES], place[LANES], left[LANES], prior[LANES], entry[LANES], ahead[LANES], all[LANES];
    _mm256_storeu_si256((__m256i *)cell, group->cell);
    _mm256_storeu_si256((__m256i *)place, _mm256_sub_epi32(_mm256_setzero_si256(), rank));
    if (layout == FAST_TET32) _mm256_storeu_si256((__m256i *)left, leaving);
    if (layout == FAST_TET16) {
      const __m256i entry_rank = _mm256_add_epi32(
          _mm256_add_epi32(_mm256_cmpgt_epi32(group->apex, leaving), _mm256_cmpgt_epi32(group->apex, group->id[0])),
          _mm256_add_epi32(_mm256_cmpgt_epi32(group->apex, group->id[1]),
                           _mm256_cmpgt_epi32(group->apex, group->id[2])));
      _mm256_storeu_si256((__m256i *)entry, _mm256_sub_epi32(_mm256_setzero_si256(), entry_rank));
      _mm256_storeu_si256((__m256i *)prior, group->prior);
    }
    for (int i = 0; i < LANES; i++) {
      const uint32_t *record = &words[(size_t)stride * cell[i]];
      if (layout == FAST_TET32)
        ahead[i] = record[left[i] == record[0] ? 4 : left[i] == record[1] ? 5 : left[i] == record[2] ? 6 : 7];
      else if (layout == FAST_TET20)
        ahead[i] = record[1 + place[i]];
      else
        ahead[i] = prior[i] ^ (entry[i] > 0 ? record[entry[i]] : 0) ^ (place[i] > 0 ? record[place[i]] : 0);
    }
    next = _mm256_loadu_si256((const __m256i *)ahead);
    for (int i = 0; i < LANES; i++)
      all[i] = words[(size_t)stride * (ahead[i] < scene->cells.count ? ahead[i] : 0) + (layout == FAST_TET32 ? 3 : 0)];
    apex = _mm256_xor_si256(_mm256_xor_si256(_mm256_loadu_si256((const __m256i *)all), group->id[0]),
                            _mm256_xor_si256(group->id[1], group->id[2]));
    if (layout == FAST_TET16) group->prior = group->cell;
  }
  group->cell = _mm256_and_si256(next, rest);
  group->apex = _mm256_and_si256(apex, rest);
}

/* Extinction at scalars of the lanes' intervals. */
static inline __m256 extinctions(const fast_interval8 *in, __m256 s) {
  return _mm256_fmadd_ps(in->extinction_slope, _mm256_sub_ps(s, in->low), in->extinction);
}

/* fast_is_doubtful for eight lanes. extinction: at the segments' front ends; index: their intervals there. */
static inline __m256 find_doubtful(const struct group *group, __m256 extent, __m256 extinction, __m256i index,
                                   __m256 next_s, __m256 before) {
  const fast_interval8 *in = &group->interval;
  const __m256 most = _mm256_max_ps(extinction, extinctions(in, next_s));
  const __m256 dense = _mm256_cmp_ps(most, _mm256_set1_ps(FAST_DENSE), _CMP_GT_OQ);
  const __m256 same = _mm256_castsi256_ps(_mm256_cmpeq_epi32(index, in->index));
  const __m256 is_short = _mm256_cmp_ps(extent, _mm256_set1_ps(FAST_SHORT), _CMP_LT_OQ);
  const __m256 unseen = _mm256_mul_ps(_mm256_set1_ps(FAST_UNSEEN), before);
  const __m256 seen = _mm256_cmp_ps(group->light.transmittance, unseen, _CMP_GT_OQ);
  const __m256 is_bad =
      _mm256_or_ps(_mm256_and_ps(dense, _mm256_or_ps(is_short, seen)), _mm256_andnot_ps(same, is_short));
  return _mm256_and_ps(is_bad, _mm256_cmp_ps(before, _mm256_set1_ps(FAST_FAINT), _CMP_GT_OQ));
}

/* The light of the cell between (z, s) and where the ray leaves it; lanes: those to be drawn. Returns those among them
 * that show the rounding of depths. */
static inline __m256 add_cells(const fast_scene *scene, struct group *group, __m256 lanes, __m256 s, __m256 next_z,
                               __m256 next_s) {
  __m256 z = group->z;
  fast_interval8 *in = &group->interval;
  __m256i counted = _mm256_castps_si256(group->active);
  if (scene->clips) {
    const __m256 near = group->near, far = group->far;
    const __m256 seen = _mm256_and_ps(_mm256_cmp_ps(next_z, near, _CMP_GT_OQ), _mm256_cmp_ps(z, far, _CMP_LT_OQ));
    counted = _mm256_castps_si256(_mm256_and_ps(group->active, seen));
    lanes = _mm256_and_ps(lanes, seen);
    const __m256 before = _mm256_and_ps(_mm256_cmp_ps(z, near, _CMP_LT_OQ), lanes);
    const __m256 beyond = _mm256_and_ps(_mm256_cmp_ps(next_z, far, _CMP_GT_OQ), lanes);
    if (fast_any(_mm256_or_ps(before, beyond))) {
      const __m256 extent = _mm256_sub_ps(next_z, z), rise = _mm256_sub_ps(next_s, s);
      const __m256 near_s = _mm256_fmadd_ps(_mm256_div_ps(_mm256_sub_ps(near, z), extent), rise, s);
      const __m256 far_s = _mm256_fmadd_ps(_mm256_div_ps(_mm256_sub_ps(far, z), extent), rise, s);
      s = fast_select(before, near_s, s);
      z = fast_select(before, near, z);
      next_s = fast_select(beyond, far_s, next_s);
      next_z = fast_select(beyond, far, next_z);
    }
  }
  group->cell_count = _mm256_sub_epi32(group->cell_count, counted);
  const __m256 is_deep = _mm256_cmp_ps(next_z, z, _CMP_GT_OQ), flat = _mm256_andnot_ps(is_deep, lanes);
  __m256 watched = lanes;
  lanes = _mm256_and_ps(lanes, is_deep);
  if (scene->clips || scene->has_nan || scene->cell_scalars != NULL) {
    const __m256 ordered = _mm256_cmp_ps(s, next_s, _CMP_ORD_Q);
    watched = _mm256_and_ps(watched, ordered);
    lanes = _mm256_and_ps(lanes, ordered);
    s = _mm256_and_ps(s, watched);
    next_s = _mm256_and_ps(next_s, watched);
    const __m256 outside = _mm256_or_ps(_mm256_cmp_ps(s, in->low, _CMP_LT_OQ), _mm256_cmp_ps(s, in->high, _CMP_GT_OQ));
    if (fast_any(_mm256_and_ps(outside, lanes)))
      fast_seek_intervals8(&scene->transfer, s, _mm256_and_ps(outside, lanes), in);
  }
  const __m256 depth = _mm256_sub_ps(next_z, z), length = _mm256_mul_ps(depth, group->stretch);
  const __m256 none = _mm256_setzero_ps(), before = group->light.transmittance;
  const __m256 extinction = scene->is_dense ? extinctions(in, s) : none;
  const __m256i index = in->index;
  /* A cell without depth adds nothing, but the next one begins at its far scalar, whose interval must be at hand. */
  if (fast_any(flat)) fast_seek_intervals8(&scene->transfer, next_s, flat, in);
  if (!scene->wants_depth) {
    fast_add_segment8(&scene->transfer, in, s, next_s, length, lanes, &group->light, &group->piece_count, NULL);
    return scene->is_dense ? _mm256_and_ps(watched, find_doubtful(group, depth, extinction, index, next_s, before))
                           : none;
  }
  __m256 seen[2] = {_mm256_set1_ps(2), _mm256_set1_ps(-1)};
  fast_add_segment8(&scene->transfer, in, s, next_s, length, lanes, &group->light, &group->piece_count, seen);
  const __m256 extent = _mm256_sub_ps(next_z, z);
  const __m256 gained = _mm256_and_ps(_mm256_cmp_ps(seen[1], _mm256_setzero_ps(), _CMP_GE_OQ), lanes);
  const __m256 begin = _mm256_fmadd_ps(seen[0], extent, z), end = _mm256_fmadd_ps(seen[1], extent, z);
  group->first_z = fast_select(gained, _mm256_min_ps(group->first_z, begin), group->first_z);
  group->last_z = fast_select(gained, _mm256_max_ps(group->last_z, end), group->last_z);
  return scene->is_dense ? _mm256_and_ps(watched, find_doubtful(group, depth, extinction, index, next_s, before))
                         : none;
}

/* Where the rays pass the faces through which they leave: fast_cross, and fast_is_edge_on as a mask. */
static inline __m256 cross_faces(const fast_scene *scene, const struct group *group, __m256 *z, __m256 *s) {
  const __m256 *w = group->w;
  const __m256 sum = _mm256_add_ps(_mm256_add_ps(w[0], w[1]), w[2]);
  __m256 a = _mm256_mul_ps(w[0], group->a[0]), b = _mm256_mul_ps(w[0], group->b[0]), reach = _mm256_setzero_ps();
  for (int k = 1; k < 3; k++) {
    a = _mm256_fmadd_ps(w[k], group->a[k], a);
    b = _mm256_fmadd_ps(w[k], group->b[k], b);
  }
  for (int k = 0; k < 3; k++)
    reach = _mm256_max_ps(reach, _mm256_fmadd_ps(group->x[k], group->x[k], _mm256_mul_ps(group->y[k], group->y[k])));
  const __m256 reciprocal = _mm256_div_ps(_mm256_set1_ps(1), scene->reciprocal ? _mm256_sub_ps(sum, a) : sum);
  *z = _mm256_mul_ps(scene->reciprocal ? _mm256_mul_ps(_mm256_set1_ps(scene->farthest), a) : a, reciprocal);
  *s = _mm256_mul_ps(b, reciprocal);
  return _mm256_cmp_ps(sum, _mm256_mul_ps(_mm256_set1_ps(FAST_EDGE_ON), reach), _CMP_LT_OQ);
}

/* One cell for each lane. Returns the lanes whose chain ends here; *lost: those that got lost. */
static inline int step(const fast_scene *scene, fast_layout layout, struct group *group, int *lost) {
  const struct points p = see(scene, group, group->apex);
  __m256 side[3];
  for (int k = 0; k < 3; k++) side[k] = _mm256_sub_ps(_mm256_mul_ps(p.x, group->y[k]), _mm256_mul_ps(p.y, group->x[k]));
  const __m256 zero = _mm256_setzero_ps();
  const __m256 tie =
      _mm256_or_ps(_mm256_or_ps(_mm256_cmp_ps(side[0], zero, _CMP_EQ_OQ), _mm256_cmp_ps(side[1], zero, _CMP_EQ_OQ)),
                   _mm256_cmp_ps(side[2], zero, _CMP_EQ_OQ));
  if (fast_any(_mm256_and_ps(tie, group->active))) break_ties(group, &p, side);

  /* The exit face has the apex in the place of corner k where side[k+1] > 0 > side[k+2]: told by sign bits alone. */
  const __m256 exit[3] = {_mm256_andnot_ps(side[1], side[2]), _mm256_andnot_ps(side[2], side[0]),
                          _mm256_andnot_ps(side[0], side[1])};
  const int active = _mm256_movemask_ps(group->active);
  int bad = active & ~_mm256_movemask_ps(_mm256_or_ps(_mm256_or_ps(exit[0], exit[1]), exit[2]));

  const __m256i cell = group->cell;
  const __m256i leaving = blend_id(blend_id(group->id[0], group->id[1], exit[1]), group->id[2], exit[2]);
  for (int k = 0; k < 3; k++) group->id[k] = blend_id(group->id[k], group->apex, exit[k]);
  next_cells(scene, layout, group, leaving);

  __m256 usable = group->active;
  if (scene->has_nan) {
    const __m256 sum = _mm256_add_ps(_mm256_add_ps(group->b[0], group->b[1]), _mm256_add_ps(group->b[2], p.b));
    usable = _mm256_and_ps(usable, _mm256_cmp_ps(sum, sum, _CMP_ORD_Q));
  }
  const __m256 sign = _mm256_set1_ps(-0.0f);
  for (int k = 0; k < 3; k++) side[k] = _mm256_andnot_ps(sign, side[k]);
  group->w[0] = fast_select(exit[2], side[1], fast_select(exit[1], side[2], group->w[0]));
  group->w[1] = fast_select(exit[2], side[0], fast_select(exit[0], side[2], group->w[1]));
  group->w[2] = fast_select(exit[1], side[0], fast_select(exit[0], side[1], group->w[2]));
  for (int k = 0; k < 3; k++) {
    group->x[k] = fast_select(exit[k], p.x, group->x[k]);
    group->y[k] = fast_select(exit[k], p.y, group->y[k]);
    group->a[k] = fast_select(exit[k], p.a, group->a[k]);
    group->b[k] = fast_select(exit[k], p.b, group->b[k]);
  }
  __m256 next_z, next_s;
  const __m256 edge_on = cross_faces(scene, group, &next_z, &next_s);
  bad |= active & _mm256_movemask_ps(edge_on);
  next_z = _mm256_max_ps(next_z, group->z);
  if (bad != 0) { /* nothing of these lanes will be used; keep their numbers out of the optics */
    const __m256i bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const __m256i is_bad = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(bad), bits), bits);
    usable = _mm256_andnot_ps(_mm256_castsi256_ps(is_bad), usable);
  }
  __m256 doubtful;
  if (scene->cell_scalars != NULL) {
    uint32_t cells[LANES];
    float scalars[LANES];
    _mm256_storeu_si256((__m256i *)cells, cell);
    for (int i = 0; i < LANES; i++) scalars[i] = scene->cell_scalars[cells[i]];
    const __m256 s = _mm256_loadu_ps(scalars);
    doubtful = add_cells(scene, group, usable, s, next_z, s);
  } else {
    doubtful = add_cells(scene, group, usable, group->s, next_z, next_s);
  }
  bad |= _mm256_movemask_ps(doubtful);
  group->z = next_z;
  group->s = next_s;

  const __m256i outside = _mm256_cmpeq_epi32(group->cell, _mm256_set1_epi32((int)CELLIST_NONE));
  __m256 hidden = _mm256_cmp_ps(group->light.transmittance, _mm256_set1_ps(scene->transfer.opaque), _CMP_LT_OQ);
  if (scene->clips) hidden = _mm256_or_ps(hidden, _mm256_cmp_ps(next_z, group->far, _CMP_GE_OQ));
  *lost = bad;
  return bad | (active & _mm256_movemask_ps(_mm256_or_ps(_mm256_castsi256_ps(outside), hidden)));
}

static inline void walk_tile(const fast_scene *scene, fast_tile *tile, fast_layout layout) {
  struct group groups[GROUPS];
  memset(groups, 0, sizeof groups);
  struct queue queue = {scene, tile, 0};
  for (int g = 0; g < GROUPS; g++) {
    for (int k = 0; k < 3; k++) groups[g].w[k] = _mm256_set1_ps(1);
    for (int lane = 0; lane < LANES; lane++) take_next(&queue, &groups[g], lane);
    fast_load_intervals8(&scene->transfer, &groups[g].interval);
  }
  uint64_t steps = 0;
  for (;;) {
    int busy = 0;
    for (int g = 0; g < GROUPS; g++) {
      const int active = _mm256_movemask_ps(groups[g].active);
      if (active == 0) continue;
      busy = 1;
      steps += (unsigned)__builtin_popcount((unsigned)active);
      int lost;
      int ended = step(scene, layout, &groups[g], &lost);
      if (ended == 0) continue;
      for (; ended != 0; ended &= ended - 1) {
        const int lane = __builtin_ctz((unsigned)ended);
        end_chain(&queue, &groups[g], lane, lost >> lane & 1);
      }
      fast_load_intervals8(&scene->transfer, &groups[g].interval);
    }
    if (busy == 0) break;
  }
  tile->step_count += steps;
}

/* One copy of the walk a layout. */
static void walk_ranked(const fast_scene *scene, fast_tile *tile) { walk_tile(scene, tile, FAST_RANKED); }
static void walk_tet32(const fast_scene *scene, fast_tile *tile) { walk_tile(scene, tile, FAST_TET32); }
static void walk_tet20(const fast_scene *scene, fast_tile *tile) { walk_tile(scene, tile, FAST_TET20); }
static void walk_tet16(const fast_scene *scene, fast_tile *tile) { walk_tile(scene, tile, FAST_TET16); }

void fast_walk_avx2(const fast_scene *scene, fast_tile *tile) {
  static void (*const WALK[FAST_LAYOUT_COUNT])(const fast_scene *, fast_tile *) = {walk_ranked, walk_tet32, walk_tet20,
                                                                                   walk_tet16};
  WALK[scene->cells.layout](scene, tile);
}
