// SPDX-License-Identifier: Apache-2.0
#include "strainwave/torque_sensor.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>

#include <optional>
#include <tuple>
#include <variant>

#include "bind_gains.hpp"
#include "bind_oscillator_filter.hpp"
#include "bind_status.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

using ConfigD = TorqueSensorConfig<double, most_gauges, most_orders>;

/// Arrays of one call, already checked for their lengths.
template <class Real>
struct Inputs {
  std::size_t size = 0;
  std::size_t channels = 0;
  const std::int32_t* codes = nullptr;
  RotationArrays<Real> rotation;
  const Real* expected_Nm = nullptr;
  const Real* temperature_degC = nullptr;
  const std::uint32_t* sequence = nullptr;
};

template <class Real>
struct Outputs {
  NewVector<Real> measured_Nm;
  NewVector<Real> clean_Nm;
  NewVector<Real> ripple_Nm;
  NewVector<std::uint32_t> status;
  explicit Outputs(std::size_t size)
      : measured_Nm(size), clean_Nm(size), ripple_Nm(size), status(size) {}
};

/// One sensor of a compiled precision and capacity.
template <class RealT, std::size_t MaxGauges, std::size_t MaxOrders>
struct Instance {
  using Real = RealT;
  TorqueSensorConfig<Real, MaxGauges, MaxOrders> config;
  TorqueSensorState<Real, MaxGauges, MaxOrders> state;

  explicit Instance(const ConfigD& from)
      : config(converted<Real, MaxGauges, MaxOrders>(from)), state(initial_state(config)) {
    require(check(config));  // what double holds may vanish or overflow in float
  }

  void process(const Inputs<Real>& in, Outputs<Real>& out) {
    TorqueSensorSample<MaxGauges, Real> sample;
    sample.temperature_degC = config.calibration.reference_temperature_degC;
    for (std::size_t k = 0; k < in.size; ++k) {
      for (std::size_t j = 0; j < in.channels; ++j) {
        sample.codes[j] = {in.codes[k * in.channels + j]};
      }
      in.rotation.put(k, sample);
      if (in.expected_Nm != nullptr) {
        sample.expected_torque_Nm = in.expected_Nm[k];
      }
      if (in.temperature_degC != nullptr) {
        sample.temperature_degC = in.temperature_degC[k];
      }
      sample.sequence_valid = in.sequence != nullptr;
      sample.sequence = sample.sequence_valid ? in.sequence[k] : 0U;
      const TorqueReading<Real> reading = step(config, state, sample);
      out.measured_Nm.data()[k] = reading.torque_measured_Nm;
      out.clean_Nm.data()[k] = reading.torque_Nm;
      out.ripple_Nm.data()[k] = reading.ripple_Nm;
      out.status.data()[k] = reading.status;
    }
  }
};

template <class Real>
using Results =
    std::tuple<VectorOut<Real>, VectorOut<Real>, VectorOut<Real>, VectorOut<std::uint32_t>>;

class Sensor {
 public:
  Sensor(const ConfigD& config, bool single_precision)
      : config_(config), single_precision_(single_precision), instance_(make()) {}

  [[nodiscard]] const ConfigD& config() const { return config_; }
  [[nodiscard]] bool single_precision() const { return single_precision_; }
  void reset() {
    const auto held = calls_.hold();
    instance_ = make();
  }
  [[nodiscard]] Sensor copy() const {
    const auto held = calls_.hold();
    return *this;
  }

  template <class Real>
  Results<Real> process(const Matrix<std::int32_t>& codes,
                        const std::optional<Vector<Real>>& speed_rad_s,
                        const std::optional<Vector<double>>& angle_rad,
                        const std::optional<Vector<Real>>& expected_Nm,
                        const std::optional<Vector<Real>>& temperature_degC,
                        const std::optional<Vector<std::uint32_t>>& sequence) {
    require_precision<Real>(single_precision_);
    Inputs<Real> in;
    in.size = codes.shape(0);
    in.channels = codes.shape(1);
    in.codes = codes.data();
    require_same_length("codes' second axis", in.channels, "the gains", config_.gains.count);
    const auto take = [&in](const char* name, const auto& array, auto& pointer) {
      if (array) {
        require_same_length(name, array->shape(0), "codes", in.size);
        pointer = array->data();
      }
    };
    take("motor_speed_rad_s", speed_rad_s, in.rotation.speed_rad_s);
    take("motor_angle_rad", angle_rad, in.rotation.angle_rad);
    take("expected_torque_Nm", expected_Nm, in.expected_Nm);
    take("temperature_degC", temperature_degC, in.temperature_degC);
    take("sequence", sequence, in.sequence);
    require_rotation(config_.filter.rotation_source, speed_rad_s, angle_rad);
    Outputs<Real> out(in.size);
    {
      const nb::gil_scoped_release release;
      const auto held = calls_.hold();
      std::visit(
          [&](auto& instance) {
            using InstanceReal = std::remove_reference_t<decltype(instance)>::Real;
            if constexpr (std::is_same_v<InstanceReal, Real>) {
              instance.process(in, out);
            }
          },
          instance_);
    }
    return {out.measured_Nm.give(), out.clean_Nm.give(), out.ripple_Nm.give(), out.status.give()};
  }

  [[nodiscard]] CountsByName counters() const {
    const auto held = calls_.hold();
    return std::visit([](const auto& instance) { return counts_by_name(instance.state.counters); },
                      instance_);
  }

 private:
  using AnyInstance =
      std::variant<Instance<double, 4, 3>, Instance<double, most_gauges, most_orders>,
                   Instance<float, 4, 3>, Instance<float, most_gauges, most_orders>>;

  [[nodiscard]] AnyInstance make() const {
    if (config_.gains.count <= 4 && config_.filter.order_count <= 3) {
      return single_precision_ ? AnyInstance(Instance<float, 4, 3>(config_))
                               : AnyInstance(Instance<double, 4, 3>(config_));
    }
    return single_precision_ ? AnyInstance(Instance<float, most_gauges, most_orders>(config_))
                             : AnyInstance(Instance<double, most_gauges, most_orders>(config_));
  }

  ConfigD config_;
  bool single_precision_;
  CallLock calls_;
  AnyInstance instance_;
};

}  // namespace

void bind_torque_sensor(nb::module_& m) {
  nb::class_<ConfigD>(m, "TorqueSensorConfig", "Configuration of the whole chain.")
      .def(
          "__init__",
          [](ConfigD* self, const Converter<double>& converter, const GainsD& gains,
             const TorqueCalibration<double>& calibration, const OscillatorConfigD& filter) {
            const ConfigD config{converter, gains, calibration, filter};
            require(check(config));
            new (self) ConfigD(config);
          },
          nb::kw_only(), "converter"_a, "gains"_a, "calibration"_a, "filter"_a,
          "One gain per channel; a full bridge is one channel.")
      .def("__repr__",
           [](const nb::handle& self) {
             return repr_of(self, {"converter", "gains", "calibration", "filter"});
           })
      .def_ro("converter", &ConfigD::converter)
      .def_ro("gains", &ConfigD::gains)
      .def_ro("calibration", &ConfigD::calibration)
      .def_ro("filter", &ConfigD::filter);

  nb::class_<Sensor>(m, "TorqueSensor",
                     "Converter codes in, torque with the ripple removed out; process() may be "
                     "called chunk by chunk.")
      .def(nb::init<const ConfigD&, bool>(), "config"_a, nb::kw_only(),
           "single_precision"_a = false)
      .def_prop_ro("config", &Sensor::config)
      .def_prop_ro("single_precision", &Sensor::single_precision)
      .def("reset", &Sensor::reset, "Back to the state at power-up.")
      .def("copy", &Sensor::copy, "An independent sensor in the same state.")
      .def("process_float64", &Sensor::process<double>, "codes"_a.noconvert(),
           "motor_speed_rad_s"_a.noconvert() = nb::none(),
           "motor_angle_rad"_a.noconvert() = nb::none(),
           "expected_torque_Nm"_a.noconvert() = nb::none(),
           "temperature_degC"_a.noconvert() = nb::none(), "sequence"_a.noconvert() = nb::none(),
           "Measured torque, clean torque, ripple and status of contiguous float64 arrays, "
           "without copies.")
      .def("process_float32", &Sensor::process<float>, "codes"_a.noconvert(),
           "motor_speed_rad_s"_a.noconvert() = nb::none(),
           "motor_angle_rad"_a.noconvert() = nb::none(),
           "expected_torque_Nm"_a.noconvert() = nb::none(),
           "temperature_degC"_a.noconvert() = nb::none(), "sequence"_a.noconvert() = nb::none(),
           "The same of contiguous float32 arrays; angles stay float64.")
      .def_prop_ro("counters", &Sensor::counters, "How often each status flag was raised.");
}

}  // namespace strainwave::bindings
