/* SPDX-License-Identifier: BSD-3-Clause
 * Wide integers for exact decisions: sign, product, sum and difference of signed integers of up to WIDE_LIMBS
 * 64-bit limbs, and the exact conversion of doubles that share a power of two. Private to the project.
 *
 * A set of finite doubles is a set of integers times one power of two 2^e (e the smallest exponent of a lowest set
 * bit), and the sign of a homogeneous polynomial does not depend on that factor. So a polynomial of degree d on
 * doubles of b bits (53 plus the spread of exponents, 2098 at most) needs d * b bits and some carries. Numbers carry
 * their length, so the usual few-limb case touches a few words only. */
#ifndef CELLIST_WIDE_H
#define CELLIST_WIDE_H

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* 13 factors of 2100 bits (the comparison of two meets of three planes) plus carries; smaller overflows there. */
enum { WIDE_LIMBS = 448 };

typedef struct wide {
  int sign;      /* -1, 0, 1; 0 if and only if length is 0 */
  size_t length; /* limbs in use, the highest is not 0 */
  uint64_t limb[WIDE_LIMBS];
} wide;

static inline void wide_copy(wide *out, const wide *a) {
  out->sign = a->sign;
  out->length = a->length;
  memcpy(out->limb, a->limb, a->length * sizeof a->limb[0]);
}

/* The exponent of x's lowest set bit; INT_MAX-like 4096 for 0. */
static inline int wide_lowest_exponent(double x) {
  if (x == 0) return 4096;
  int exponent = 0;
  const double mantissa = frexp(x, &exponent);
  const uint64_t integer = (uint64_t)ldexp(fabs(mantissa), 53);
  return exponent - 53 + __builtin_ctzll(integer);
}

/* out = x / 2^base, exactly; base is at most x's lowest exponent. */
static inline void wide_from_double(wide *out, double x, int base) {
  out->sign = 0;
  out->length = 0;
  if (x == 0) return;
  int exponent = 0;
  const double mantissa = frexp(x, &exponent);
  uint64_t integer = (uint64_t)ldexp(fabs(mantissa), 53);
  const int trailing = __builtin_ctzll(integer);
  integer >>= trailing;
  const unsigned shift = (unsigned)(exponent - 53 + trailing - base);
  const size_t words = shift / 64;
  const unsigned bits = shift % 64;
  memset(out->limb, 0, words * sizeof out->limb[0]);
  out->limb[words] = integer << bits;
  out->length = words + 1;
  if (bits > 0 && integer >> (64 - bits) != 0) out->limb[out->length++] = integer >> (64 - bits);
  out->sign = x > 0 ? 1 : -1;
}

static inline int wide_compare_magnitude(const wide *a, const wide *b) {
  if (a->length != b->length) return a->length > b->length ? 1 : -1;
  for (size_t i = a->length; i-- > 0;)
    if (a->limb[i] != b->limb[i]) return a->limb[i] > b->limb[i] ? 1 : -1;
  return 0;
}

/* out = |a| + |b| with the given sign; out may be a or b. */
static inline void wide_add_magnitude(wide *out, const wide *a, const wide *b, int sign) {
  if (a->length < b->length) {
    const wide *swap = a;
    a = b;
    b = swap;
  }
  const size_t longer = a->length, shorter = b->length;
  uint64_t carry = 0;
  for (size_t i = 0; i < longer; i++) {
    const __uint128_t sum = (__uint128_t)a->limb[i] + (i < shorter ? b->limb[i] : 0) + carry;
    out->limb[i] = (uint64_t)sum;
    carry = (uint64_t)(sum >> 64);
  }
  out->length = longer;
  if (carry != 0) {
    assert(out->length < WIDE_LIMBS);
    out->limb[out->length++] = carry;
  }
  out->sign = sign;
}

/* out = |a| - |b|, |a| > |b|, with the given sign; out may be a or b. */
static inline void wide_subtract_magnitude(wide *out, const wide *a, const wide *b, int sign) {
  const size_t longer = a->length, shorter = b->length;
  uint64_t borrow = 0;
  for (size_t i = 0; i < longer; i++) {
    const __uint128_t difference = (__uint128_t)a->limb[i] - (i < shorter ? b->limb[i] : 0) - borrow;
    out->limb[i] = (uint64_t)difference;
    borrow = (uint64_t)(difference >> 64) & 1;
  }
  out->length = longer;
  while (out->length > 0 && out->limb[out->length - 1] == 0) out->length--;
  out->sign = sign;
}

/* out = a + b_sign * |b|; out may be a or b. */
static inline void wide_add_signed(wide *out, const wide *a, const wide *b, int b_sign) {
  if (b_sign == 0) {
    if (out != a) wide_copy(out, a);
  } else if (a->sign == 0) {
    if (out != b) wide_copy(out, b);
    out->sign = b_sign;
  } else if (a->sign == b_sign) {
    wide_add_magnitude(out, a, b, b_sign);
  } else {
    const int order = wide_compare_magnitude(a, b);
    if (order == 0) {
      out->sign = 0;
      out->length = 0;
    } else if (order > 0) {
      wide_subtract_magnitude(out, a, b, a->sign);
    } else {
      wide_subtract_magnitude(out, b, a, b_sign);
    }
  }
}

static inline void wide_add(wide *out, const wide *a, const wide *b) { wide_add_signed(out, a, b, b->sign); }
static inline void wide_subtract(wide *out, const wide *a, const wide *b) { wide_add_signed(out, a, b, -b->sign); }

/* out = a * b; out is neither. */
static inline void wide_multiply(wide *out, const wide *a, const wide *b) {
  out->sign = a->sign * b->sign;
  out->length = 0;
  if (out->sign == 0) return;
  assert(a->length + b->length <= WIDE_LIMBS);
  out->length = a->length + b->length;
  memset(out->limb, 0, out->length * sizeof out->limb[0]);
  for (size_t i = 0; i < a->length; i++) {
    uint64_t carry = 0;
    for (size_t j = 0; j < b->length; j++) {
      const __uint128_t sum = (__uint128_t)a->limb[i] * b->limb[j] + out->limb[i + j] + carry;
      out->limb[i + j] = (uint64_t)sum;
      carry = (uint64_t)(sum >> 64);
    }
    out->limb[i + b->length] = carry;
  }
  if (out->limb[out->length - 1] == 0) out->length--;
}

/* out = a * d - b * c; out is none of them, scratch is neither. */
static inline void wide_determinant2(wide *out, const wide *a, const wide *b, const wide *c, const wide *d,
                                     wide *scratch) {
  wide_multiply(out, a, d);
  wide_multiply(scratch, b, c);
  wide_subtract(out, out, scratch);
}

#endif
