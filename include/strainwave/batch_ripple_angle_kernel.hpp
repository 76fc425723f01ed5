// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple_angle_kernel.hpp
/// Angles on lanes: whole numbers of turns and cycles, and cosine and sine of their fractions.
///
/// Included by batch_ripple.hpp within the namespace of each vector level.
// No guard and no includes: see lanes_each_level.hpp.

// Without the sanitizers, as the published filter's kernel.
#define STRAINWAVE_INLINE \
  [[gnu::always_inline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline
#define STRAINWAVE_KERNEL \
  [[gnu::noinline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline

template <class Real>
using WholeLanes = LaneVectors<Real>::Wholes;

template <class Real>
STRAINWAVE_INLINE WholeLanes<Real> load_whole(const typename LaneVectors<Real>::Whole* from) {
  WholeLanes<Real> whole;
  __builtin_memcpy(&whole, from, sizeof(whole));
  return whole;
}
template <class Real>
STRAINWAVE_INLINE WholeLanes<Real> load_whole(const Real* bits) {
  WholeLanes<Real> whole;
  __builtin_memcpy(&whole, bits, sizeof(whole));
  return whole;
}
template <class Real>
STRAINWAVE_INLINE void store_whole(WholeLanes<Real> whole, typename LaneVectors<Real>::Whole* to) {
  __builtin_memcpy(to, &whole, sizeof(whole));
}

/// The lower 32 bits with their sign: a fraction of a turn wraps there.
template <class Real>
STRAINWAVE_INLINE WholeLanes<Real> wrapped(WholeLanes<Real> whole) {
  if constexpr (sizeof(Real) == 4) {
    return whole;
  } else {
    return (whole << 32) >> 32;
  }
}

template <class Real>
STRAINWAVE_INLINE Lanes<Real> to_lanes(WholeLanes<Real> whole) {
  return Lanes<Real>(__builtin_convertvector(whole, typename LaneVectors<Real>::Reals));
}

// NOLINTBEGIN(cppcoreguidelines-pro-type-reinterpret-cast): bits of vectors, as of lanes_level.hpp.

/// Cosine and sine of fractions of a turn, either side of zero, in units of 2^-32.
template <class Real>
STRAINWAVE_INLINE CosSin<Lanes<Real>> cos_sin_of_fraction(WholeLanes<Real> fraction) {
  using L = Lanes<Real>;
  using Wholes = WholeLanes<Real>;
  const WholeLanes<Real> eighth = WholeLanes<Real>{} + (1 << 29);
  const Wholes quarters = wrapped<Real>(fraction + eighth) >> 30;
  const Wholes rest = wrapped<Real>(fraction - (quarters << 30));
  const CosSin<L> part =
      cos_sin_reduced(to_lanes<Real>(rest) * L(two_pi<Real> / Real(4294967296.0)));
  const Wholes odd = -(quarters & 1);
  constexpr int sign_shift = 8 * static_cast<int>(sizeof(Real)) - 2;
  const Wholes sine_sign = (quarters & 2) << sign_shift;
  const Wholes cosine_sign = ((quarters + 1) & 2) << sign_shift;
  const auto cosine_bits = reinterpret_cast<Wholes>(part.cosine.v);
  const auto sine_bits = reinterpret_cast<Wholes>(part.sine.v);
  const Wholes turned_cosine = ((cosine_bits & ~odd) | (sine_bits & odd)) ^ cosine_sign;
  const Wholes turned_sine = ((sine_bits & ~odd) | (cosine_bits & odd)) ^ sine_sign;
  using Vector = L::Vector;
  return {L(reinterpret_cast<Vector>(turned_cosine)), L(reinterpret_cast<Vector>(turned_sine))};
}

/// The quotient by a whole turn; by two products where they are rounded once, which is faster.
STRAINWAVE_INLINE Lanes<double> turns_of(Lanes<double> angle_rad) {
#if STRAINWAVE_LANE_LEVEL >= 3
  const Lanes<double> per_turn = 1.0 / two_pi<double>;
  const Lanes<double> turns = angle_rad * per_turn;
  return fused(fused_minus(turns, Lanes<double>(two_pi<double>), angle_rad), per_turn, turns);
#else
  return angle_rad / Lanes<double>(two_pi<double>);
#endif
}

/// What a conversion stores: the whole numbers whose last digits are those of `digits`, which are
/// numbers so large that their last digit is one.
template <class Real>
STRAINWAVE_INLINE void store_digits(Lanes<double> digits, std::size_t count, Real* to) {
  using Wide = Lanes<double>;
  using Narrow [[gnu::vector_size(Wide::count * sizeof(Real))]] = LaneVectors<Real>::Whole;
  using Low [[gnu::vector_size(Wide::count * sizeof(std::int32_t))]] = std::int32_t;
  const auto low =
      __builtin_convertvector(reinterpret_cast<LaneVectors<double>::Wholes>(digits.v), Low);
  const Narrow narrow = __builtin_convertvector(low, Narrow);
  if (count == Wide::count) {
    __builtin_memcpy(to, &narrow, sizeof(narrow));
  } else {
    __builtin_memcpy(to, &narrow, count * sizeof(Real));
  }
}

/// Angles of one channel as nearest turns and fraction, turns that no lane takes where they are out
/// of reach; and order_fraction() of orders that pass has_short_parts(), exactly: every number is
/// one that double holds, and the quotient's error is too small to reach a whole one.
template <class Real>
STRAINWAVE_KERNEL void convert_angles(const double* angle_rad, std::size_t count, Real* turns,
                                      Real* fraction, const OrderCycles<Real>* orders,
                                      std::size_t order_count) {
  using Wide = Lanes<double>;
  // Rounding to a whole number by one so large that its last digit is one; the digits are its bits.
  const Wide rounder = 6755399441055744.0;
  const Wide units_per_turn = 4294967296.0;
  double rest[Wide::count];
  for (std::size_t k = 0; k < count; k += Wide::count) {
    const std::size_t left = count - k < Wide::count ? count - k : Wide::count;
    const double* from = angle_rad + k;
    if (left < Wide::count) {
      for (std::size_t i = 0; i < Wide::count; ++i) {
        rest[i] = i < left ? from[i] : 0.0;
      }
      from = rest;
    }
    const Wide in_turns = turns_of(Wide::load(from));
    const Wide turns_digits = in_turns + rounder;
    const Wide whole = turns_digits - rounder;
    const Wide units_digits = fused(in_turns - whole, units_per_turn, rounder);
    const auto reachable = absolute(in_turns) < Wide(static_cast<double>(detail::most_lane_turns));
    store_digits(select(reachable, turns_digits, rounder - Wide(2147483648.0)), left, turns + k);
    store_digits(units_digits, left, fraction + k);
    for (std::size_t i = 0; i < order_count; ++i) {
      const Wide denominator = orders[i].denominator;
      const Wide per_denominator = orders[i].per_denominator;
      // Whole multiples of the denominator are whole cycles, however many of them are taken off.
      const Wide multiple = fused(whole, per_denominator, rounder) - rounder;
      const Wide angle =
          fused(fused_minus(multiple, denominator, whole), units_per_turn, units_digits - rounder);
      // Half a unit more, so that no quotient is near a whole number; half a cycle less to round.
      const Wide units = fused(angle, Wide(orders[i].numerator), Wide(0.5));
      store_digits(fused(units, per_denominator, Wide(-0.5)) + rounder, left,
                   orders[i].fraction + k);
    }
  }
}

// NOLINTEND(cppcoreguidelines-pro-type-reinterpret-cast)

#undef STRAINWAVE_KERNEL
#undef STRAINWAVE_INLINE
