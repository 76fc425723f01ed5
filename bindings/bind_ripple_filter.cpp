// SPDX-License-Identifier: Apache-2.0
#include "bind_ripple_filter.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>

#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "bind_status.hpp"
#include "strainwave/sample_clock.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

/// The samples of a call; an absent expected torque is null.
template <class Real>
struct RippleArrays {
  std::size_t size = 0;
  const double* time_s = nullptr;
  const double* angle_rad = nullptr;  ///< always double: a float angle loses digits within hours
  const Real* torque_Nm = nullptr;
  const Real* expected_Nm = nullptr;
  bool angle_referenced = true;
};

/// Where a call's results go.
template <class Real>
struct RippleResults {
  Real* clean_Nm = nullptr;
  Real* ripple_Nm = nullptr;
  Real* all_removed_Nm = nullptr;
  Real* state_Nm = nullptr;
  Real* innovation_Nm = nullptr;
  Real* innovation_variance_Nm2 = nullptr;
  std::uint32_t* status = nullptr;
};

/// One filter of a compiled precision and capacity.
template <class RealT, std::size_t MaxPairs>
struct Instance {
  using Real = RealT;
  RippleFilterConfig<Real, MaxPairs> config;
  RippleFilterState<Real, MaxPairs> state;
  SampleClock clock = {};

  Instance(const RippleConfigD& from, const std::optional<LearnedD>& kept)
      : config(converted<Real, MaxPairs>(from)), state(initial_state(config)) {
    require(check(config));  // what double holds may vanish or overflow in float
    if (kept) {
      require(check(from, *kept));
      state = restored(config, converted<Real, MaxPairs>(*kept));
    }
  }

  void process(const RippleArrays<Real>& samples, const RippleResults<Real>& results) {
    RippleSample<Real> sample;
    sample.phase_referenced = samples.angle_referenced;
    for (std::size_t k = 0; k < samples.size; ++k) {
      const Interval interval = take_stamp(clock, samples.time_s[k]);
      sample.interval_s = static_cast<Real>(interval.interval_s);
      if (has(interval.status, StatusFlag::time_not_finite)) {
        sample.interval_s = std::numeric_limits<Real>::quiet_NaN();
      }
      sample.measured_torque_Nm = samples.torque_Nm[k];
      sample.expected_torque_Nm = samples.expected_Nm == nullptr ? Real(0) : samples.expected_Nm[k];
      sample.phase_valid = is_representable_angle(samples.angle_rad[k]);
      if (sample.phase_valid) {
        sample.motor_phase = phase_from_radians(samples.angle_rad[k]);
      }
      const RippleReading<Real> reading = step(config, state, sample);
      results.clean_Nm[k] = reading.torque_Nm;
      results.ripple_Nm[k] = reading.ripple_Nm;
      results.all_removed_Nm[k] = reading.torque_all_removed_Nm;
      results.state_Nm[k] = reading.torque_state_Nm;
      results.innovation_Nm[k] = reading.innovation_Nm;
      results.innovation_variance_Nm2[k] = reading.innovation_variance_Nm2;
      results.status[k] = reading.status | interval.status;
    }
  }
};

template <class Real>
using Results = std::tuple<VectorOut<Real>, VectorOut<Real>, VectorOut<Real>, VectorOut<Real>,
                           VectorOut<Real>, VectorOut<Real>, VectorOut<std::uint32_t>>;

class OwnedFilter {  // not Filter: nanobind tells types apart by name, also in unnamed namespaces
 public:
  OwnedFilter(const RippleConfigD& config, bool single_precision, std::size_t least_capacity,
              const std::optional<LearnedD>& kept)
      : config_(config),
        single_precision_(single_precision),
        least_capacity_(least_capacity),
        kept_(kept),
        instance_(make()) {
    if (least_capacity > most_pairs) {
      raise_input_error("least_capacity = " + std::to_string(least_capacity) +
                        ": expected at most " + std::to_string(most_pairs) +
                        " pairs of coefficients; choose a smaller one");
    }
  }

  [[nodiscard]] const RippleConfigD& config() const { return config_; }
  [[nodiscard]] bool single_precision() const { return single_precision_; }
  [[nodiscard]] std::size_t capacity() const {
    return std::visit([](const auto& instance) { return (instance.state.max_states - 1) / 2; },
                      instance_);
  }
  void reset() {
    calls_.wait();
    instance_ = make();
  }
  [[nodiscard]] OwnedFilter copy() const {
    calls_.wait();
    return *this;
  }

  template <class Real>
  Results<Real> process(const Vector<double>& time_s, const Vector<double>& angle_rad,
                        const Vector<Real>& torque_Nm,
                        const std::optional<Vector<Real>>& expected_Nm, bool angle_referenced,
                        const Given<Real, Real, Real, Real, Real, Real, std::uint32_t>& out) {
    require_precision<Real>(single_precision_);
    const std::size_t size = torque_Nm.shape(0);
    require_same_length("time_s", time_s.shape(0), "torque_Nm", size);
    require_same_length("motor_angle_rad", angle_rad.shape(0), "torque_Nm", size);
    if (expected_Nm) {
      require_same_length("expected_torque_Nm", expected_Nm->shape(0), "torque_Nm", size);
    }
    const RippleArrays<Real> samples = {size,
                                        time_s.data(),
                                        angle_rad.data(),
                                        torque_Nm.data(),
                                        expected_Nm ? expected_Nm->data() : nullptr,
                                        angle_referenced};
    auto clean = result_array<0>(out, size);
    auto ripple = result_array<1>(out, size);
    auto all_removed = result_array<2>(out, size);
    auto state = result_array<3>(out, size);
    auto innovation = result_array<4>(out, size);
    auto innovation_variance = result_array<5>(out, size);
    auto status = result_array<6>(out, size);
    const RippleResults<Real> results = {clean.data(),       ripple.data(),
                                         all_removed.data(), state.data(),
                                         innovation.data(),  innovation_variance.data(),
                                         status.data()};
    {
      const CallLock::Long running(calls_);
      std::visit(
          [&](auto& instance) {
            using InstanceReal = std::remove_reference_t<decltype(instance)>::Real;
            if constexpr (std::is_same_v<InstanceReal, Real>) {
              instance.process(samples, results);
            }
          },
          instance_);
    }
    return {clean.give(), ripple.give(),     all_removed.give(),
            state.give(), innovation.give(), innovation_variance.give(),
            status.give()};
  }

  /// One sample.
  double step(double time_s, double angle_rad, double torque_Nm) {
    calls_.wait();
    return std::visit(
        [&](auto& instance) {
          using Real = std::remove_reference_t<decltype(instance)>::Real;
          const auto torque = static_cast<Real>(torque_Nm);
          Real reals[6] = {};
          instance.process(
              {1, &time_s, &angle_rad, &torque, nullptr, true},
              {reals, reals + 1, reals + 2, reals + 3, reals + 4, reals + 5, &last_step_status_});
          last_step_ripple_Nm_ = static_cast<double>(reals[1]);
          return static_cast<double>(reals[0]);
        },
        instance_);
  }
  [[nodiscard]] std::pair<double, std::uint32_t> last_step() const {
    return {last_step_ripple_Nm_, last_step_status_};
  }

  [[nodiscard]] LearnedD learned_now() const {
    calls_.wait();
    return std::visit(
        [&](const auto& instance) {
          return converted<double, most_pairs>(learned(instance.config, instance.state));
        },
        instance_);
  }

  /// Amplitude and phase of each order now.
  [[nodiscard]] std::tuple<VectorOut<double>, VectorOut<double>> order_ripple_now() const {
    FilledVector<double> amplitude_Nm(config_.order_count);
    FilledVector<double> phase_rad(config_.order_count);
    calls_.wait();
    std::visit(
        [&](const auto& instance) {
          for (std::size_t a = 0; a < config_.order_count; ++a) {
            const auto ripple = order_ripple(instance.config, instance.state, a);
            amplitude_Nm.data()[a] = static_cast<double>(ripple.amplitude_Nm);
            phase_rad.data()[a] = static_cast<double>(ripple.phase_rad);
          }
        },
        instance_);
    return {amplitude_Nm.give(), phase_rad.give()};
  }

  [[nodiscard]] std::tuple<VectorOut<double>, MatrixOut<double>> state_now() const {
    const std::size_t count = 1 + 2 * pair_count(config_);
    FilledVector<double> states(count);
    auto* const covariance = new double[count * count];
    const nb::capsule owner(covariance, [](void* p) noexcept { delete[] static_cast<double*>(p); });
    calls_.wait();
    std::visit(
        [&](const auto& instance) {
          for (std::size_t i = 0; i < count; ++i) {
            states.data()[i] = static_cast<double>(instance.state.states_Nm[i]);
            for (std::size_t j = 0; j <= i; ++j) {
              covariance[i * count + j] = covariance[j * count + i] =
                  static_cast<double>(detail::covariance_of(
                      instance.config, instance.state.covariance, count - 1, i, j));
            }
          }
        },
        instance_);
    return {states.give(), MatrixOut<double>(covariance, {count, count}, owner)};
  }

  [[nodiscard]] CountsByName counters() const {
    calls_.wait();
    return counts_by_name(
        std::visit([](const auto& instance) { return instance.state.counters; }, instance_));
  }

 private:
  using AnyInstance =
      std::variant<Instance<double, 3>, Instance<double, 8>, Instance<double, most_pairs>,
                   Instance<float, 3>, Instance<float, 8>, Instance<float, most_pairs>>;

  [[nodiscard]] AnyInstance make() const {
    const std::size_t pairs = pair_count(config_);
    const std::size_t needed = pairs > least_capacity_ ? pairs : least_capacity_;
    if (needed <= 3) {
      return single_precision_ ? AnyInstance(Instance<float, 3>(config_, kept_))
                               : AnyInstance(Instance<double, 3>(config_, kept_));
    }
    if (needed <= 8) {
      return single_precision_ ? AnyInstance(Instance<float, 8>(config_, kept_))
                               : AnyInstance(Instance<double, 8>(config_, kept_));
    }
    return single_precision_ ? AnyInstance(Instance<float, most_pairs>(config_, kept_))
                             : AnyInstance(Instance<double, most_pairs>(config_, kept_));
  }

  RippleConfigD config_;
  bool single_precision_;
  std::size_t least_capacity_;
  std::optional<LearnedD> kept_;
  CallLock calls_;
  AnyInstance instance_;
  double last_step_ripple_Nm_ = 0.0;
  std::uint32_t last_step_status_ = 0;
};

}  // namespace

void bind_ripple_filter(nb::module_& m) {
  nb::class_<OwnedFilter>(m, "RippleFilter",
                          "The filter with its state; process() may be called chunk by chunk.")
      .def(nb::init<const RippleConfigD&, bool, std::size_t, const std::optional<LearnedD>&>(),
           "config"_a, nb::kw_only(), "single_precision"_a = false, "least_capacity"_a = 1,
           "learned"_a = nb::none(),
           "single_precision: float, as on a microcontroller. least_capacity: pairs the compiled "
           "filter must at least have room for; the result does not depend on it. learned: "
           "coefficients to start with.")
      .def_prop_ro("config", &OwnedFilter::config)
      .def_prop_ro("single_precision", &OwnedFilter::single_precision)
      .def_prop_ro("capacity", &OwnedFilter::capacity, "Pairs the compiled filter has room for.")
      .def("reset", &OwnedFilter::reset, "Back to the start, learned coefficients included.")
      .def("copy", &OwnedFilter::copy, "An independent filter in the same state.")
      .def("learned", &OwnedFilter::learned_now, "Coefficients as they are now.")
      .def("order_ripple", &OwnedFilter::order_ripple_now,
           "Amplitude, Nm, and phase, rad, of each order at the present load and speed.")
      .def("state", &OwnedFilter::state_now, "State [T; c], Nm, and its covariance, Nm^2.")
      .def("process_float64", &OwnedFilter::process<double>, "time_s"_a.noconvert(),
           "motor_angle_rad"_a.noconvert(), "torque_Nm"_a.noconvert(),
           "expected_torque_Nm"_a.noconvert() = nb::none(), "angle_referenced"_a = true,
           "out"_a.noconvert() = nb::none(),
           "Torque, ripple, torque without any ripple, T, innovation, its variance and status of "
           "contiguous float64 arrays, without copies.")
      .def("process_float32", &OwnedFilter::process<float>, "time_s"_a.noconvert(),
           "motor_angle_rad"_a.noconvert(), "torque_Nm"_a.noconvert(),
           "expected_torque_Nm"_a.noconvert() = nb::none(), "angle_referenced"_a = true,
           "out"_a.noconvert() = nb::none(),
           "The same of contiguous float32 arrays; times and angles stay float64.")
      .def("step", &OwnedFilter::step, "time_s"_a, "motor_angle_rad"_a, "torque_Nm"_a,
           "Clean torque of one sample, Nm.")
      .def_prop_ro("last_step", &OwnedFilter::last_step, "Ripple, Nm, and status of the last step.")
      .def_prop_ro("counters", &OwnedFilter::counters, "How often each status flag was raised.");
}

}  // namespace strainwave::bindings
