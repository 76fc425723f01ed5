// The core as firmware compiles it: no hosted library, exceptions or RTTI.  The whole chain with
// either filter, and every part that it does not need, is instantiated for float and for double
// behind functions with C linkage and data that only the caller knows, so that nothing can be
// computed away.
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "strainwave/fluctuation.hpp"
#include "strainwave/gear.hpp"
#include "strainwave/learned_ripple.hpp"
#include "strainwave/sample_clock.hpp"
#include "strainwave/torque_sensor.hpp"
#include "strainwave/tracking_notch.hpp"

namespace {

constexpr std::size_t max_gauges = 8;
constexpr std::size_t max_orders = 3;
constexpr std::size_t max_pairs = 8;

template <class Real>
using Config = strainwave::TorqueSensorConfig<Real, max_gauges, max_orders>;
template <class Real>
using State = strainwave::TorqueSensorState<Real, max_gauges, max_orders>;
template <class Real>
using RippleConfig = strainwave::RippleSensorConfig<Real, max_gauges, max_pairs>;
template <class Real>
using RippleState = strainwave::RippleSensorState<Real, max_gauges, max_pairs>;
template <class Real>
using Sample = strainwave::TorqueSensorSample<max_gauges, Real>;

/// Puts the published filter in a configuration; true where the whole can be used.
template <class Real>
bool start(Config<Real>& config, State<Real>& state) {
  config.filter = strainwave::taghirad1999<Real, max_orders>({100, 1});
  state = strainwave::initial_state(config);
  return strainwave::check(config).ok();
}

/// Starts with what the filter had learned where that belongs to it.
template <class Real>
bool start(const RippleConfig<Real>& config, RippleState<Real>& state) {
  const auto kept = strainwave::learned(config.filter, state.filter);
  state = strainwave::initial_state(config);
  if (check(config.filter, kept).ok()) {
    state.filter = strainwave::restored(config.filter, kept);
  }
  return strainwave::check(config).ok();
}

template <class Config, class State, class Real>
Real advance(const Config& config, State& state, const Sample<Real>& sample) {
  return strainwave::step(config, state, sample).torque_Nm;
}

/// As a logger feeds it, by time stamps.
template <class Real>
Real advance_to(const RippleConfig<Real>& config, RippleState<Real>& state,
                strainwave::SampleClock& clock, double time_s, Sample<Real> sample) {
  sample.interval_s = static_cast<Real>(strainwave::take_stamp(clock, time_s).interval_s);
  return advance(config, state, sample) +
         strainwave::order_ripple(config.filter, state.filter, 0).amplitude_Nm;
}

/// What only the caller knows, for the parts that the chain does not need.
template <class Real>
struct Parts {
  strainwave::GearConfig<Real> gear;
  strainwave::GaugeFluctuation<Real, 4> gauge;
  strainwave::Rosette<Real> rosettes[2];
  strainwave::SurfaceStrain<Real> strain;
  strainwave::Amplifier<Real> amplifier;
  strainwave::Converter<Real> converter;
  strainwave::TorqueCalibration<Real> calibration;
  strainwave::Gains<Real, max_gauges> gains;
  strainwave::OscillatorFilterConfig<Real, max_orders> filter;
  strainwave::RippleFilterConfig<Real, max_pairs> ripple_filter;
  strainwave::TrackingNotchConfig<Real, max_orders> notch;
  strainwave::Phase phase;
  Real real = Real(0);
  std::uint32_t raw = 0;
  std::size_t index = 0;
};

template <class Real>
Real of_units(Parts<Real>& parts) {
  parts.phase = parts.phase + strainwave::phase_from_turns(parts.real) -
                strainwave::phase_from_counts(parts.phase.turns, parts.raw | 1U);
  if (strainwave::is_representable_angle(parts.real)) {
    parts.phase = strainwave::phase_from_radians(parts.real);
  }
  strainwave::EncoderCounter counter{.counts = 0, .last_raw = 0, .started = false};
  parts.phase.turns += counter.update(parts.raw);
  const strainwave::Rational order =
      multiply(strainwave::rational_from(static_cast<double>(parts.real)), parts.gear.ratio);
  const auto turn = strainwave::cos_sin_of_radians(parts.real);
  return strainwave::to_turns<Real>(parts.phase) + strainwave::to_radians<Real>(parts.phase) +
         strainwave::to_real<Real>(order) + turn.cosine + strainwave::square_root(turn.sine);
}

template <class Real>
Real of_gear_and_gauges(Parts<Real>& parts) {
  parts.gear = strainwave::gear_from_teeth<Real>(parts.gear.configuration, parts.raw,
                                                 parts.raw + 2U, parts.real);
  parts.gauge.wave_factor = strainwave::wave_factor(parts.gear);
  parts.gauge.position_rad =
      strainwave::equally_spaced_position_rad<Real>(parts.index + 1, max_gauges);
  return strainwave::signed_reduction_ratio<Real>(parts.gear.configuration, parts.gear.ratio) +
         strainwave::to_real<Real>(strainwave::misalignment_order(parts.gear)) +
         strainwave::signal_fluctuation(parts.gauge, parts.phase) +
         strainwave::fluctuation_phasor(parts.gauge, parts.index % 4).cosine;
}

template <class Real>
Real of_bridge(const Parts<Real>& parts) {
  const strainwave::RosetteStrain<Real> strains[2] = {
      strainwave::rosette_strain(parts.rosettes[0], parts.strain),
      strainwave::rosette_strain(parts.rosettes[1], parts.strain)};
  const Real input_V = strainwave::full_bridge_V(parts.rosettes, strains, 2, parts.real) +
                       strainwave::half_bridge_V(parts.real, strains[0], parts.real);
  const auto code =
      strainwave::to_code(parts.converter, strainwave::amplified_V(parts.amplifier, input_V));
  return strainwave::is_saturated(parts.converter, code)
             ? Real(0)
             : strainwave::to_volts(parts.converter, code);
}

template <class Real>
Real of_configurations(const Parts<Real>& parts) {
  using Other = std::conditional_t<std::is_same_v<Real, float>, double, float>;
  const Config<Other> other = {strainwave::converted<Other>(parts.converter),
                               strainwave::converted<Other, max_gauges>(parts.gains),
                               strainwave::converted<Other>(parts.calibration),
                               strainwave::converted<Other, max_orders>(parts.filter)};
  const auto config = strainwave::converted<Real, max_gauges, max_orders>(other);
  const RippleConfig<Other> other_ripple = {
      other.converter, other.gains, other.calibration,
      strainwave::converted<Other, max_pairs>(parts.ripple_filter), static_cast<Other>(parts.real)};
  const auto ripple = strainwave::converted<Real, max_gauges, max_pairs>(other_ripple);
  const bool usable = check(ripple).ok() && check(parts.gear).ok() &&
                      check(parts.rosettes[0]).ok() && check(parts.amplifier).ok() &&
                      check(config).ok();
  return usable ? strainwave::noise_factor(config.gains) : Real(-1);
}

template <class Real>
Real of_filter(const Parts<Real>& parts) {
  auto state = strainwave::initial_state(parts.filter);
  strainwave::OscillatorSample<Real> sample;
  sample.measured_torque_Nm = parts.real;
  sample.motor_phase = parts.phase;
  Real sum = strainwave::step(parts.filter, state, sample).torque_Nm;
  strainwave::skip(parts.filter, state, parts.raw);
  const auto published = strainwave::taghirad1999_4<Real, max_orders>();
  sum += strainwave::predicted(parts.filter, state).states_Nm[0];
  return sum + strainwave::step(published, state, sample).ripple_Nm;
}

template <class Real>
Real of_notch(const Parts<Real>& parts) {
  using Other = std::conditional_t<std::is_same_v<Real, float>, double, float>;
  const auto other = strainwave::converted<Other, max_orders>(parts.notch);
  const auto config = strainwave::converted<Real, max_orders>(other);
  auto state = strainwave::initial_state(config);
  strainwave::TrackingNotchSample<Real> sample;
  sample.measured_torque_Nm = parts.real;
  sample.motor_phase = parts.phase;
  return check(config).ok() ? strainwave::step(config, state, sample).torque_Nm : Real(-1);
}

template <class Real>
Real all_parts(Parts<Real>& parts) {
  return of_units(parts) + of_gear_and_gauges(parts) + of_bridge(parts) + of_configurations(parts) +
         of_filter(parts) + of_notch(parts);
}

}  // namespace

extern "C" {

bool freestanding_start_float(Config<float>& config, State<float>& state) {
  return start(config, state);
}

bool freestanding_start_double(Config<double>& config, State<double>& state) {
  return start(config, state);
}

float freestanding_step_float(const Config<float>& config, State<float>& state,
                              const Sample<float>& sample) {
  return advance(config, state, sample);
}

double freestanding_step_double(const Config<double>& config, State<double>& state,
                                const Sample<double>& sample) {
  return advance(config, state, sample);
}

bool freestanding_start_ripple_float(const RippleConfig<float>& config, RippleState<float>& state) {
  return start(config, state);
}

bool freestanding_start_ripple_double(const RippleConfig<double>& config,
                                      RippleState<double>& state) {
  return start(config, state);
}

float freestanding_step_ripple_float(const RippleConfig<float>& config, RippleState<float>& state,
                                     strainwave::SampleClock& clock, double time_s,
                                     const Sample<float>& sample) {
  return advance_to(config, state, clock, time_s, sample);
}

double freestanding_step_ripple_double(const RippleConfig<double>& config,
                                       RippleState<double>& state, strainwave::SampleClock& clock,
                                       double time_s, const Sample<double>& sample) {
  return advance_to(config, state, clock, time_s, sample);
}

float freestanding_parts_float(Parts<float>& parts) { return all_parts(parts); }

double freestanding_parts_double(Parts<double>& parts) { return all_parts(parts); }

}  // extern "C"
