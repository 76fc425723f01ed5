// SPDX-License-Identifier: Apache-2.0
#include "strainwave/torque_sensor.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>

#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "bind_gains.hpp"
#include "bind_gauge_monitor.hpp"
#include "bind_oscillator_filter.hpp"
#include "bind_ripple_filter.hpp"
#include "bind_status.hpp"
#include "strainwave/sample_clock.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

using AnyFilterConfig = std::variant<RippleConfigD, OscillatorConfigD>;

/// The chain's configuration as Python holds it, with either filter.
struct SensorSettings {
  Converter<double> converter;
  GainsD gains;
  TorqueCalibration<double> calibration;
  AnyFilterConfig filter;
  double sample_period_s = RippleSensorConfig<double, 1, 1>{}.sample_period_s;
  MonitorConfigD monitor = {};
};

template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
RippleSensorConfig<Real, MaxGauges, MaxPairs> chain_of(const SensorSettings& settings,
                                                       const RippleConfigD& filter) {
  const RippleSensorConfig<double, most_gauges, most_pairs> config = {
      settings.converter,       settings.gains,  settings.calibration, filter,
      settings.sample_period_s, settings.monitor};
  return converted<Real, MaxGauges, MaxPairs>(config);
}

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
TorqueSensorConfig<Real, MaxGauges, MaxOrders> chain_of(const SensorSettings& settings,
                                                        const OscillatorConfigD& filter) {
  const TorqueSensorConfig<double, most_gauges, most_orders> config = {
      settings.converter, settings.gains, settings.calibration, filter, settings.monitor};
  return converted<Real, MaxGauges, MaxOrders>(config);
}

/// Arrays of one call, already checked for their lengths; an absent one is null.
template <class Real>
struct SensorArrays {
  std::size_t size = 0;
  std::size_t channels = 0;
  const std::int32_t* codes = nullptr;
  RotationArrays<Real> rotation;
  const Real* expected_Nm = nullptr;
  const Real* temperature_degC = nullptr;
  const std::uint32_t* sequence = nullptr;
  const double* time_s = nullptr;
  bool angle_referenced = true;
};

template <class Real>
using GivenToSensor = Given<Real, Real, Real, std::uint32_t, std::uint8_t>;

template <class Real>
struct SensorOutputs {
  FilledVector<Real> measured_Nm;
  FilledVector<Real> clean_Nm;
  FilledVector<Real> ripple_Nm;
  FilledVector<std::uint32_t> status;
  FilledVector<std::uint8_t> left_out_gauge;
  SensorOutputs(const GivenToSensor<Real>& given, std::size_t size)
      : measured_Nm(result_array<0>(given, size)),
        clean_Nm(result_array<1>(given, size)),
        ripple_Nm(result_array<2>(given, size)),
        status(result_array<3>(given, size)),
        left_out_gauge(result_array<4>(given, size)) {}
};

/// The chain's interval of a time stamp: 0 where only the next one will tell, and what the chain
/// refuses where the clock has refused the stamp.
template <class Real>
Real chain_interval_s(const Interval& interval) {
  if (has(interval.status, StatusFlag::time_not_finite)) {
    return std::numeric_limits<Real>::quiet_NaN();
  }
  return has(interval.status, StatusFlag::sample_out_of_order)
             ? Real(-1)
             : static_cast<Real>(interval.interval_s);
}

/// Counts what the clock says and the chain did not.
void count_also(EventCounters& counters, Status by_chain, Status by_clock) {
  const Status said = by_clock & ~by_chain;
  for (std::size_t bit = 0; bit < 32 && said != 0U; ++bit) {
    if ((said >> bit & 1U) != 0U) {
      count_up(counters.by_bit[bit]);
    }
  }
  if ((said & fault_mask) != 0U && (by_chain & fault_mask) == 0U) {
    count_up(counters.faults);
  }
}

/// One sensor of a compiled precision and capacity.
template <class RealT, std::size_t MaxGauges, class FilterConfig>
struct ChainInstance {
  using Real = RealT;
  static constexpr bool by_time =
      requires(TorqueChainConfig<Real, MaxGauges, FilterConfig> any) { any.sample_period_s; };

  TorqueChainConfig<Real, MaxGauges, FilterConfig> config;
  TorqueChainState<Real, MaxGauges, FilterConfig> state;
  SampleClock clock = {};

  explicit ChainInstance(const TorqueChainConfig<Real, MaxGauges, FilterConfig>& of)
      : config(of), state(initial_state(config)) {
    require(check(config));  // what double holds may vanish or overflow in float
  }

  void process(const SensorArrays<Real>& in, SensorOutputs<Real>& out) {
    TorqueSensorSample<MaxGauges, Real> sample;
    sample.temperature_degC = config.calibration.reference_temperature_degC;
    sample.phase_referenced = in.angle_referenced;
    sample.sequence_valid = in.sequence != nullptr;
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
      sample.sequence = sample.sequence_valid ? in.sequence[k] : 0U;
      Interval interval;
      if (by_time && in.time_s != nullptr) {
        interval = take_stamp(clock, in.time_s[k]);
        sample.interval_s = chain_interval_s<Real>(interval);
      }
      const TorqueReading<Real> reading = step(config, state, sample);
      count_also(state.counters, reading.status, interval.status);
      out.measured_Nm.data()[k] = reading.torque_measured_Nm;
      out.clean_Nm.data()[k] = reading.torque_Nm;
      out.ripple_Nm.data()[k] = reading.ripple_Nm;
      out.status.data()[k] = reading.status | interval.status;
      out.left_out_gauge.data()[k] = reading.left_out_gauge;
    }
  }
};

template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
using WithRipple = ChainInstance<Real, MaxGauges, RippleFilterConfig<Real, MaxPairs>>;
template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
using WithOscillator = ChainInstance<Real, MaxGauges, OscillatorFilterConfig<Real, MaxOrders>>;

using AnyInstance =
    std::variant<WithRipple<double, 4, 8>, WithRipple<double, most_gauges, most_pairs>,
                 WithRipple<float, 4, 8>, WithRipple<float, most_gauges, most_pairs>,
                 WithOscillator<double, 4, 3>, WithOscillator<double, most_gauges, most_orders>,
                 WithOscillator<float, 4, 3>, WithOscillator<float, most_gauges, most_orders>>;

template <class Real>
AnyInstance make_instance(const SensorSettings& settings, const RippleConfigD& filter,
                          const std::optional<LearnedD>& kept) {
  const auto started = [&](auto instance) -> AnyInstance {
    if (kept) {
      require(check(filter, *kept));
      constexpr std::size_t pairs = (decltype(instance.state.filter)::max_states - 1) / 2;
      instance.state.filter = restored(instance.config.filter, converted<Real, pairs>(*kept));
    }
    return instance;
  };
  if (settings.gains.count <= 4 && pair_count(filter) <= 8) {
    return started(WithRipple<Real, 4, 8>(chain_of<Real, 4, 8>(settings, filter)));
  }
  return started(WithRipple<Real, most_gauges, most_pairs>(
      chain_of<Real, most_gauges, most_pairs>(settings, filter)));
}

template <class Real>
AnyInstance make_instance(const SensorSettings& settings, const OscillatorConfigD& filter,
                          const std::optional<LearnedD>& kept) {
  if (kept) {
    raise_input_error(
        "learned is given, but the filter is the oscillator filter: expected none, what was "
        "learned belongs to a ripple filter; leave it out");
  }
  if (settings.gains.count <= 4 && filter.order_count <= 3) {
    return WithOscillator<Real, 4, 3>(chain_of<Real, 4, 3>(settings, filter));
  }
  return WithOscillator<Real, most_gauges, most_orders>(
      chain_of<Real, most_gauges, most_orders>(settings, filter));
}

template <class Real>
using SensorResults = std::tuple<VectorOut<Real>, VectorOut<Real>, VectorOut<Real>,
                                 VectorOut<std::uint32_t>, VectorOut<std::uint8_t>>;

class OwnedSensor {  // nanobind tells types apart by name, also in unnamed namespaces
 public:
  OwnedSensor(const SensorSettings& settings, bool single_precision,
              const std::optional<LearnedD>& kept)
      : settings_(settings), single_precision_(single_precision), kept_(kept), instance_(make()) {}

  [[nodiscard]] const SensorSettings& config() const { return settings_; }
  [[nodiscard]] bool single_precision() const { return single_precision_; }
  void reset() {
    calls_.wait();
    instance_ = make();
  }
  [[nodiscard]] OwnedSensor copy() const {
    calls_.wait();
    return *this;
  }

  template <class Real>
  SensorResults<Real> process(const Matrix<std::int32_t>& codes,
                              const std::optional<Vector<Real>>& speed_rad_s,
                              const std::optional<Vector<double>>& angle_rad,
                              const std::optional<Vector<Real>>& expected_Nm,
                              const std::optional<Vector<Real>>& temperature_degC,
                              const std::optional<Vector<std::uint32_t>>& sequence,
                              const std::optional<Vector<double>>& time_s, bool angle_referenced,
                              const GivenToSensor<Real>& given) {
    require_precision<Real>(single_precision_);
    SensorArrays<Real> in;
    in.size = codes.shape(0);
    in.channels = codes.shape(1);
    in.codes = codes.data();
    in.angle_referenced = angle_referenced;
    require_same_length("codes' second axis", in.channels, "the gains", settings_.gains.count);
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
    take("time_s", time_s, in.time_s);
    if (const auto* const oscillator = std::get_if<OscillatorConfigD>(&settings_.filter)) {
      require_rotation(oscillator->rotation_source, speed_rad_s, angle_rad);
    } else if (!angle_rad) {
      raise_input_error(
          "motor_angle_rad is missing: expected it for the ripple filter, which learns by angle; "
          "give the array");
    }
    SensorOutputs<Real> out(given, in.size);
    {
      const CallLock::Long running(calls_);
      std::visit(
          [&](auto& instance) {
            using InstanceReal = std::remove_reference_t<decltype(instance)>::Real;
            if constexpr (std::is_same_v<InstanceReal, Real>) {
              instance.process(in, out);
            }
          },
          instance_);
    }
    return {out.measured_Nm.give(), out.clean_Nm.give(), out.ripple_Nm.give(), out.status.give(),
            out.left_out_gauge.give()};
  }

  [[nodiscard]] LearnedD learned_now() const {
    const auto* const filter = std::get_if<RippleConfigD>(&settings_.filter);
    if (filter == nullptr) {
      raise_input_error(
          "the oscillator filter learns nothing that can be kept: expected a sensor with the "
          "ripple filter; configure it with a RippleFilterConfig");
    }
    calls_.wait();
    return std::visit(
        [&](const auto& instance) {
          if constexpr (std::remove_reference_t<decltype(instance)>::by_time) {
            return converted<double, most_pairs>(
                learned(instance.config.filter, instance.state.filter));
          } else {
            return LearnedD{};  // never: the instance has the filter of the settings
          }
        },
        instance_);
  }

  /// Number and fault of the lost gauge; 0 and none where none is.
  [[nodiscard]] std::pair<unsigned, GaugeFault> lost_gauge() const {
    calls_.wait();
    return std::visit(
        [](const auto& instance) {
          return std::pair{unsigned{instance.state.monitor.lost_gauge},
                           instance.state.monitor.fault};
        },
        instance_);
  }
  void forget_lost_gauge() {
    calls_.wait();
    std::visit([](auto& instance) { clear_lost_gauge(instance.state.monitor); }, instance_);
  }
  [[nodiscard]] double residual_fluctuation_Nm() const {
    calls_.wait();
    return std::visit(
        [](const auto& instance) {
          return static_cast<double>(instance.state.last_reading.residual_fluctuation_Nm);
        },
        instance_);
  }

  [[nodiscard]] CountsByName counters() const {
    calls_.wait();
    return counts_by_name(
        std::visit([](const auto& instance) { return instance.state.counters; }, instance_));
  }

 private:
  [[nodiscard]] AnyInstance make() const {
    return std::visit(
        [this](const auto& filter) {
          return single_precision_ ? make_instance<float>(settings_, filter, kept_)
                                   : make_instance<double>(settings_, filter, kept_);
        },
        settings_.filter);
  }

  SensorSettings settings_;
  bool single_precision_;
  std::optional<LearnedD> kept_;
  CallLock calls_;
  AnyInstance instance_;
};

SensorSettings make_settings(const Converter<double>& converter, const GainsD& gains,
                             const TorqueCalibration<double>& calibration,
                             const AnyFilterConfig& filter,
                             const std::optional<double>& sample_period_s,
                             const std::optional<MonitorConfigD>& monitor) {
  SensorSettings settings = {converter, gains, calibration, filter};
  settings.monitor = monitor.value_or(MonitorConfigD{});
  if (monitor) {  // entries beyond the gauges would be left unseen
    for (std::size_t j = gains.count; j < most_gauges; ++j) {
      if (monitor->without[j].available) {
        require(Violation<double>{"without", static_cast<std::int32_t>(j),
                                  static_cast<double>(j + 1), "", "a gauge that has a gain"});
      }
    }
  }
  if (const auto* const ripple = std::get_if<RippleConfigD>(&filter)) {
    settings.sample_period_s = sample_period_s.value_or(settings.sample_period_s);
    require(check(chain_of<double, most_gauges, most_pairs>(settings, *ripple)));
    return settings;
  }
  const auto& oscillator = std::get<OscillatorConfigD>(filter);
  settings.sample_period_s = oscillator.sample_period_s;
  require(check(chain_of<double, most_gauges, most_orders>(settings, oscillator)));
  if (sample_period_s && *sample_period_s != oscillator.sample_period_s) {
    require(Violation<double>{"sample_period_s", -1, *sample_period_s, "s",
                              "that of the oscillator filter, or none"});
  }
  return settings;
}

}  // namespace

void bind_torque_sensor(nb::module_& m) {
  nb::class_<SensorSettings>(m, "TorqueSensorConfig", "Configuration of the whole chain.")
      .def(
          "__init__",
          [](SensorSettings* self, const Converter<double>& converter, const GainsD& gains,
             const TorqueCalibration<double>& calibration, const AnyFilterConfig& filter,
             const std::optional<double>& sample_period_s,
             const std::optional<MonitorConfigD>& monitor) {
            new (self) SensorSettings(
                make_settings(converter, gains, calibration, filter, sample_period_s, monitor));
          },
          nb::kw_only(), "converter"_a, "gains"_a, "calibration"_a, "filter"_a,
          "sample_period_s"_a = nb::none(), "monitor"_a = nb::none(),
          "One gain per channel; a full bridge is one channel. filter: the ripple filter's, "
          "strainwave's default, or the oscillator filter's. sample_period_s: time from one sample "
          "to the next where a call gives no times; without, 1 ms, or the oscillator filter's own. "
          "monitor: the watch over the gauges; none without.")
      .def("__repr__",
           [](const nb::handle& self) {
             return repr_of(self, {"converter", "gains", "calibration", "filter", "sample_period_s",
                                   "monitor"});
           })
      .def_ro("converter", &SensorSettings::converter)
      .def_ro("gains", &SensorSettings::gains)
      .def_ro("calibration", &SensorSettings::calibration)
      .def_ro("filter", &SensorSettings::filter)
      .def_ro("sample_period_s", &SensorSettings::sample_period_s)
      .def_prop_ro("monitor", [](const SensorSettings& self) {
        return self.monitor.active ? std::optional(self.monitor) : std::nullopt;
      });

  nb::class_<OwnedSensor> sensor(m, "TorqueSensor",
                                 "Converter codes in, torque with the ripple removed out; "
                                 "process() may be called chunk by chunk.");
  sensor
      .def(nb::init<const SensorSettings&, bool, const std::optional<LearnedD>&>(), "config"_a,
           nb::kw_only(), "single_precision"_a = false, "learned"_a = nb::none(),
           "learned: coefficients for the ripple filter to start with.")
      .def_prop_ro("config", &OwnedSensor::config)
      .def_prop_ro("single_precision", &OwnedSensor::single_precision)
      .def("reset", &OwnedSensor::reset, "Back to the state at power-up.")
      .def("copy", &OwnedSensor::copy, "An independent sensor in the same state.")
      .def("learned", &OwnedSensor::learned_now, "The ripple filter's coefficients now.")
      .def_prop_ro("lost_gauge", &OwnedSensor::lost_gauge,
                   "Number, from 1, and fault of the lost gauge; 0 and none where none is.")
      .def("clear_lost_gauge", &OwnedSensor::forget_lost_gauge,
           "Forget the loss: the gauge was repaired.")
      .def_prop_ro("residual_fluctuation_Nm", &OwnedSensor::residual_fluctuation_Nm,
                   "rms of the fluctuation that the gains in use leave, as the monitor was told.")
      .def_prop_ro("counters", &OwnedSensor::counters, "How often each status flag was raised.");
  const auto bind_process = [&sensor](const char* name, auto process, const char* words) {
    sensor.def(name, process, "codes"_a.noconvert(), "motor_speed_rad_s"_a.noconvert() = nb::none(),
               "motor_angle_rad"_a.noconvert() = nb::none(),
               "expected_torque_Nm"_a.noconvert() = nb::none(),
               "temperature_degC"_a.noconvert() = nb::none(), "sequence"_a.noconvert() = nb::none(),
               "time_s"_a.noconvert() = nb::none(), "angle_referenced"_a = true,
               "out"_a.noconvert() = nb::none(), words);
  };
  bind_process(
      "process_float64", &OwnedSensor::process<double>,
      "Measured and clean torque, ripple, status and left-out gauge of contiguous float64 arrays, "
      "without copies.");
  bind_process("process_float32", &OwnedSensor::process<float>,
               "The same of contiguous float32 arrays; angles and times stay float64.");
}

}  // namespace strainwave::bindings
