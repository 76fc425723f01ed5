// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>

#include <optional>
#include <tuple>
#include <variant>
#include <vector>

#include "bind_ripple_filter.hpp"
#include "strainwave/ripple_smoother.hpp"
#include "strainwave/sample_clock.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

/// Rows of one call.
struct SmootherRows {
  std::size_t size = 0;
  const double* time_s = nullptr;
  const double* angle_rad = nullptr;
  const double* torque_Nm = nullptr;
  const double* expected_Nm = nullptr;
};

/// A smoother of a compiled capacity, with the forward state at the first row not handed out yet.
template <std::size_t MaxPairs>
struct SmootherInstance {
  RippleFilterConfig<double, MaxPairs> config;
  RippleFilterState<double, MaxPairs> state;
  SampleClock clock = {};
  double last_torque_Nm = 0.0;

  explicit SmootherInstance(const RippleConfigD& from)
      : config(converted<double, MaxPairs>(from)), state(initial_state(config)) {}

  void process(const SmootherRows& rows, std::size_t finished, double* clean_Nm, double* ripple_Nm,
               std::uint32_t* status) {
    std::vector<SmootherTrace<double, MaxPairs>> traces(rows.size);
    auto ahead = state;
    auto ahead_clock = clock;
    RippleSample<double> sample;
    for (std::size_t k = 0; k < rows.size; ++k) {
      const Interval interval = take_stamp(ahead_clock, rows.time_s[k]);
      sample.interval_s = has(interval.status, StatusFlag::time_not_finite)
                              ? std::numeric_limits<double>::quiet_NaN()
                              : interval.interval_s;
      sample.measured_torque_Nm = rows.torque_Nm[k];
      sample.expected_torque_Nm = rows.expected_Nm[k];
      sample.phase_valid = is_representable_angle(rows.angle_rad[k]);
      if (sample.phase_valid) {
        sample.motor_phase = phase_from_radians(rows.angle_rad[k]);
      }
      (void)step_forward(config, ahead, sample, traces[k]);
      traces[k].status |= interval.status;
      if (k + 1 == finished) {
        state = ahead;
        clock = ahead_clock;
      }
    }
    SmootherState<double, MaxPairs> back;
    for (std::size_t k = rows.size; k-- > 0;) {
      const double smoothed_Nm = step_backward(back, traces[k]);
      if (k < finished) {
        ripple_Nm[k] = smoothed_Nm;
      }
    }
    for (std::size_t k = 0; k < finished; ++k) {
      if (!traces[k].holds) {
        last_torque_Nm = traces[k].measured_Nm - ripple_Nm[k];
      }
      clean_Nm[k] = last_torque_Nm;
      ripple_Nm[k] = traces[k].measured_Nm - last_torque_Nm;
      status[k] = traces[k].status;
    }
  }
};

class OwnedSmoother {
 public:
  explicit OwnedSmoother(const RippleConfigD& config) : instance_(make(config)) {}

  std::tuple<VectorOut<double>, VectorOut<double>, VectorOut<std::uint32_t>> process(
      const Vector<double>& time_s, const Vector<double>& angle_rad,
      const Vector<double>& torque_Nm, const Vector<double>& expected_Nm, std::size_t finished) {
    const SmootherRows rows = {torque_Nm.shape(0), time_s.data(), angle_rad.data(),
                               torque_Nm.data(), expected_Nm.data()};
    require_same_length("time_s", time_s.shape(0), "torque_Nm", rows.size);
    require_same_length("motor_angle_rad", angle_rad.shape(0), "torque_Nm", rows.size);
    require_same_length("expected_torque_Nm", expected_Nm.shape(0), "torque_Nm", rows.size);
    if (finished > rows.size) {
      raise_input_error("finished_rows = " + std::to_string(finished) + ": expected at most the " +
                        std::to_string(rows.size) + " rows given; give more rows");
    }
    FilledVector<double> clean(finished);
    FilledVector<double> ripple(finished);
    FilledVector<std::uint32_t> status(finished);
    {
      const CallLock::Long running(calls_);
      std::visit(
          [&](auto& instance) {
            instance.process(rows, finished, clean.data(), ripple.data(), status.data());
          },
          instance_);
    }
    return {clean.give(), ripple.give(), status.give()};
  }

 private:
  using AnyInstance =
      std::variant<SmootherInstance<3>, SmootherInstance<8>, SmootherInstance<most_pairs>>;

  static AnyInstance make(const RippleConfigD& config) {
    const std::size_t pairs = pair_count(config);
    if (pairs <= 3) {
      return AnyInstance(std::in_place_type<SmootherInstance<3>>, config);
    }
    if (pairs <= 8) {
      return AnyInstance(std::in_place_type<SmootherInstance<8>>, config);
    }
    return AnyInstance(std::in_place_type<SmootherInstance<most_pairs>>, config);
  }

  CallLock calls_;
  AnyInstance instance_;
};

}  // namespace

void bind_ripple_smoother(nb::module_& m) {
  nb::class_<OwnedSmoother>(m, "RippleSmoother",
                            "The ripple filter's model forwards and backwards, block by block.")
      .def(nb::init<const RippleConfigD&>(), "config"_a)
      .def("process", &OwnedSmoother::process, "time_s"_a.noconvert(),
           "motor_angle_rad"_a.noconvert(), "torque_Nm"_a.noconvert(),
           "expected_torque_Nm"_a.noconvert(), "finished_rows"_a,
           "Torque, ripple and status of the first finished_rows rows; the rows after them are "
           "looked at, and have to be given again as the first ones of the next call.");
}

}  // namespace strainwave::bindings
