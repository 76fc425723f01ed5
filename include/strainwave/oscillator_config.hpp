// SPDX-License-Identifier: Apache-2.0
/// @file oscillator_config.hpp
/// What the published ripple filter is told: orders, variances, source of rotation, protection.
///
/// The presets are Taghirad & Belanger 1999 and nothing else; the defaults are a small tuning with
/// protection at rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "strainwave/gear.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

enum class RotationSource : std::uint8_t {
  speed,  ///< rotation from sample k to k+1 is speed[k] x sample period, as published
  angle,  ///< rotation from sample k-1 to k is the difference of the motor's phases
};

template <class Real, std::size_t MaxOrders>
struct OscillatorFilterConfig {
  static_assert(std::is_floating_point_v<Real>, "strainwave: Real must be float or double");
  static_assert(MaxOrders > 0, "strainwave: MaxOrders must be at least 1");

  std::size_t order_count = 1;
  Order orders[MaxOrders] = {{2, 1}};  ///< cycles per motor turn
  /// Variance each state of an order gains per sample: Q of eq. (11) is this times the identity in
  /// the order's block.  Equal for both states, because a rotation must not prefer a phase.
  Real process_noise_variance_Nm2[MaxOrders] = {Real(1e-5)};
  Real measurement_noise_variance_Nm2 = Real(1);  ///< R of eq. (11)
  Real initial_variance_Nm2 = Real(1);            ///< P(0) is this times the identity
  Real sample_period_s = Real(1e-3);  ///< T_s of eq. (10); used with RotationSource::speed
  RotationSource rotation_source = RotationSource::speed;
  /// Protection at rest: no update until the motor has travelled this far since the last one.
  /// Without it the covariance grows without bound at standstill, and the first motion afterwards
  /// throws the states.  0: off.
  Real minimum_travel_rad = Real(1e-3);
  /// Protection at rest where the reading of the motor is not still: no update below this speed,
  /// smoothed over 50 ms.  An encoder that dithers between two counts and the noise of a tachometer
  /// travel without moving.  0: off.
  Real minimum_speed_rad_s = Real(0.5);
  /// Protection at crawl: no variance above the initial one plus this many times the order's
  /// process noise.  0: off.
  Real variance_limit_ratio = Real(1e5);
};

/// Orders in use; never more than there is room for, even in a configuration that nobody checked.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr std::size_t active_orders(
    const OscillatorFilterConfig<Real, MaxOrders>& config) {
  return config.order_count < MaxOrders ? config.order_count : MaxOrders;
}

/// The same configuration in another precision or capacity; the capacity must hold its orders.
template <class Real, std::size_t MaxOrders, class FromReal, std::size_t FromMaxOrders>
[[nodiscard]] constexpr OscillatorFilterConfig<Real, MaxOrders> converted(
    const OscillatorFilterConfig<FromReal, FromMaxOrders>& from) {
  OscillatorFilterConfig<Real, MaxOrders> to;
  to.order_count = from.order_count;
  for (std::size_t a = 0; a < from.order_count && a < MaxOrders; ++a) {
    to.orders[a] = from.orders[a];
    to.process_noise_variance_Nm2[a] = static_cast<Real>(from.process_noise_variance_Nm2[a]);
  }
  to.measurement_noise_variance_Nm2 = static_cast<Real>(from.measurement_noise_variance_Nm2);
  to.initial_variance_Nm2 = static_cast<Real>(from.initial_variance_Nm2);
  to.sample_period_s = static_cast<Real>(from.sample_period_s);
  to.rotation_source = from.rotation_source;
  to.minimum_travel_rad = static_cast<Real>(from.minimum_travel_rad);
  to.minimum_speed_rad_s = static_cast<Real>(from.minimum_speed_rad_s);
  to.variance_limit_ratio = static_cast<Real>(from.variance_limit_ratio);
  return to;
}

/// A configuration for a list of orders, each with the default tuning:
/// `with_orders<float>({{2, 1}, {4, 1}})`.
template <class Real, std::size_t Count>
[[nodiscard]] constexpr OscillatorFilterConfig<Real, Count> with_orders(
    const Order (&orders)[Count]) {
  OscillatorFilterConfig<Real, Count> config;
  const Real process_noise_variance_Nm2 = config.process_noise_variance_Nm2[0];
  config.order_count = Count;
  for (std::size_t a = 0; a < Count; ++a) {
    config.orders[a] = orders[a];
    config.process_noise_variance_Nm2[a] = process_noise_variance_Nm2;
  }
  return config;
}

/// The filter of section V and nothing else: orders 2 and 4, Q = 1e3 I, R = 1, P(0) = 1e3 I,
/// x(0) = 0, T_s = 1 ms, rotation by speed[k] T_s, no protection.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorFilterConfig<Real, MaxOrders> taghirad1999_4() {
  static_assert(MaxOrders >= 2, "strainwave: taghirad1999-4 needs MaxOrders of at least 2");
  OscillatorFilterConfig<Real, MaxOrders> config;
  config.order_count = 2;
  config.orders[0] = {2, 1};
  config.orders[1] = {4, 1};
  config.process_noise_variance_Nm2[0] = Real(1e3);
  config.process_noise_variance_Nm2[1] = Real(1e3);
  config.initial_variance_Nm2 = Real(1e3);
  config.minimum_travel_rad = Real(0);
  config.minimum_speed_rad_s = Real(0);
  config.variance_limit_ratio = Real(0);
  return config;
}

/// The filter of section VI: that of section V and the misalignment at order 1/ratio.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorFilterConfig<Real, MaxOrders> taghirad1999(Rational ratio) {
  static_assert(MaxOrders >= 3, "strainwave: taghirad1999 needs MaxOrders of at least 3");
  OscillatorFilterConfig<Real, MaxOrders> config = taghirad1999_4<Real, MaxOrders>();
  config.order_count = 3;
  config.orders[2] = inverse(ratio);
  config.process_noise_variance_Nm2[2] = Real(1e3);
  return config;
}

namespace detail {

/// Variances beyond these would overflow or vanish in float, in either precision's configuration.
inline constexpr float smallest_variance_Nm2 = 1e-20F;
inline constexpr float largest_variance_Nm2 = 1e30F;
/// A turn of the motor at this order, and a sample's rotation, stay within what can be reduced.
inline constexpr std::int32_t largest_order = 1000;

template <class Real>
[[nodiscard]] constexpr bool is_usable_variance(Real variance_Nm2) {
  return variance_Nm2 >= Real(smallest_variance_Nm2) && variance_Nm2 <= Real(largest_variance_Nm2);
}

/// check() of the list of orders and of what belongs to each.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Violation<Real> check_orders(
    const OscillatorFilterConfig<Real, MaxOrders>& config) {
  if (config.order_count < 1 || config.order_count > MaxOrders) {
    return {"orders", -1, static_cast<Real>(config.order_count), "orders",
            "at least one, and no more than the compiled capacity"};
  }
  for (std::size_t a = 0; a < config.order_count; ++a) {
    const auto index = static_cast<std::int32_t>(a);
    if (!is_valid(config.orders[a])) {
      return {"orders", index, Real(0), "cycles per motor turn",
              "a ratio of whole numbers from 1 to 2^31 - 1"};
    }
    if (to_real<Real>(config.orders[a]) > Real(largest_order)) {
      return {"orders", index, to_real<Real>(config.orders[a]), "cycles per motor turn",
              "at most 1000"};
    }
    for (std::size_t b = 0; b < a; ++b) {
      if (std::uint64_t{config.orders[b].numerator} * config.orders[a].denominator ==
          std::uint64_t{config.orders[a].numerator} * config.orders[b].denominator) {
        return {"orders", index, to_real<Real>(config.orders[a]), "cycles per motor turn",
                "each order once"};
      }
    }
    const Real variance = config.process_noise_variance_Nm2[a];
    if (!(variance >= Real(0)) || variance > Real(largest_variance_Nm2)) {
      return {"process_noise_variance_Nm2", index, variance, "Nm^2", "a number from 0 to 1e30"};
    }
  }
  return {};
}

}  // namespace detail

template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Violation<Real> check(
    const OscillatorFilterConfig<Real, MaxOrders>& config) {
  if (const auto violation = detail::check_orders(config); !violation.ok()) {
    return violation;
  }
  if (!detail::is_usable_variance(config.measurement_noise_variance_Nm2)) {
    return {"measurement_noise_variance_Nm2", -1, config.measurement_noise_variance_Nm2, "Nm^2",
            "a number from 1e-20 to 1e30"};
  }
  if (!detail::is_usable_variance(config.initial_variance_Nm2)) {
    return {"initial_variance_Nm2", -1, config.initial_variance_Nm2, "Nm^2",
            "a number from 1e-20 to 1e30"};
  }
  if (!(config.sample_period_s >= Real(1e-9F)) || config.sample_period_s > Real(1e3F)) {
    return {"sample_period_s", -1, config.sample_period_s, "s", "a number from 1e-9 to 1000"};
  }
  if (!is_finite(config.minimum_travel_rad) || config.minimum_travel_rad < Real(0) ||
      config.minimum_travel_rad > Real(1)) {
    return {"minimum_travel_rad", -1, config.minimum_travel_rad, "rad", "0 (off) to 1"};
  }
  if (!is_finite(config.minimum_speed_rad_s) || config.minimum_speed_rad_s < Real(0) ||
      config.minimum_speed_rad_s > Real(100)) {
    return {"minimum_speed_rad_s", -1, config.minimum_speed_rad_s, "rad/s", "0 (off) to 100"};
  }
  if (!is_finite(config.variance_limit_ratio) ||
      (config.variance_limit_ratio < Real(100) && config.variance_limit_ratio != Real(0))) {
    return {"variance_limit_ratio", -1, config.variance_limit_ratio, "", "0 (off) or at least 100"};
  }
  return {};
}

}  // namespace strainwave
