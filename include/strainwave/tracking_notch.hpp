// SPDX-License-Identifier: Apache-2.0
/// @file tracking_notch.hpp
/// Notches that follow the motor: the usual remedy for ripple, offered for comparison.
///
/// One second-order notch an order, in series.  Each is (1 + A) / 2 of an all-pass A in normalised
/// lattice form, which has one parameter for the centre and another for the bandwidth (Regalia and
/// Mitra 1987; Gray and Markel 1975).  At constant speed this is the bilinear notch, with
///
///     H = 1 / (1 + j beta sin w / (cos w - cos w0)),  beta = tan(pi x bandwidth x sample period),
///
/// whose -3 dB points lie exactly one bandwidth apart, and whose group delay is
/// beta (1 - cos w cos w0) / ((cos w - cos w0)^2 + beta^2 sin^2 w) samples.
///
/// Why this form: one step of the lattice is an orthogonal map of input and state, whatever its
/// parameters are in that step.  No energy is made when they change, so that the output has at most
/// the energy of the input however fast the speed does; direct forms, and other lattices, have no
/// such bound.  And the centre's parameter is a rotation of the state by order x motor rotation: it
/// is turned by differences of exact phases, keeps its phase through reversals, and needs no speed.
///
/// A notch near 0 Hz takes true torque for ripple.  Its bandwidth is therefore faded out: whole
/// from a centre of twice the bandwidth upwards, zero (the torque passes bit-exact and nothing is
/// learned) up to once the bandwidth, and the same mirrored at the Nyquist frequency.  The fade
/// acts on what is removed and on what is learned alike, and the state is kept and turned
/// meanwhile, so that the torque has no step at either end.  Orders such as 1/ratio are never
/// reached by a notch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "strainwave/oscillator_filter.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

template <class Real, std::size_t MaxOrders>
struct TrackingNotchConfig {
  static_assert(std::is_floating_point_v<Real>, "strainwave: Real must be float or double");
  static_assert(MaxOrders > 0, "strainwave: MaxOrders must be at least 1");

  std::size_t order_count = 1;
  Order orders[MaxOrders] = {{2, 1}};  ///< cycles per motor turn
  Real bandwidth_Hz = Real(1);         ///< between the two -3 dB points
  Real sample_period_s = Real(1e-3);
};

/// Orders in use; never more than there is room for, even in a configuration that nobody checked.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr std::size_t active_orders(
    const TrackingNotchConfig<Real, MaxOrders>& config) {
  return config.order_count < MaxOrders ? config.order_count : MaxOrders;
}

/// The same configuration in another precision or capacity; the capacity must hold its orders.
template <class Real, std::size_t MaxOrders, class FromReal, std::size_t FromMaxOrders>
[[nodiscard]] constexpr TrackingNotchConfig<Real, MaxOrders> converted(
    const TrackingNotchConfig<FromReal, FromMaxOrders>& from) {
  TrackingNotchConfig<Real, MaxOrders> to;
  to.order_count = from.order_count;
  for (std::size_t a = 0; a < from.order_count && a < MaxOrders; ++a) {
    to.orders[a] = from.orders[a];
  }
  to.bandwidth_Hz = static_cast<Real>(from.bandwidth_Hz);
  to.sample_period_s = static_cast<Real>(from.sample_period_s);
  return to;
}

template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Violation<Real> check(const TrackingNotchConfig<Real, MaxOrders>& config) {
  // Orders obey the oscillator filter's rules, by its own check.
  OscillatorFilterConfig<Real, MaxOrders> same_orders;
  same_orders.order_count = config.order_count;
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    same_orders.orders[a] = config.orders[a];
  }
  if (const auto violation = detail::check_orders(same_orders); !violation.ok()) {
    return violation;
  }
  if (!(config.sample_period_s >= Real(1e-9F)) || config.sample_period_s > Real(1e3F)) {
    return {"sample_period_s", -1, config.sample_period_s, "s", "a number from 1e-9 to 1000"};
  }
  // Below, float cannot tell the notch from no notch; above, both fades would meet.
  const Real cycles_per_sample = config.bandwidth_Hz * config.sample_period_s;
  if (!(cycles_per_sample >= Real(1e-6F)) || cycles_per_sample > Real(0.125F)) {
    return {"bandwidth_Hz", -1, config.bandwidth_Hz, "Hz",
            "from a millionth to an eighth of the sample rate"};
  }
  return {};
}

template <class Real, std::size_t MaxOrders>
struct TrackingNotchState {
  /// An order's pair: the oscillator that turns with the motor.
  Real first_Nm[MaxOrders] = {};
  Real second_Nm[MaxOrders] = {};
  Phase phase = {};      ///< motor phase of the pairs: of the last sample, or carried on
  Phase last_turn = {};  ///< from the last sample but one to the last, where both were known
  bool phase_known = false;
  bool phase_carried = false;            ///< the last sample had no phase
  Real smoothed_rotation_rad = Real(0);  ///< per sample; decides on the fade alone
  bool smoothed_rotation_known = false;
  Real last_torque_Nm = Real(0);
  Real last_ripple_Nm = Real(0);
  EventCounters counters = {};
};

template <class Real>
struct TrackingNotchSample {
  Real measured_torque_Nm = Real(0);
  Phase motor_phase = {};
  bool torque_valid = true;  ///< false where the caller knows the torque to be wrong
  bool phase_valid = true;   ///< false where the caller has no angle for this sample
};

template <class Real>
struct TrackingNotchReading {
  Real torque_Nm = Real(0);  ///< after all notches; the last one for a rejected sample
  Real ripple_Nm = Real(0);  ///< what they removed; likewise
  Status status = 0;
};

template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr TrackingNotchState<Real, MaxOrders> initial_state(
    const TrackingNotchConfig<Real, MaxOrders>& /*config*/) {
  return {};
}

namespace detail {

/// Time over which the rotation is smoothed before it decides on the fade, s: an encoder that
/// dithers between two counts at rest must not open a notch.
inline constexpr float fade_smoothing_s = 0.02F;

/// tan(half the bandwidth's angle per sample): beta of the formulas above.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Real notch_beta(const TrackingNotchConfig<Real, MaxOrders>& config) {
  const auto half = cos_sin_of_radians(pi<Real> * config.bandwidth_Hz * config.sample_period_s);
  return half.sine / half.cosine;
}

/// How far a notch is open, 0 to 1: by the centre's distance from 0 Hz, of the smoothed
/// rotation, and from the Nyquist frequency, of this sample's.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Real notch_opening(const TrackingNotchConfig<Real, MaxOrders>& config,
                                           Real order, Real smoothed_rotation_rad,
                                           Real rotation_rad) {
  const Real bandwidth_rad = two_pi<Real> * config.bandwidth_Hz * config.sample_period_s;
  const Real above_zero_rad = absolute(order * smoothed_rotation_rad);
  const Real below_nyquist_rad = pi<Real> - absolute(order * rotation_rad);
  const Real nearest_rad = above_zero_rad < below_nyquist_rad ? above_zero_rad : below_nyquist_rad;
  const Real opening = nearest_rad / bandwidth_rad - Real(1);
  if (!(opening > Real(0))) {
    return Real(0);
  }
  return opening < Real(1) ? opening : Real(1);
}

/// Takes in the motor's phase and returns how far it has turned since the last sample.  Where there
/// is none, the motor is taken to turn on as before, and the next phase puts right what was wrong.
template <class Real, std::size_t MaxOrders>
constexpr Phase take_notch_phase(const TrackingNotchConfig<Real, MaxOrders>& config,
                                 TrackingNotchState<Real, MaxOrders>& state,
                                 const TrackingNotchSample<Real>& sample) {
  if (!state.phase_known) {
    if (sample.phase_valid) {
      state.phase = sample.motor_phase;
      state.phase_known = true;
    }
    return {};
  }
  const Phase turn = sample.phase_valid ? sample.motor_phase - state.phase : state.last_turn;
  if (sample.phase_valid && !state.phase_carried) {
    state.last_turn = turn;
    const Real rotation_rad = to_radians<Real>(turn);
    const Real share =
        config.sample_period_s / (config.sample_period_s + static_cast<Real>(fade_smoothing_s));
    state.smoothed_rotation_rad += (state.smoothed_rotation_known ? share : Real(1)) *
                                   (rotation_rad - state.smoothed_rotation_rad);
    state.smoothed_rotation_known = true;
  }
  state.phase_carried = !sample.phase_valid;
  return turn;
}

}  // namespace detail

/// One sample.  Never fails; see the status.
template <class Real, std::size_t MaxOrders>
inline TrackingNotchReading<Real> step(const TrackingNotchConfig<Real, MaxOrders>& config,
                                       TrackingNotchState<Real, MaxOrders>& state,
                                       const TrackingNotchSample<Real>& sample) {
  TrackingNotchReading<Real> reading;
  if (!sample.phase_valid) {
    reading.status |= mask(StatusFlag::rotation_invalid);
  }
  const bool torque_usable = sample.torque_valid && is_usable_torque(sample.measured_torque_Nm);
  if (!torque_usable && sample.torque_valid) {
    reading.status |= mask(StatusFlag::torque_not_finite);
  }
  const Phase turn = detail::take_notch_phase(config, state, sample);
  const Phase now = state.phase + turn;
  const Real rotation_rad = to_radians<Real>(turn);
  const Real whole_beta = detail::notch_beta(config);
  const Real whole_root = square_root(whole_beta);
  Real ripple_Nm = Real(0);
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    const Real order = to_real<Real>(config.orders[a]);
    if (absolute(order * rotation_rad) > pi<Real>) {
      reading.status |= mask(StatusFlag::order_above_nyquist);
    }
    const auto [cosine, sine] = cos_sin_of_fraction<Real>(
        order_fraction(now, config.orders[a]) - order_fraction(state.phase, config.orders[a]));
    const Real first_Nm = cosine * state.first_Nm[a] - sine * state.second_Nm[a];
    Real second_Nm = cosine * state.second_Nm[a] + sine * state.first_Nm[a];
    if (torque_usable) {
      const Real opening =
          detail::notch_opening(config, order, state.smoothed_rotation_rad, rotation_rad);
      // Squared, so that what is removed, which goes with the root, opens without a corner.
      const Real beta = whole_beta * opening * opening;
      // Input and second state are turned into one another: the cosine of that turn is 1 - damping,
      // its sine is coupling.
      const Real damping = Real(2) * beta / (Real(1) + beta);
      const Real coupling = Real(2) * whole_root * opening / (Real(1) + beta);
      const Real input_Nm = sample.measured_torque_Nm - ripple_Nm;
      ripple_Nm += Real(0.5) * (damping * input_Nm - coupling * second_Nm);
      second_Nm -= damping * second_Nm + coupling * input_Nm;
    }
    state.first_Nm[a] = first_Nm;
    state.second_Nm[a] = second_Nm;
  }
  state.phase = now;
  if (torque_usable) {
    state.last_torque_Nm = sample.measured_torque_Nm - ripple_Nm;
    state.last_ripple_Nm = ripple_Nm;
  }
  reading.torque_Nm = state.last_torque_Nm;
  reading.ripple_Nm = state.last_ripple_Nm;
  record(state.counters, reading.status);
  return reading;
}

}  // namespace strainwave
