// SPDX-License-Identifier: Apache-2.0
/// @file ripple_config.hpp
/// What the ripple filter is told: orders and what their amplitudes depend on, memory, noise,
/// delay.
///
/// Each order's ripple is a cosine and a sine of order x motor angle, each with a coefficient.
/// Where it is known to grow with load or speed, or to differ with direction, further pairs of
/// coefficients say how much; a pair is used only on evidence, because each one can take a little
/// true torque.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "strainwave/angle_history.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// One order of the ripple.
struct RippleOrder {
  Order order = {2, 1};         ///< cycles per motor turn, the gear's factor m included
  bool with_load = false;       ///< a pair times L / (1 + |L|), L: low-passed torque over rated
  bool with_speed = false;      ///< a pair times |motor speed| over the reference speed
  bool with_direction = false;  ///< a pair times the direction of motion
  /// True: learned like the others but left in the torque, because this order is real torque.
  bool keep = false;

  [[nodiscard]] constexpr bool operator==(const RippleOrder&) const = default;
};

/// One term that is known from a commissioning run and applied as it is, never learned: for example
/// misalignment, cycles per output turn.  cosine x cos(order x angle) + sine x sin(order x angle).
template <class Real>
struct FrozenTerm {
  Order order = {1, 100};  ///< cycles per motor turn; n cycles per output turn are n / ratio
  Real cosine_Nm = Real(0);
  Real sine_Nm = Real(0);
};

/// Frozen terms that a configuration has room for.
inline constexpr std::size_t largest_frozen_terms = 8;

/// MaxPairs: room for pairs of coefficients, over all orders.
template <class Real, std::size_t MaxPairs>
struct RippleFilterConfig {
  static_assert(std::is_floating_point_v<Real>, "strainwave: Real must be float or double");
  static_assert(MaxPairs > 0, "strainwave: MaxPairs must be at least 1");

  std::size_t order_count = 1;
  RippleOrder orders[MaxPairs] = {};
  /// Memory in motor turns, the one parameter to choose: ripple that changes within fewer turns is
  /// not followed, torque that repeats over more turns is taken for ripple.  The same at every
  /// speed.
  Real memory_turns = Real(10);
  Real torque_noise_Nm = Real(0.04);  ///< standard deviation of a sample's noise: sqrt(R)
  /// How fast true torque wanders: its standard deviation after one second, sqrt(q_T).
  Real torque_walk_Nm_per_sqrt_s = Real(1.3);
  Real initial_amplitude_Nm = Real(2);  ///< standard deviation of each coefficient before learning
  Real rated_torque_Nm = Real(40);      ///< scales the load
  Real reference_speed_rad_s = Real(150);  ///< scales the speed
  /// Time by which the torque lags the angle; negative where the angle lags.
  Real angle_to_torque_delay_s = Real(0);
  /// Motor speed, smoothed over 50 ms, below which nothing is learned about the ripple.
  Real minimum_speed_rad_s = Real(2);
  std::size_t frozen_count = 0;
  FrozenTerm<Real> frozen[largest_frozen_terms] = {};
};

[[nodiscard]] constexpr std::size_t pairs_of(const RippleOrder& order) {
  return 1U + (order.with_load ? 1U : 0U) + (order.with_speed ? 1U : 0U) +
         (order.with_direction ? 1U : 0U);
}

/// Pairs besides an order's first one.
[[nodiscard]] constexpr std::size_t further_pairs_of(const RippleOrder& order) {
  return pairs_of(order) - 1;
}

/// Pairs of coefficients in use.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr std::size_t pair_count(const RippleFilterConfig<Real, MaxPairs>& config) {
  std::size_t count = 0;
  for (std::size_t a = 0; a < config.order_count && a < MaxPairs; ++a) {
    count += pairs_of(config.orders[a]);
  }
  return count;
}

/// The same configuration in another precision or capacity; the capacity must hold its pairs.
template <class Real, std::size_t MaxPairs, class FromReal, std::size_t FromMaxPairs>
[[nodiscard]] constexpr RippleFilterConfig<Real, MaxPairs> converted(
    const RippleFilterConfig<FromReal, FromMaxPairs>& from) {
  RippleFilterConfig<Real, MaxPairs> to;
  to.order_count = from.order_count;
  for (std::size_t a = 0; a < from.order_count && a < MaxPairs && a < FromMaxPairs; ++a) {
    to.orders[a] = from.orders[a];
  }
  to.memory_turns = static_cast<Real>(from.memory_turns);
  to.torque_noise_Nm = static_cast<Real>(from.torque_noise_Nm);
  to.torque_walk_Nm_per_sqrt_s = static_cast<Real>(from.torque_walk_Nm_per_sqrt_s);
  to.initial_amplitude_Nm = static_cast<Real>(from.initial_amplitude_Nm);
  to.rated_torque_Nm = static_cast<Real>(from.rated_torque_Nm);
  to.reference_speed_rad_s = static_cast<Real>(from.reference_speed_rad_s);
  to.angle_to_torque_delay_s = static_cast<Real>(from.angle_to_torque_delay_s);
  to.minimum_speed_rad_s = static_cast<Real>(from.minimum_speed_rad_s);
  to.frozen_count = from.frozen_count;
  for (std::size_t f = 0; f < from.frozen_count && f < largest_frozen_terms; ++f) {
    to.frozen[f] = {from.frozen[f].order, static_cast<Real>(from.frozen[f].cosine_Nm),
                    static_cast<Real>(from.frozen[f].sine_Nm)};
  }
  return to;
}

namespace detail {

/// A turn of the motor at this order stays within what is sensible to sample.
inline constexpr std::int32_t largest_ripple_order = 1000;
/// Range of torques and noise a configuration may hold, Nm: their squares stay within float.
inline constexpr double smallest_configured_torque_Nm = 1e-9;
inline constexpr double largest_configured_torque_Nm = 1e9;

template <class Real>
[[nodiscard]] constexpr bool is_within(Real value, double smallest, double largest) {
  return value >= static_cast<Real>(smallest) && value <= static_cast<Real>(largest);
}

template <class Real>
[[nodiscard]] constexpr bool is_usable_torque_setting(Real torque_Nm) {
  return is_within(torque_Nm, smallest_configured_torque_Nm, largest_configured_torque_Nm);
}

[[nodiscard]] constexpr bool is_same_order(Order a, Order b) {
  return std::uint64_t{a.numerator} * b.denominator == std::uint64_t{b.numerator} * a.denominator;
}

template <class Real>
[[nodiscard]] constexpr Violation<Real> check_order(const char* parameter, std::int32_t index,
                                                    Order order) {
  if (!is_valid(order)) {
    return {parameter, index, Real(0), "cycles per motor turn",
            "a ratio of whole numbers from 1 to 2^31 - 1"};
  }
  if (to_real<Real>(order) > static_cast<Real>(largest_ripple_order)) {
    return {parameter, index, to_real<Real>(order), "cycles per motor turn", "at most 1000"};
  }
  return {};
}

template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Violation<Real> check_lists(
    const RippleFilterConfig<Real, MaxPairs>& config) {
  if (config.order_count < 1 || config.order_count > MaxPairs || pair_count(config) > MaxPairs) {
    return {"orders", -1, static_cast<Real>(pair_count(config)), "pairs of coefficients",
            "at least one order, and no more pairs than the compiled capacity"};
  }
  for (std::size_t a = 0; a < config.order_count; ++a) {
    const auto index = static_cast<std::int32_t>(a);
    if (const auto wrong = check_order<Real>("orders", index, config.orders[a].order);
        !wrong.ok()) {
      return wrong;
    }
    for (std::size_t b = 0; b < a; ++b) {
      if (is_same_order(config.orders[a].order, config.orders[b].order)) {
        return {"orders", index, to_real<Real>(config.orders[a].order), "cycles per motor turn",
                "each order once"};
      }
    }
  }
  if (config.frozen_count > largest_frozen_terms) {
    return {"frozen", -1, static_cast<Real>(config.frozen_count), "terms", "at most 8"};
  }
  for (std::size_t f = 0; f < config.frozen_count; ++f) {
    const auto index = static_cast<std::int32_t>(f);
    const FrozenTerm<Real>& term = config.frozen[f];
    if (const auto wrong = check_order<Real>("frozen.order", index, term.order); !wrong.ok()) {
      return wrong;
    }
    const bool usable =
        is_within(term.cosine_Nm, -largest_configured_torque_Nm, largest_configured_torque_Nm) &&
        is_within(term.sine_Nm, -largest_configured_torque_Nm, largest_configured_torque_Nm);
    if (!usable) {
      return {"frozen", index, term.cosine_Nm, "Nm", "cosine and sine from -1e9 to 1e9"};
    }
  }
  return {};
}

}  // namespace detail

template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Violation<Real> check(const RippleFilterConfig<Real, MaxPairs>& config) {
  if (const auto violation = detail::check_lists(config); !violation.ok()) {
    return violation;
  }
  if (!detail::is_within(config.memory_turns, 0.1, 1e6)) {
    return {"memory_turns", -1, config.memory_turns, "motor turns", "a number from 0.1 to 1e6"};
  }
  if (!detail::is_usable_torque_setting(config.torque_noise_Nm)) {
    return {"torque_noise_Nm", -1, config.torque_noise_Nm, "Nm", "a number from 1e-9 to 1e9"};
  }
  if (!detail::is_usable_torque_setting(config.torque_walk_Nm_per_sqrt_s)) {
    return {"torque_walk_Nm_per_sqrt_s", -1, config.torque_walk_Nm_per_sqrt_s, "Nm/sqrt(s)",
            "a number from 1e-9 to 1e9"};
  }
  if (!detail::is_usable_torque_setting(config.initial_amplitude_Nm)) {
    return {"initial_amplitude_Nm", -1, config.initial_amplitude_Nm, "Nm",
            "a number from 1e-9 to 1e9"};
  }
  if (!detail::is_usable_torque_setting(config.rated_torque_Nm)) {
    return {"rated_torque_Nm", -1, config.rated_torque_Nm, "Nm", "a number from 1e-9 to 1e9"};
  }
  if (!detail::is_within(config.reference_speed_rad_s, 1e-3, 1e6)) {
    return {"reference_speed_rad_s", -1, config.reference_speed_rad_s, "rad/s",
            "a number from 0.001 to 1e6"};
  }
  if (!detail::is_within(config.angle_to_torque_delay_s, -longest_lead_s, longest_delay_s)) {
    return {"angle_to_torque_delay_s", -1, config.angle_to_torque_delay_s, "s",
            "a number from -0.005 to 0.05"};
  }
  if (!detail::is_within(config.minimum_speed_rad_s, 0.0, 100.0)) {
    return {"minimum_speed_rad_s", -1, config.minimum_speed_rad_s, "rad/s",
            "a number from 0 to 100"};
  }
  return {};
}

}  // namespace strainwave
