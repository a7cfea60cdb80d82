/* SPDX-License-Identifier: BSD-3-Clause
 * The inner loop of signs: four tets at a time, in integers. Private to sort/. */
#ifndef CELLIST_SORT_KERNEL_H
#define CELLIST_SORT_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Each plane times the eye, exactly, as a 32-bit integer; above doubt: the eye is outside; below -doubt: inside;
 * otherwise undecided. Faces without a neighbour count as neither.
 * planes: [64 group_count] 16-byte aligned, of each of four tets four planes of four; inner: [group_count] bit
 * 4 tet + face: the face has a neighbour. eye: its sum of squares and each plane's are below 2^30.
 * states: [4 group_count] filled as state.h says: bits 0-3 outside, a wait for each inside. mirrored: NULL, or the same
 * with outside and inside exchanged. undecided: [group_count] filled, bits as inner. */
typedef void (*sort_sign_kernel)(const int16_t *planes, const uint16_t *inner, const int16_t eye[4], int32_t doubt,
                                 size_t group_count, uint8_t *states, uint8_t *mirrored, uint16_t *undecided);

void sort_signs_portable(const int16_t *planes, const uint16_t *inner, const int16_t eye[4], int32_t doubt,
                         size_t group_count, uint8_t *states, uint8_t *mirrored, uint16_t *undecided);

/* The same; only where sort_has_avx2() says so. */
void sort_signs_avx2(const int16_t *planes, const uint16_t *inner, const int16_t eye[4], int32_t doubt,
                     size_t group_count, uint8_t *states, uint8_t *mirrored, uint16_t *undecided);
bool sort_has_avx2(void);

#endif
