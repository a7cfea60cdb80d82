/* SPDX-License-Identifier: BSD-3-Clause
 * Random numbers that are the same on every machine (splitmix64; Steele, Lea, Flood 2014). Private to the project. */
#ifndef CELLIST_RANDOM_H
#define CELLIST_RANDOM_H

#include <stdint.h>

typedef struct random_state {
  uint64_t state; /* start with the seed */
} random_state;

static inline uint64_t random_bits(random_state *random) {
  uint64_t z = random->state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* Uniform in [0, 1), a multiple of 2^-53. */
static inline double random_unit(random_state *random) { return (double)(random_bits(random) >> 11) * 0x1p-53; }

/* Uniform in [low, high). */
static inline double random_between(random_state *random, double low, double high) {
  return low + (high - low) * random_unit(random);
}

/* Uniform in 0..count-1 (to within count / 2^64). */
static inline uint64_t random_below(random_state *random, uint64_t count) {
  return (uint64_t)(((__uint128_t)random_bits(random) * count) >> 64);
}

#endif
