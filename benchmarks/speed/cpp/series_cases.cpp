// SPDX-License-Identifier: Apache-2.0
// The published filter, one channel, all samples in one call.  A file of its own: beside step()
// itself the compiler would inline neither as it does alone.
#include "strainwave/oscillator_series.hpp"

#include "cases.hpp"
#include "filters.hpp"

namespace speed {

namespace {

template <class Real, class ConfigOf>
Case series_case(const Recording& recording, const ConfigOf& config_of) {
  return single_channel(
      std::vector<Real>(recording.samples()),
      [config_of, torque = converted<Real>(recording.torque_Nm),
       speed = converted<Real>(recording.motor_speed_rad_s)](std::size_t samples, Real* ripple_Nm) {
        const auto& config = config_of();
        auto state = strainwave::initial_state(config);
        strainwave::OscillatorSeries<Real> series;
        series.sample_count = samples;
        series.measured_torque_Nm = torque.data();
        series.motor_speed_rad_s = speed.data();
        series.ripple_Nm = ripple_Nm;
        strainwave::steps(config, state, series);
      });
}

/// The configuration is a constant.
template <class Real>
Case series_constant(const Recording& recording, const Options& /*options*/) {
  return series_case<Real>(recording, []() -> const auto& { return published<Real>; });
}

/// The configuration is read, as from a joint file.
template <class Real>
Case series_run_time(const Recording& recording, const Options& /*options*/) {
  return series_case<Real>(recording, [config = published<Real>] { return config; });
}

}  // namespace

void add_series(Cases& cases) {
  cases["published_series_float"] = series_constant<float>;
  cases["published_series_double"] = series_constant<double>;
  cases["published_series_float_run_time"] = series_run_time<float>;
}

}  // namespace speed
