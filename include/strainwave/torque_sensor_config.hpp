// SPDX-License-Identifier: Apache-2.0
/// @file torque_sensor_config.hpp
/// What the chain of torque_sensor.hpp is told: its parts' configurations, with one of the filters.
#pragma once

#include <cstddef>

#include "strainwave/bridge.hpp"
#include "strainwave/calibration.hpp"
#include "strainwave/gains.hpp"
#include "strainwave/gauge_monitor_config.hpp"
#include "strainwave/oscillator_config.hpp"
#include "strainwave/ripple_config.hpp"
#include "strainwave/status.hpp"

namespace strainwave {

/// Configuration of the chain with one of the filters; what follows are its two forms.
template <class Real, std::size_t MaxGauges, class FilterConfig>
struct TorqueChainConfig {
  static_assert(sizeof(FilterConfig) == 0,
                "strainwave: FilterConfig must be RippleFilterConfig or OscillatorFilterConfig, "
                "with the same Real as the chain");
};

template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
struct TorqueChainConfig<Real, MaxGauges, RippleFilterConfig<Real, MaxPairs>> {
  Converter<Real> converter = {};
  Gains<Real, MaxGauges> gains = {};  ///< one gain per channel; a full bridge is one channel
  TorqueCalibration<Real> calibration = {};
  RippleFilterConfig<Real, MaxPairs> filter = {};
  /// Time from one sample number to the next, for samples that come without their interval.
  Real sample_period_s = Real(1e-3);
  GaugeMonitorConfig<Real, MaxGauges> monitor = {};
};

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
struct TorqueChainConfig<Real, MaxGauges, OscillatorFilterConfig<Real, MaxOrders>> {
  Converter<Real> converter = {};
  Gains<Real, MaxGauges> gains = {};  ///< one gain per channel; a full bridge is one channel
  TorqueCalibration<Real> calibration = {};
  OscillatorFilterConfig<Real, MaxOrders> filter = {};  ///< the sample period is in here
  GaugeMonitorConfig<Real, MaxGauges> monitor = {};
};

/// Codes to torque with the ripple filter.  MaxPairs: room for its pairs of coefficients.
template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
using RippleSensorConfig = TorqueChainConfig<Real, MaxGauges, RippleFilterConfig<Real, MaxPairs>>;

/// Codes to torque with the published filter.
template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
using TorqueSensorConfig =
    TorqueChainConfig<Real, MaxGauges, OscillatorFilterConfig<Real, MaxOrders>>;

/// The same configuration in another precision or capacity; the capacities must hold it.
template <class Real, std::size_t MaxGauges, std::size_t MaxPairs, class FromReal,
          std::size_t FromMaxGauges, std::size_t FromMaxPairs>
[[nodiscard]] constexpr RippleSensorConfig<Real, MaxGauges, MaxPairs> converted(
    const RippleSensorConfig<FromReal, FromMaxGauges, FromMaxPairs>& from) {
  return {converted<Real>(from.converter),         converted<Real, MaxGauges>(from.gains),
          converted<Real>(from.calibration),       converted<Real, MaxPairs>(from.filter),
          static_cast<Real>(from.sample_period_s), converted<Real, MaxGauges>(from.monitor)};
}

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders, class FromReal,
          std::size_t FromMaxGauges, std::size_t FromMaxOrders>
[[nodiscard]] constexpr TorqueSensorConfig<Real, MaxGauges, MaxOrders> converted(
    const TorqueSensorConfig<FromReal, FromMaxGauges, FromMaxOrders>& from) {
  return {converted<Real>(from.converter), converted<Real, MaxGauges>(from.gains),
          converted<Real>(from.calibration), converted<Real, MaxOrders>(from.filter),
          converted<Real, MaxGauges>(from.monitor)};
}

namespace detail {

template <class Real, std::size_t MaxGauges, class FilterConfig>
[[nodiscard]] constexpr Violation<Real> check_parts(
    const TorqueChainConfig<Real, MaxGauges, FilterConfig>& config) {
  if (const auto violation = check(config.converter); !violation.ok()) {
    return violation;
  }
  if (const auto violation = check(config.gains); !violation.ok()) {
    return violation;
  }
  if (const auto violation = check(config.calibration); !violation.ok()) {
    return violation;
  }
  if (const auto violation = check(config.monitor, active_gauges(config.gains)); !violation.ok()) {
    return violation;
  }
  return check(config.filter);
}

}  // namespace detail

template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
[[nodiscard]] constexpr Violation<Real> check(
    const RippleSensorConfig<Real, MaxGauges, MaxPairs>& config) {
  // Within the same limits as the oscillator filter's.
  if (!(config.sample_period_s >= Real(1e-9F)) || config.sample_period_s > Real(1e3F)) {
    return {"sample_period_s", -1, config.sample_period_s, "s", "a number from 1e-9 to 1000"};
  }
  return detail::check_parts(config);
}

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
[[nodiscard]] constexpr Violation<Real> check(
    const TorqueSensorConfig<Real, MaxGauges, MaxOrders>& config) {
  return detail::check_parts(config);
}

}  // namespace strainwave
