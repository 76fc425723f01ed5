// SPDX-License-Identifier: Apache-2.0
/// @file lanes_level.hpp
/// Lanes of one vector level: arithmetic, comparisons, selection, cosine and sine.
///
/// Included by lanes.hpp within the namespace of each level.
// No guard and no includes: see lanes_each_level.hpp.

// Without the sanitizers: they would take minutes to compile, for what only computes.
#define STRAINWAVE_INLINE \
  [[gnu::always_inline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline

template <class Real>
struct LaneVectors {
  using Whole = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
  using Reals [[gnu::vector_size(STRAINWAVE_LANE_BYTES)]] = Real;
  using Wholes [[gnu::vector_size(STRAINWAVE_LANE_BYTES)]] = Whole;
};

/// Yes or no for each lane.
template <class Real>
struct LaneMask {
#if STRAINWAVE_LANE_LEVEL == 4
  using Bits = std::conditional_t<sizeof(Real) == 4, __mmask16, __mmask8>;
  /// Intrinsics with a mask of all lanes do without the undefined value that GCC 12 warns about.
  static constexpr Bits every = static_cast<Bits>(-1);
  Bits bits;

  STRAINWAVE_INLINE LaneMask operator&(LaneMask other) const {
    return {static_cast<Bits>(bits & other.bits)};
  }
  STRAINWAVE_INLINE LaneMask operator|(LaneMask other) const {
    return {static_cast<Bits>(bits | other.bits)};
  }
  STRAINWAVE_INLINE LaneMask operator!() const { return {static_cast<Bits>(~bits)}; }
  [[nodiscard]] STRAINWAVE_INLINE bool any() const { return bits != 0; }
  [[nodiscard]] STRAINWAVE_INLINE bool all() const { return bits == every; }
#else
  using Bits = LaneVectors<Real>::Wholes;
  Bits bits;

  STRAINWAVE_INLINE LaneMask operator&(LaneMask other) const { return {bits & other.bits}; }
  STRAINWAVE_INLINE LaneMask operator|(LaneMask other) const { return {bits | other.bits}; }
  STRAINWAVE_INLINE LaneMask operator!() const { return {~bits}; }
  [[nodiscard]] STRAINWAVE_INLINE bool any() const {
#if STRAINWAVE_LANE_LEVEL == 3
    return _mm256_movemask_epi8(__builtin_bit_cast(__m256i, bits)) != 0;
#elif STRAINWAVE_HAS_X86_LEVELS
    return _mm_movemask_epi8(__builtin_bit_cast(__m128i, bits)) != 0;
#elif defined(__aarch64__)
    return vmaxvq_u32(__builtin_bit_cast(uint32x4_t, bits)) != 0;
#else
    bool found = false;
    for (std::size_t i = 0; i < STRAINWAVE_LANE_BYTES / sizeof(Real); ++i) {
      found = found || bits[i] != 0;
    }
    return found;
#endif
  }
  [[nodiscard]] STRAINWAVE_INLINE bool all() const { return !(!*this).any(); }
#endif
};

/// One number for each lane.
template <class RealT>
struct Lanes {
  using Real = RealT;
  using Mask = LaneMask<Real>;
  using Vector = LaneVectors<Real>::Reals;
  static constexpr std::size_t count = STRAINWAVE_LANE_BYTES / sizeof(Real);

  Vector v;

  Lanes() = default;
  STRAINWAVE_INLINE Lanes(Vector vector) : v(vector) {}         // NOLINT(*-explicit-*)
  STRAINWAVE_INLINE Lanes(Real value) : v(value - Vector{}) {}  // NOLINT(*-explicit-*)

  STRAINWAVE_INLINE static Lanes load(const Real* from) {
    Vector vector;
    __builtin_memcpy(&vector, from, sizeof(vector));
    return vector;
  }
  STRAINWAVE_INLINE void store(Real* to) const { __builtin_memcpy(to, &v, sizeof(v)); }

  STRAINWAVE_INLINE friend Lanes operator+(Lanes a, Lanes b) { return a.v + b.v; }
  STRAINWAVE_INLINE friend Lanes operator-(Lanes a, Lanes b) { return a.v - b.v; }
  STRAINWAVE_INLINE friend Lanes operator*(Lanes a, Lanes b) { return a.v * b.v; }
  STRAINWAVE_INLINE friend Lanes operator/(Lanes a, Lanes b) { return a.v / b.v; }

#if STRAINWAVE_LANE_LEVEL == 4
  template <int Predicate>
  STRAINWAVE_INLINE static Mask compared(Lanes a, Lanes b) {
    if constexpr (sizeof(Real) == 4) {
      return {_mm512_cmp_ps_mask(a.v, b.v, Predicate)};
    } else {
      return {_mm512_cmp_pd_mask(a.v, b.v, Predicate)};
    }
  }
  STRAINWAVE_INLINE friend Mask operator<(Lanes a, Lanes b) { return compared<_CMP_LT_OQ>(a, b); }
  STRAINWAVE_INLINE friend Mask operator<=(Lanes a, Lanes b) { return compared<_CMP_LE_OQ>(a, b); }
#else
  STRAINWAVE_INLINE friend Mask operator<(Lanes a, Lanes b) { return {a.v < b.v}; }
  STRAINWAVE_INLINE friend Mask operator<=(Lanes a, Lanes b) { return {a.v <= b.v}; }
#endif
  STRAINWAVE_INLINE friend Mask operator>(Lanes a, Lanes b) { return b < a; }
  STRAINWAVE_INLINE friend Mask operator>=(Lanes a, Lanes b) { return b <= a; }
};

/// a b + c, rounded once where the level can.
template <class Real>
STRAINWAVE_INLINE Lanes<Real> fused(Lanes<Real> a, Lanes<Real> b, Lanes<Real> c) {
#if STRAINWAVE_LANE_LEVEL == 4
  if constexpr (sizeof(Real) == 4) {
    return _mm512_fmadd_ps(a.v, b.v, c.v);
  } else {
    return _mm512_fmadd_pd(a.v, b.v, c.v);
  }
#elif STRAINWAVE_LANE_LEVEL == 3
  if constexpr (sizeof(Real) == 4) {
    return _mm256_fmadd_ps(a.v, b.v, c.v);
  } else {
    return _mm256_fmadd_pd(a.v, b.v, c.v);
  }
#elif defined(__aarch64__)
  if constexpr (sizeof(Real) == 4) {
    return vfmaq_f32(c.v, a.v, b.v);
  } else {
    return vfmaq_f64(c.v, a.v, b.v);
  }
#else
  return a * b + c;
#endif
}

/// c - a b, rounded once where the level can.
template <class Real>
STRAINWAVE_INLINE Lanes<Real> fused_minus(Lanes<Real> a, Lanes<Real> b, Lanes<Real> c) {
#if STRAINWAVE_LANE_LEVEL == 4
  if constexpr (sizeof(Real) == 4) {
    return _mm512_fnmadd_ps(a.v, b.v, c.v);
  } else {
    return _mm512_fnmadd_pd(a.v, b.v, c.v);
  }
#elif STRAINWAVE_LANE_LEVEL == 3
  if constexpr (sizeof(Real) == 4) {
    return _mm256_fnmadd_ps(a.v, b.v, c.v);
  } else {
    return _mm256_fnmadd_pd(a.v, b.v, c.v);
  }
#elif defined(__aarch64__)
  if constexpr (sizeof(Real) == 4) {
    return vfmsq_f32(c.v, a.v, b.v);
  } else {
    return vfmsq_f64(c.v, a.v, b.v);
  }
#else
  return c - a * b;
#endif
}

/// The first where the mask says yes, the second elsewhere.  What is not taken may be anything.
template <class Real>
STRAINWAVE_INLINE Lanes<Real> select(LaneMask<Real> mask, Lanes<Real> yes, Lanes<Real> no) {
#if STRAINWAVE_LANE_LEVEL == 4
  if constexpr (sizeof(Real) == 4) {
    return _mm512_mask_blend_ps(mask.bits, no.v, yes.v);
  } else {
    return _mm512_mask_blend_pd(mask.bits, no.v, yes.v);
  }
#else
  return mask.bits ? yes.v : no.v;
#endif
}

template <class Real>
STRAINWAVE_INLINE Lanes<Real> absolute(Lanes<Real> value) {
  using Vectors = LaneVectors<Real>;
  using Wholes = Vectors::Wholes;
  constexpr auto sign = std::numeric_limits<typename Vectors::Whole>::min();
  return __builtin_bit_cast(typename Vectors::Reals,
                            __builtin_bit_cast(Wholes, value.v) & (~sign - Wholes{}));
}

/// The larger of two numbers; the second where either is not a number.
template <class Real>
STRAINWAVE_INLINE Lanes<Real> larger(Lanes<Real> a, Lanes<Real> b) {
#if STRAINWAVE_LANE_LEVEL == 4
  if constexpr (sizeof(Real) == 4) {
    return _mm512_maskz_max_ps(LaneMask<Real>::every, a.v, b.v);
  } else {
    return _mm512_maskz_max_pd(LaneMask<Real>::every, a.v, b.v);
  }
#else
  return a.v > b.v ? a.v : b.v;
#endif
}

/// The smaller of two numbers; the second where either is not a number.
template <class Real>
STRAINWAVE_INLINE Lanes<Real> smaller(Lanes<Real> a, Lanes<Real> b) {
#if STRAINWAVE_LANE_LEVEL == 4
  if constexpr (sizeof(Real) == 4) {
    return _mm512_maskz_min_ps(LaneMask<Real>::every, a.v, b.v);
  } else {
    return _mm512_maskz_min_pd(LaneMask<Real>::every, a.v, b.v);
  }
#else
  return a.v < b.v ? a.v : b.v;
#endif
}

/// 1 / value to the last digit or two, where that is faster than a division.
template <class Real>
STRAINWAVE_INLINE Lanes<Real> reciprocal(Lanes<Real> value) {
  using L = Lanes<Real>;
#if STRAINWAVE_LANE_LEVEL == 4
  if constexpr (sizeof(Real) == 4) {
    const L near = _mm512_maskz_rcp14_ps(LaneMask<Real>::every, value.v);
    return fused(fused_minus(value, near, L(Real(1))), near, near);
  }
#endif
  return L(Real(1)) / value;
}

template <class Real>
STRAINWAVE_INLINE Lanes<Real> square_root(Lanes<Real> value) {
#if STRAINWAVE_LANE_LEVEL == 4
  if constexpr (sizeof(Real) == 4) {
    return _mm512_maskz_sqrt_ps(LaneMask<Real>::every, value.v);
  } else {
    return _mm512_maskz_sqrt_pd(LaneMask<Real>::every, value.v);
  }
#elif STRAINWAVE_LANE_LEVEL == 3
  if constexpr (sizeof(Real) == 4) {
    return _mm256_sqrt_ps(value.v);
  } else {
    return _mm256_sqrt_pd(value.v);
  }
#else
  for (std::size_t i = 0; i < Lanes<Real>::count; ++i) {
    value.v[i] = strainwave::square_root(static_cast<Real>(value.v[i]));
  }
  return value;
#endif
}

/// Cosine and sine of angles within an eighth of a turn either side of zero: the series of
/// arithmetic.hpp.
template <class Real>
STRAINWAVE_INLINE CosSin<Lanes<Real>> cos_sin_reduced(Lanes<Real> angle_rad) {
  using L = Lanes<Real>;
  const L square = angle_rad * angle_rad;
  L sine;
  L cosine;
  if constexpr (sizeof(Real) == 4) {
    sine = fused(square, L(Real(1) / Real(362880)), L(Real(-1) / Real(5040)));
    cosine = fused(square, L(Real(1) / Real(40320)), L(Real(-1) / Real(720)));
  } else {
    sine = fused(square, L(Real(1) / Real(355687428096000)), L(Real(-1) / Real(1307674368000)));
    sine = fused(square, sine, L(Real(1) / Real(6227020800)));
    sine = fused(square, sine, L(Real(-1) / Real(39916800)));
    sine = fused(square, sine, L(Real(1) / Real(362880)));
    sine = fused(square, sine, L(Real(-1) / Real(5040)));
    cosine = fused(square, L(Real(1) / Real(20922789888000)), L(Real(-1) / Real(87178291200)));
    cosine = fused(square, cosine, L(Real(1) / Real(479001600)));
    cosine = fused(square, cosine, L(Real(-1) / Real(3628800)));
    cosine = fused(square, cosine, L(Real(1) / Real(40320)));
    cosine = fused(square, cosine, L(Real(-1) / Real(720)));
  }
  sine = fused(square, sine, L(Real(1) / Real(120)));
  sine = fused(square, sine, L(Real(-1) / Real(6)));
  cosine = fused(square, cosine, L(Real(1) / Real(24)));
  cosine = fused_minus(square, cosine, L(Real(0.5)));
  return {fused_minus(square, cosine, L(Real(1))), fused(angle_rad * square, sine, angle_rad)};
}

/// Cosine and sine of angles within 0.03 rad: the same series, which end earlier here.
template <class Real>
STRAINWAVE_INLINE CosSin<Lanes<Real>> cos_sin_small(Lanes<Real> angle_rad) {
  using L = Lanes<Real>;
  const L square = angle_rad * angle_rad;
  const L third = angle_rad * square;
  if constexpr (sizeof(Real) == 4) {
    return {fused_minus(square, L(Real(0.5)), L(Real(1))),
            fused(third, L(Real(-1) / Real(6)), angle_rad)};
  } else {
    L sine = fused(square, L(Real(-1) / Real(5040)), L(Real(1) / Real(120)));
    L cosine = fused(square, L(Real(1) / Real(720)), L(Real(-1) / Real(24)));
    sine = fused(square, sine, L(Real(-1) / Real(6)));
    cosine = fused(square, cosine, L(Real(0.5)));
    return {fused_minus(square, cosine, L(Real(1))), fused(third, sine, angle_rad)};
  }
}

/// Cosine and sine of angles of up to largest_reducible_angle_rad; anything for larger ones.
template <class Real>
STRAINWAVE_INLINE CosSin<Lanes<Real>> cos_sin_of_radians(Lanes<Real> angle_rad) {
  using L = Lanes<Real>;
  using Wholes = LaneVectors<Real>::Wholes;
  // Rounding to a whole number of quarter turns by a number so large that its last digit is one.
  constexpr Real rounder = Real(1.5) / std::numeric_limits<Real>::epsilon();
  const L shifted = fused(angle_rad, L(Real(2) / pi<Real>), L(rounder));
  const L quarters = shifted - L(rounder);
  const auto whole = __builtin_bit_cast(Wholes, shifted.v);
  L rest = angle_rad;
  if constexpr (sizeof(Real) == 4) {
    rest = fused_minus(quarters, L(1.5703125F), rest);
    rest = fused_minus(quarters, L(0.0004825592041015625F), rest);
    rest = fused_minus(quarters, L(1.2665987014770508e-06F), rest);
    rest = fused_minus(quarters, L(9.920935796805404e-10F), rest);
  } else {
    rest = fused_minus(quarters, L(Real(1.57079632673412561417)), rest);
    rest = fused_minus(quarters, L(Real(6.07710050630396597660e-11)), rest);
    rest = fused_minus(quarters, L(Real(2.02226624879595063154e-21)), rest);
  }
  const CosSin<L> part = cos_sin_reduced(rest);
  const Wholes odd = -(whole & 1);
  constexpr int sign_shift = 8 * static_cast<int>(sizeof(Real)) - 2;
  const Wholes sine_sign = (whole & 2) << sign_shift;
  const Wholes cosine_sign = ((whole + 1) & 2) << sign_shift;
  const auto cosine_bits = __builtin_bit_cast(Wholes, part.cosine.v);
  const auto sine_bits = __builtin_bit_cast(Wholes, part.sine.v);
  const Wholes turned_cosine = ((cosine_bits & ~odd) | (sine_bits & odd)) ^ cosine_sign;
  const Wholes turned_sine = ((sine_bits & ~odd) | (cosine_bits & odd)) ^ sine_sign;
  using Vector = L::Vector;
  return {L(__builtin_bit_cast(Vector, turned_cosine)), L(__builtin_bit_cast(Vector, turned_sine))};
}

#undef STRAINWAVE_INLINE
