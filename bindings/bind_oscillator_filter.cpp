// SPDX-License-Identifier: Apache-2.0
#include "bind_oscillator_filter.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "bind_status.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

template <class T>
using Optional = std::optional<T>;

/// One filter of a compiled precision and capacity.
template <class RealT, std::size_t MaxOrders>
struct Instance {
  using Real = RealT;
  OscillatorFilterConfig<Real, MaxOrders> config;
  OscillatorFilterState<Real, MaxOrders> state;

  explicit Instance(const OscillatorConfigD& from)
      : config(converted<Real, MaxOrders>(from)), state(initial_state(config)) {
    require(check(config));  // what double holds may vanish or overflow in float
  }

  void process(std::size_t size, const Real* torque_Nm, const Real* expected_Nm,
               const RotationArrays<Real>& rotation, Real* clean_Nm, Real* ripple_Nm,
               std::uint32_t* status) {
    OscillatorSample<Real> sample;
    for (std::size_t k = 0; k < size; ++k) {
      sample.measured_torque_Nm = torque_Nm[k];
      sample.expected_torque_Nm = expected_Nm == nullptr ? Real(0) : expected_Nm[k];
      rotation.put(k, sample);
      const OscillatorReading<Real> reading = step(config, state, sample);
      clean_Nm[k] = reading.torque_Nm;
      ripple_Nm[k] = reading.ripple_Nm;
      status[k] = reading.status;
    }
  }
};

template <class Real>
using Results = std::tuple<VectorOut<Real>, VectorOut<Real>, VectorOut<std::uint32_t>>;

class Filter {
 public:
  Filter(const OscillatorConfigD& config, bool single_precision, std::size_t least_capacity)
      : config_(config),
        single_precision_(single_precision),
        least_capacity_(least_capacity),
        instance_(make()) {
    if (least_capacity > most_orders) {
      raise_input_error("least_capacity = " + std::to_string(least_capacity) +
                        ": expected at most " + std::to_string(most_orders) +
                        " orders; choose a smaller one");
    }
  }

  [[nodiscard]] const OscillatorConfigD& config() const { return config_; }
  [[nodiscard]] bool single_precision() const { return single_precision_; }
  [[nodiscard]] std::size_t capacity() const {
    return std::visit([](const auto& instance) { return instance.state.max_states / 2; },
                      instance_);
  }
  void reset() {
    calls_.wait();
    instance_ = make();
  }
  [[nodiscard]] Filter copy() const {
    calls_.wait();
    return *this;
  }

  template <class Real>
  Results<Real> process(const Vector<Real>& torque_Nm, const Optional<Vector<Real>>& speed_rad_s,
                        const Optional<Vector<double>>& angle_rad,
                        const Optional<Vector<Real>>& expected_Nm,
                        const Given<Real, Real, std::uint32_t>& out) {
    require_precision<Real>(single_precision_);
    const std::size_t size = torque_Nm.shape(0);
    RotationArrays<Real> rotation;
    if (speed_rad_s) {
      require_same_length("motor_speed_rad_s", speed_rad_s->shape(0), "torque_Nm", size);
      rotation.speed_rad_s = speed_rad_s->data();
    }
    if (angle_rad) {
      require_same_length("motor_angle_rad", angle_rad->shape(0), "torque_Nm", size);
      rotation.angle_rad = angle_rad->data();
    }
    require_rotation(config_.rotation_source, speed_rad_s, angle_rad);
    if (expected_Nm) {
      require_same_length("expected_torque_Nm", expected_Nm->shape(0), "torque_Nm", size);
    }
    auto clean = result_array<0>(out, size);
    auto ripple = result_array<1>(out, size);
    auto status = result_array<2>(out, size);
    {
      const CallLock::Long running(calls_);
      std::visit(
          [&](auto& instance) {
            using InstanceReal = std::remove_reference_t<decltype(instance)>::Real;
            if constexpr (std::is_same_v<InstanceReal, Real>) {
              instance.process(size, torque_Nm.data(), expected_Nm ? expected_Nm->data() : nullptr,
                               rotation, clean.data(), ripple.data(), status.data());
            }
          },
          instance_);
    }
    return {clean.give(), ripple.give(), status.give()};
  }

  /// One sample; its motion is a speed or an angle, whichever the configuration turns by.
  double step(double torque_Nm, double motion) {
    calls_.wait();
    return std::visit(
        [&](auto& instance) {
          using Real = std::remove_reference_t<decltype(instance)>::Real;
          const auto torque = static_cast<Real>(torque_Nm);
          const auto speed_rad_s = static_cast<Real>(motion);
          RotationArrays<Real> rotation;
          if (config_.rotation_source == RotationSource::speed) {
            rotation.speed_rad_s = &speed_rad_s;
          } else {
            rotation.angle_rad = &motion;
          }
          Real clean_Nm{};
          Real ripple_Nm{};
          instance.process(1, &torque, nullptr, rotation, &clean_Nm, &ripple_Nm,
                           &last_step_status_);
          last_step_ripple_Nm_ = static_cast<double>(ripple_Nm);
          return static_cast<double>(clean_Nm);
        },
        instance_);
  }
  [[nodiscard]] std::pair<double, std::uint32_t> last_step() const {
    return {last_step_ripple_Nm_, last_step_status_};
  }

  [[nodiscard]] std::tuple<VectorOut<double>, MatrixOut<double>> predicted_state() const {
    const std::size_t count = 2 * config_.order_count;
    FilledVector<double> states(count);
    auto* const covariance = new double[count * count];
    calls_.wait();
    std::visit(
        [&](const auto& instance) {
          const auto now = predicted(instance.config, instance.state);
          for (std::size_t i = 0; i < count; ++i) {
            states.data()[i] = static_cast<double>(now.states_Nm[i]);
            for (std::size_t j = 0; j < count; ++j) {
              covariance[i * count + j] = static_cast<double>(now.covariance(i, j));
            }
          }
        },
        instance_);
    const nb::capsule owner(covariance, [](void* p) noexcept { delete[] static_cast<double*>(p); });
    return {states.give(), MatrixOut<double>(covariance, {count, count}, owner)};
  }

  [[nodiscard]] CountsByName counters() const {
    calls_.wait();
    return counts_by_name(
        std::visit([](const auto& instance) { return instance.state.counters; }, instance_));
  }

 private:
  using AnyInstance =
      std::variant<Instance<double, 3>, Instance<double, 8>, Instance<double, most_orders>,
                   Instance<float, 3>, Instance<float, 8>, Instance<float, most_orders>>;

  [[nodiscard]] AnyInstance make() const {
    const std::size_t needed =
        config_.order_count > least_capacity_ ? config_.order_count : least_capacity_;
    if (needed <= 3) {
      return single_precision_ ? AnyInstance(Instance<float, 3>(config_))
                               : AnyInstance(Instance<double, 3>(config_));
    }
    if (needed <= 8) {
      return single_precision_ ? AnyInstance(Instance<float, 8>(config_))
                               : AnyInstance(Instance<double, 8>(config_));
    }
    return single_precision_ ? AnyInstance(Instance<float, most_orders>(config_))
                             : AnyInstance(Instance<double, most_orders>(config_));
  }

  OscillatorConfigD config_;
  bool single_precision_;
  std::size_t least_capacity_;
  CallLock calls_;
  AnyInstance instance_;
  double last_step_ripple_Nm_ = 0.0;
  std::uint32_t last_step_status_ = 0;
};

OscillatorConfigD make_config(const nb::sequence& orders,
                              const std::variant<double, std::vector<double>>& process_noise,
                              double measurement_noise, double initial_variance,
                              double sample_period_s, RotationSource rotation_source,
                              double minimum_travel_rad, double minimum_speed_rad_s,
                              double variance_limit_ratio) {
  OscillatorConfigD config;
  const std::size_t count = nb::len(orders);
  if (count < 1 || count > most_orders) {
    raise_input_error("orders has " + std::to_string(count) + " elements: expected 1 to " +
                      std::to_string(most_orders) + "; give a list of that length");
  }
  config.order_count = count;
  const auto* const each = std::get_if<std::vector<double>>(&process_noise);
  if (each != nullptr) {
    require_same_length("process_noise_variance_Nm2", each->size(), "orders", count);
  }
  for (std::size_t a = 0; a < count; ++a) {
    config.orders[a] = to_valid_rational(nb::object(orders[a]), "orders", "cycles per motor turn");
    config.process_noise_variance_Nm2[a] =
        each != nullptr ? (*each)[a] : std::get<double>(process_noise);
  }
  config.measurement_noise_variance_Nm2 = measurement_noise;
  config.initial_variance_Nm2 = initial_variance;
  config.sample_period_s = sample_period_s;
  config.rotation_source = rotation_source;
  config.minimum_travel_rad = minimum_travel_rad;
  config.minimum_speed_rad_s = minimum_speed_rad_s;
  config.variance_limit_ratio = variance_limit_ratio;
  require(check(config));
  return config;
}

}  // namespace

void bind_oscillator_filter(nb::module_& m) {
  nb::enum_<RotationSource>(m, "RotationSource", "Where the rotation between samples comes from.")
      .value("speed", RotationSource::speed,
             "speed[k] x sample period takes sample k to k+1, as published")
      .value("angle", RotationSource::angle, "the difference of the motor's phases");

  constexpr OscillatorFilterConfig<double, 1> standard;
  nb::class_<OscillatorConfigD>(m, "OscillatorFilterConfig",
                                "Configuration of the filter of Taghirad & Belanger 1999.")
      .def(
          "__init__",
          [](OscillatorConfigD* self, const nb::sequence& orders,
             const std::variant<double, std::vector<double>>& process_noise,
             double measurement_noise, double initial_variance, double sample_period_s,
             const nb::handle& rotation_source, double minimum_travel_rad,
             double minimum_speed_rad_s, double variance_limit_ratio) {
            new (self) OscillatorConfigD(make_config(
                orders, process_noise, measurement_noise, initial_variance, sample_period_s,
                to_enum<RotationSource>(rotation_source, "rotation_source"), minimum_travel_rad,
                minimum_speed_rad_s, variance_limit_ratio));
          },
          nb::kw_only(), "orders"_a,
          "process_noise_variance_Nm2"_a = standard.process_noise_variance_Nm2[0],
          "measurement_noise_variance_Nm2"_a = standard.measurement_noise_variance_Nm2,
          "initial_variance_Nm2"_a = standard.initial_variance_Nm2,
          "sample_period_s"_a = standard.sample_period_s,
          "rotation_source"_a = standard.rotation_source,
          "minimum_travel_rad"_a = standard.minimum_travel_rad,
          "minimum_speed_rad_s"_a = standard.minimum_speed_rad_s,
          "variance_limit_ratio"_a = standard.variance_limit_ratio,
          nb::sig("def __init__(self, *, orders: Sequence[float | numbers.Rational | Rational], "
                  "process_noise_variance_Nm2: float | Sequence[float] = ..., "
                  "measurement_noise_variance_Nm2: float = ..., "
                  "initial_variance_Nm2: float = ..., sample_period_s: float = ..., "
                  "rotation_source: RotationSource | str = ..., minimum_travel_rad: float = ..., "
                  "minimum_speed_rad_s: float = ..., variance_limit_ratio: float = ...) -> None"),
          "orders in cycles per motor turn; process noise one for all or one an order. Protection "
          "at rest and crawl: minimum_travel_rad, minimum_speed_rad_s and variance_limit_ratio, 0 "
          "for off.")
      .def_static(
          "taghirad1999_4", [] { return taghirad1999_4<double, most_orders>(); },
          "Orders 2 and 4, Q = 1e3 I, R = 1, as published in section V; no protection.")
      .def_static(
          "taghirad1999",
          [](const nb::handle& ratio) {
            GearConfig<double> gear;
            gear.ratio = to_valid_rational(ratio, "ratio", "motor turns per output turn");
            require(check(gear));
            const auto config = taghirad1999<double, most_orders>(gear.ratio);
            require(check(config));
            return config;
          },
          "ratio"_a,
          nb::sig("def taghirad1999(ratio: float | numbers.Rational | Rational) -> "
                  "OscillatorFilterConfig"),
          "Orders 2, 4 and 1/ratio, Q = 1e3 I, R = 1, as published in section VI; no protection.")
      .def("__repr__",
           [](const nb::handle& self) {
             return repr_of(
                 self, {"orders", "process_noise_variance_Nm2", "measurement_noise_variance_Nm2",
                        "initial_variance_Nm2", "sample_period_s", "rotation_source",
                        "minimum_travel_rad", "minimum_speed_rad_s", "variance_limit_ratio"});
           })
      .def_prop_ro("orders",
                   [](const OscillatorConfigD& self) {
                     return std::vector<Rational>(self.orders, self.orders + self.order_count);
                   })
      .def_prop_ro("process_noise_variance_Nm2",
                   [](const OscillatorConfigD& self) {
                     return std::vector<double>(self.process_noise_variance_Nm2,
                                                self.process_noise_variance_Nm2 + self.order_count);
                   })
      .def_ro("measurement_noise_variance_Nm2", &OscillatorConfigD::measurement_noise_variance_Nm2)
      .def_ro("initial_variance_Nm2", &OscillatorConfigD::initial_variance_Nm2)
      .def_ro("sample_period_s", &OscillatorConfigD::sample_period_s)
      .def_ro("rotation_source", &OscillatorConfigD::rotation_source)
      .def_ro("minimum_travel_rad", &OscillatorConfigD::minimum_travel_rad)
      .def_ro("minimum_speed_rad_s", &OscillatorConfigD::minimum_speed_rad_s)
      .def_ro("variance_limit_ratio", &OscillatorConfigD::variance_limit_ratio);

  nb::class_<Filter>(m, "OscillatorFilter",
                     "The filter with its state; process() may be called chunk by chunk.")
      .def(nb::init<const OscillatorConfigD&, bool, std::size_t>(), "config"_a, nb::kw_only(),
           "single_precision"_a = false, "least_capacity"_a = 1,
           "single_precision: float, as on a microcontroller. least_capacity: orders the compiled "
           "filter must at least have room for; the result does not depend on it.")
      .def_prop_ro("config", &Filter::config)
      .def_prop_ro("single_precision", &Filter::single_precision)
      .def_prop_ro("capacity", &Filter::capacity, "Orders the compiled filter has room for.")
      .def("reset", &Filter::reset, "Back to x(0) and P(0).")
      .def("copy", &Filter::copy, "An independent filter in the same state.")
      .def("process_float64", &Filter::process<double>, "torque_Nm"_a.noconvert(),
           "motor_speed_rad_s"_a.noconvert() = nb::none(),
           "motor_angle_rad"_a.noconvert() = nb::none(),
           "expected_torque_Nm"_a.noconvert() = nb::none(), "out"_a.noconvert() = nb::none(),
           "Clean torque, ripple and status of contiguous float64 arrays, without copies.")
      .def("process_float32", &Filter::process<float>, "torque_Nm"_a.noconvert(),
           "motor_speed_rad_s"_a.noconvert() = nb::none(),
           "motor_angle_rad"_a.noconvert() = nb::none(),
           "expected_torque_Nm"_a.noconvert() = nb::none(), "out"_a.noconvert() = nb::none(),
           "The same of contiguous float32 arrays; angles stay float64.")
      .def("step", &Filter::step, "torque_Nm"_a, "motion"_a,
           "Clean torque of one sample, Nm; motion is rad/s or rad, whichever the configuration "
           "turns by.")
      .def_prop_ro("last_step", &Filter::last_step, "Ripple, Nm, and status of the last step.")
      .def("predicted_state", &Filter::predicted_state,
           "x(k+1), Nm, and P(k+1), Nm^2, after the last sample k.")
      .def_prop_ro("counters", &Filter::counters, "How often each status flag was raised.");
}

}  // namespace strainwave::bindings
