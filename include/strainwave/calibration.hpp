// SPDX-License-Identifier: Apache-2.0
/// @file calibration.hpp
/// From volts to torque: gain, zero, linearisation polynomial, temperature.
///
/// A pure function of volts and temperature; finding its numbers is the work of
/// strainwave.calibrate.  The gain is the quantity of Taghirad & Belanger 1999, Table I
/// (6.60 Nm/V).
#pragma once

#include <cstddef>
#include <type_traits>

#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// Highest power of the linearisation polynomial.
inline constexpr std::size_t highest_linearisation_power = 5;

template <class Real>
struct TorqueCalibration {
  static_assert(std::is_floating_point_v<Real>, "strainwave: Real must be float or double");

  Real gain_Nm_per_V = Real(1);
  Real zero_V = Real(0);
  Real full_scale_Nm = Real(40);
  /// c_2, c_3, ..., dimensionless: torque = u + FS sum_n c_n (u/FS)^n with u = gain (volts - zero).
  Real linearisation[highest_linearisation_power - 1] = {};
  Real reference_temperature_degC = Real(20);
  Real zero_drift_V_per_K = Real(0);
  Real gain_drift_per_K = Real(0);  ///< relative change of the gain, 1/K
  Real minimum_temperature_degC = Real(-40);
  Real maximum_temperature_degC = Real(120);
};

/// Torque in Nm of a sum of gauge volts at a temperature.
template <class Real>
[[nodiscard]] constexpr Real torque_of_volts_Nm(const TorqueCalibration<Real>& calibration,
                                                Real volts, Real temperature_degC) {
  const Real warmer_K = temperature_degC - calibration.reference_temperature_degC;
  const Real zero_V = calibration.zero_V + calibration.zero_drift_V_per_K * warmer_K;
  const Real gain = calibration.gain_Nm_per_V * (Real(1) + calibration.gain_drift_per_K * warmer_K);
  const Real linear_Nm = gain * (volts - zero_V);
  std::size_t terms = highest_linearisation_power - 1;
  while (terms > 0 && calibration.linearisation[terms - 1] == Real(0)) {
    --terms;
  }
  if (terms == 0) {
    return linear_Nm;
  }
  const Real relative = linear_Nm / calibration.full_scale_Nm;
  Real correction = calibration.linearisation[terms - 1];
  for (std::size_t n = terms - 1; n-- > 0;) {
    correction = calibration.linearisation[n] + correction * relative;
  }
  return linear_Nm + linear_Nm * relative * correction;
}

/// The same calibration in another precision.
template <class Real, class FromReal>
[[nodiscard]] constexpr TorqueCalibration<Real> converted(const TorqueCalibration<FromReal>& from) {
  TorqueCalibration<Real> to;
  to.gain_Nm_per_V = static_cast<Real>(from.gain_Nm_per_V);
  to.zero_V = static_cast<Real>(from.zero_V);
  to.full_scale_Nm = static_cast<Real>(from.full_scale_Nm);
  for (std::size_t n = 0; n + 1 < highest_linearisation_power; ++n) {
    to.linearisation[n] = static_cast<Real>(from.linearisation[n]);
  }
  to.reference_temperature_degC = static_cast<Real>(from.reference_temperature_degC);
  to.zero_drift_V_per_K = static_cast<Real>(from.zero_drift_V_per_K);
  to.gain_drift_per_K = static_cast<Real>(from.gain_drift_per_K);
  to.minimum_temperature_degC = static_cast<Real>(from.minimum_temperature_degC);
  to.maximum_temperature_degC = static_cast<Real>(from.maximum_temperature_degC);
  return to;
}

/// True from absolute zero to 1000 degC.
template <class Real>
[[nodiscard]] constexpr bool is_temperature(Real temperature_degC) {
  return temperature_degC >= Real(-273.15F) && temperature_degC <= Real(1000);
}

template <class Real>
[[nodiscard]] constexpr Violation<Real> check(const TorqueCalibration<Real>& calibration) {
  if (!is_finite(calibration.gain_Nm_per_V) || !(absolute(calibration.gain_Nm_per_V) > Real(0))) {
    return {"gain_Nm_per_V", -1, calibration.gain_Nm_per_V, "Nm/V", "a finite number other than 0"};
  }
  if (!is_finite(calibration.zero_V)) {
    return {"zero_V", -1, calibration.zero_V, "V", "a finite number"};
  }
  if (!is_finite(calibration.full_scale_Nm) || calibration.full_scale_Nm <= Real(0)) {
    return {"full_scale_Nm", -1, calibration.full_scale_Nm, "Nm", "a finite number above 0"};
  }
  for (std::size_t n = 0; n + 1 < highest_linearisation_power; ++n) {
    if (!is_finite(calibration.linearisation[n]) ||
        absolute(calibration.linearisation[n]) > Real(1)) {
      return {"linearisation", static_cast<std::int32_t>(n), calibration.linearisation[n], "",
              "a finite number within +-1"};
    }
  }
  if (!is_temperature(calibration.reference_temperature_degC)) {
    return {"reference_temperature_degC", -1, calibration.reference_temperature_degC, "degC",
            "a temperature from -273.15 to 1000"};
  }
  if (!is_temperature(calibration.minimum_temperature_degC)) {
    return {"minimum_temperature_degC", -1, calibration.minimum_temperature_degC, "degC",
            "a temperature from -273.15 to 1000"};
  }
  if (!is_temperature(calibration.maximum_temperature_degC) ||
      calibration.maximum_temperature_degC <= calibration.minimum_temperature_degC) {
    return {"maximum_temperature_degC", -1, calibration.maximum_temperature_degC, "degC",
            "a temperature above minimum_temperature_degC and at most 1000"};
  }
  if (!is_finite(calibration.zero_drift_V_per_K)) {
    return {"zero_drift_V_per_K", -1, calibration.zero_drift_V_per_K, "V/K", "a finite number"};
  }
  const Real drift = calibration.gain_drift_per_K;
  const Real reference = calibration.reference_temperature_degC;
  if (!is_finite(drift) ||
      !(Real(1) + drift * (calibration.minimum_temperature_degC - reference) > Real(0)) ||
      !(Real(1) + drift * (calibration.maximum_temperature_degC - reference) > Real(0))) {
    return {"gain_drift_per_K", -1, drift, "1/K",
            "a drift that leaves the gain its sign from minimum to maximum temperature"};
  }
  return {};
}

}  // namespace strainwave
