// SPDX-License-Identifier: Apache-2.0
#include "strainwave/tracking_notch.hpp"

#include <nanobind/stl/tuple.h>

#include <tuple>

#include "common.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

using Config = TrackingNotchConfig<double, most_orders>;
using Results = std::tuple<VectorOut<double>, VectorOut<double>, VectorOut<std::uint32_t>>;

Config make_config(const nb::sequence& orders, double bandwidth_Hz, double sample_period_s) {
  Config config;
  const std::size_t count = nb::len(orders);
  if (count < 1 || count > most_orders) {
    raise_input_error("orders has " + std::to_string(count) + " elements: expected 1 to " +
                      std::to_string(most_orders) + "; give a list of that length");
  }
  config.order_count = count;
  for (std::size_t a = 0; a < count; ++a) {
    config.orders[a] = to_valid_rational(nb::object(orders[a]), "orders", "cycles per motor turn");
  }
  config.bandwidth_Hz = bandwidth_Hz;
  config.sample_period_s = sample_period_s;
  require(check(config));
  return config;
}

class Notch {
 public:
  Notch(const nb::sequence& orders, double bandwidth_Hz, double sample_period_s)
      : config_(make_config(orders, bandwidth_Hz, sample_period_s)),
        state_(initial_state(config_)) {}

  Results process(const Vector<double>& torque_Nm, const Vector<double>& angle_rad) {
    const std::size_t size = torque_Nm.shape(0);
    require_same_length("motor_angle_rad", angle_rad.shape(0), "torque_Nm", size);
    FilledVector<double> clean(size);
    FilledVector<double> ripple(size);
    FilledVector<std::uint32_t> status(size);
    {
      const CallLock::Long running(calls_);
      TrackingNotchSample<double> sample;
      for (std::size_t k = 0; k < size; ++k) {
        sample.measured_torque_Nm = torque_Nm.data()[k];
        sample.phase_valid = is_representable_angle(angle_rad.data()[k]);
        if (sample.phase_valid) {
          sample.motor_phase = phase_from_radians(angle_rad.data()[k]);
        }
        const TrackingNotchReading<double> reading = step(config_, state_, sample);
        clean.data()[k] = reading.torque_Nm;
        ripple.data()[k] = reading.ripple_Nm;
        status.data()[k] = reading.status;
      }
    }
    return {clean.give(), ripple.give(), status.give()};
  }

 private:
  Config config_;
  TrackingNotchState<double, most_orders> state_;
  CallLock calls_;
};

}  // namespace

void bind_tracking_notch(nb::module_& m) {
  constexpr TrackingNotchConfig<double, 1> standard;
  nb::class_<Notch>(m, "TrackingNotch",
                    "Notches in series that follow the motor; process() may be called chunk by "
                    "chunk.")
      .def(nb::init<const nb::sequence&, double, double>(), nb::kw_only(), "orders"_a,
           "bandwidth_Hz"_a = standard.bandwidth_Hz, "sample_period_s"_a,
           nb::sig("def __init__(self, *, orders: Sequence[float | numbers.Rational | Rational], "
                   "bandwidth_Hz: float = ..., sample_period_s: float) -> None"),
           "orders in cycles per motor turn; bandwidth between the two -3 dB points.")
      .def("process", &Notch::process, "torque_Nm"_a.noconvert(), "motor_angle_rad"_a.noconvert(),
           "Clean torque, ripple and status of contiguous float64 arrays, without copies.");
}

}  // namespace strainwave::bindings
