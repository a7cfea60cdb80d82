/* SPDX-License-Identifier: BSD-3-Clause
 * Validate: runs the checks, turns marked tets into cells of the user's file, and names what was found. */
#include "validate_private.h"

#include <cellist/radix.h>
#include <stdio.h>

static const struct kind {
  const char *name, *description;
  cellist_severity severity;
} KINDS[CELLIST_FINDING_COUNT] = {
    [CELLIST_FINDING_INVERTED] = {"inverted", "cells were given inside out and are turned", CELLIST_FLAW},
    [CELLIST_FINDING_FLAT] = {"flat", "cells have no volume and are not drawn", CELLIST_FLAW},
    [CELLIST_FINDING_NEEDLE] = {"needle", "cells have a dihedral angle under 0.1 degree", CELLIST_WARNING},
    [CELLIST_FINDING_DUPLICATE] = {"duplicate", "cells have the same points as another", CELLIST_FLAW},
    [CELLIST_FINDING_FOLDED] = {"folded", "cells lie on the same side of a face as their neighbour", CELLIST_FLAW},
    [CELLIST_FINDING_OVERFULL] = {"overfull", "cells share a face with more than one other", CELLIST_FLAW},
    [CELLIST_FINDING_HANGING] = {"hanging", "cells border on faces that do not match theirs (hanging nodes)",
                                 CELLIST_FLAW},
    [CELLIST_FINDING_SEAM] = {"seam", "cells border on equal faces of other points (--merge joins them)",
                              CELLIST_WARNING},
    [CELLIST_FINDING_TOUCHING] = {"touching", "cells touch the boundary of others", CELLIST_WARNING},
    [CELLIST_FINDING_CROSSING] = {"crossing", "cells run through the boundary of others", CELLIST_FLAW},
    [CELLIST_FINDING_INFINITE] = {"infinite", "cells have a NaN or infinite coordinate and are left out", CELLIST_FLAW},
    [CELLIST_FINDING_COLLAPSED] = {"collapsed", "cells use a point twice and are left out", CELLIST_WARNING},
    [CELLIST_FINDING_NAN_SCALAR] = {"nan-scalar", "cells have a NaN or infinite value and are not drawn in that scalar",
                                    CELLIST_WARNING},
    [CELLIST_FINDING_UNUSED] = {"unused", "points are used by no cell", CELLIST_NOTE},
    [CELLIST_FINDING_COINCIDENT] = {"coincident", "points lie where another one does (--merge joins them)",
                                    CELLIST_WARNING},
};

static const struct kind *kind_of(cellist_finding_kind kind) {
  return (unsigned)kind < CELLIST_FINDING_COUNT ? &KINDS[kind] : NULL;
}

const char *cellist_finding_name(cellist_finding_kind kind) {
  return kind_of(kind) != NULL ? kind_of(kind)->name : NULL;
}

const char *cellist_finding_description(cellist_finding_kind kind) {
  return kind_of(kind) != NULL ? kind_of(kind)->description : NULL;
}

cellist_severity cellist_finding_severity(cellist_finding_kind kind) {
  return kind_of(kind) != NULL ? kind_of(kind)->severity : CELLIST_NOTE;
}

void finding_keep(cellist_finding *finding, uint32_t id) {
  size_t to = finding->id_count;
  if (to == CELLIST_FINDING_IDS && finding->ids[to - 1] < id) return;
  if (to < CELLIST_FINDING_IDS)
    finding->id_count++;
  else
    to--;
  for (; to > 0 && finding->ids[to - 1] > id; to--) finding->ids[to] = finding->ids[to - 1];
  finding->ids[to] = id;
}

/* The distinct cells of the file among the marked tets of one kind. */
static cellist_result collect(const validation *run, cellist_finding_kind kind) {
  const unsigned bit = 1u << kind;
  cellist_finding *finding = &run->report->findings[kind];
  size_t count = 0;
  for (size_t t = 0; t < run->mesh->tet_count; t++) count += (run->marks[t] & bit) != 0;
  if (count == 0) return CELLIST_SUCCESS;
  uint64_t *keys = cellist_allocate(run->context, count, 2 * sizeof *keys);
  uint32_t *values = cellist_allocate_zeroed(run->context, count, 2 * sizeof *values);
  const bool ok = keys != NULL && values != NULL;
  if (ok) {
    size_t next = 0;
    for (size_t t = 0; t < run->mesh->tet_count; t++)
      if (run->marks[t] & bit) keys[next++] = run->mesh->tet_origin[t];
    cellist_radix_sort(keys, values, count, keys + count, values + count, 32);
    for (size_t i = 0; i < count; i++) {
      if (i > 0 && keys[i] == keys[i - 1]) continue;
      if (finding->id_count < CELLIST_FINDING_IDS) finding->ids[finding->id_count++] = (uint32_t)keys[i];
      finding->count++;
    }
  }
  cellist_deallocate(run->context, keys);
  cellist_deallocate(run->context, values);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

static void take_over(cellist_finding *finding, size_t count, const uint32_t ids[CELLIST_FACT_IDS]) {
  finding->count = count;
  for (size_t i = 0; i < count && i < CELLIST_FACT_IDS; i++) finding_keep(finding, ids[i]);
}

static cellist_result conclude(const validation *run) {
  cellist_report *report = run->report;
  const cellist_mesh_facts *facts = run->facts;
  take_over(&report->findings[CELLIST_FINDING_INFINITE], facts->infinite_cell_count, facts->infinite_cells);
  take_over(&report->findings[CELLIST_FINDING_COLLAPSED], facts->collapsed_cell_count, facts->collapsed_cells);
  unsigned all_marks = 0;
  for (size_t t = 0; t < run->mesh->tet_count; t++) all_marks |= run->marks[t];
  for (int kind = 0; kind < CELLIST_FINDING_COUNT; kind++) {
    const cellist_result result = all_marks >> kind & 1 ? collect(run, kind) : CELLIST_SUCCESS;
    if (result != CELLIST_SUCCESS) return result;
    const bool is_found = report->findings[kind].count > 0;
    report->flaw_count += is_found && KINDS[kind].severity == CELLIST_FLAW;
    report->warning_count += is_found && KINDS[kind].severity == CELLIST_WARNING;
  }
  report->inverted_cell_count = report->findings[CELLIST_FINDING_INVERTED].count;
  report->degenerate_cell_count = report->findings[CELLIST_FINDING_FLAT].count;
  return CELLIST_SUCCESS;
}

static cellist_result fail_strictly(cellist_context *context, const cellist_report *report) {
  int kind = 0;
  while (report->findings[kind].count == 0 || KINDS[kind].severity != CELLIST_FLAW) kind++;
  const cellist_finding *finding = &report->findings[kind];
  char ids[128] = "";
  size_t length = 0;
  for (size_t i = 0; i < finding->id_count; i++)
    length += (size_t)snprintf(ids + length, sizeof ids - length, "%s%u", i > 0 ? " " : ": ", finding->ids[i]);
  return cellist_fail(context, CELLIST_ERROR_GEOMETRY, "%zu %s%s%s (%zu kinds of flaws in all)", finding->count,
                      KINDS[kind].description, ids, finding->count > finding->id_count ? " ..." : "",
                      report->flaw_count);
}

static cellist_result validate(validation *run, bool ignore_contacts) {
  run->marks = cellist_allocate_zeroed(run->context, run->mesh->tet_count, sizeof *run->marks);
  if (run->marks == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_result result = cellist_progress(run->context, "validating", 0);
  if (result == CELLIST_SUCCESS) result = validate_cells(run);
  if (result == CELLIST_SUCCESS) result = validate_points(run);
  if (result == CELLIST_SUCCESS) result = validate_boundary(run);
  if (result == CELLIST_SUCCESS) result = cellist_progress(run->context, "validating", 0.5);
  if (result == CELLIST_SUCCESS && !ignore_contacts) result = validate_contacts(run);
  if (result == CELLIST_SUCCESS) result = conclude(run);
  return result == CELLIST_SUCCESS ? cellist_progress(run->context, "validating", 1) : result;
}

cellist_result cellist_validate(cellist_context *context, const cellist_mesh *mesh, const cellist_validate_desc *desc,
                                cellist_report *report) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || report == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_validate: mesh or report is NULL");
  *report = (cellist_report){0};
  validation run = {.context = context,
                    .mesh = cellist_mesh_get_arrays(mesh),
                    .facts = cellist_mesh_get_facts(mesh),
                    .report = report};
  cellist_result result = validate(&run, desc != NULL && desc->ignore_contacts);
  cellist_deallocate(context, run.marks);
  cellist_deallocate(context, run.place);
  cellist_deallocate(context, run.faces);
  if (result == CELLIST_SUCCESS && desc != NULL && desc->strict && report->flaw_count > 0)
    result = fail_strictly(context, report);
  return result;
}
