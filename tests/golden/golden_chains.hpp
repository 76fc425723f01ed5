// The five chains of the golden vectors, in float or double; freestanding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "golden_inputs.hpp"
#include "strainwave/oscillator_filter.hpp"
#include "strainwave/ripple_filter.hpp"
#include "strainwave/sample_clock.hpp"
#include "strainwave/torque_sensor.hpp"

namespace golden {

template <class Real>
struct Answer {
  Real torque_Nm;
  Real ripple_Nm;
  strainwave::Status status;
};

[[nodiscard]] constexpr std::uint32_t bits_of(float value) {
  return __builtin_bit_cast(std::uint32_t, value);
}
[[nodiscard]] constexpr std::uint64_t bits_of(double value) {
  return __builtin_bit_cast(std::uint64_t, value);
}

template <class Real>
constexpr void add(Checksum& checksum, const Answer<Real>& answer) {
  checksum.add(bits_of(answer.torque_Nm));
  checksum.add(bits_of(answer.ripple_Nm));
  checksum.add(answer.status);
}

/// What a code stands for; exact, because steps are powers of two and codes below 2^24.
template <class Real>
[[nodiscard]] constexpr Real number(std::int64_t code, std::int32_t codes_a_unit) {
  if (code == nan_code) {
    return std::numeric_limits<Real>::quiet_NaN();
  }
  if (code == infinity_code) {
    return std::numeric_limits<Real>::infinity();
  }
  return static_cast<Real>(static_cast<std::int32_t>(code)) / static_cast<Real>(codes_a_unit);
}

/// Encoder and clock of a sample, as a firmware or the Python package takes them.
class Shaft {
 public:
  constexpr void take(const RawSample& raw) {
    phase = strainwave::phase_from_counts(counter_.update(raw.encoder), 65536);
    interval = strainwave::take_stamp(clock_, static_cast<double>(raw.ticks) * 0x1p-20);
  }

  strainwave::Phase phase;
  strainwave::Interval interval;

 private:
  strainwave::EncoderCounter counter_;
  strainwave::SampleClock clock_;
};

template <class Real, std::size_t MaxOrders>
class Published {
 public:
  using Config = strainwave::OscillatorFilterConfig<Real, MaxOrders>;
  explicit Published(const Config& config)
      : config_(config), state_(strainwave::initial_state(config_)) {}

  Answer<Real> take(const RawSample& raw) {
    strainwave::OscillatorSample<Real> sample;
    sample.measured_torque_Nm = number<Real>(raw.torque, 4096);
    sample.expected_torque_Nm = number<Real>(raw.expected, 4096);
    sample.motor_speed_rad_s = number<Real>(raw.speed, 64);
    const auto reading = step(config_, state_, sample);
    return {reading.torque_Nm, reading.ripple_Nm, reading.status};
  }

 private:
  Config config_;
  strainwave::OscillatorFilterState<Real, MaxOrders> state_;
};

template <class Real, std::size_t MaxPairs>
[[nodiscard]] strainwave::RippleFilterConfig<Real, MaxPairs> ripple_config(bool with_load,
                                                                           bool with_speed,
                                                                           bool with_direction) {
  strainwave::RippleFilterConfig<Real, MaxPairs> config;
  config.order_count = sizeof(orders) / sizeof(orders[0]);
  for (std::size_t a = 0; a < config.order_count; ++a) {
    config.orders[a] = {{orders[a], 1}, with_load, with_speed, with_direction, false};
  }
  return config;
}

template <class Real, std::size_t MaxPairs>
class Ripple {
 public:
  using Config = strainwave::RippleFilterConfig<Real, MaxPairs>;
  explicit Ripple(const Config& config)
      : config_(config), state_(strainwave::initial_state(config_)) {}

  Answer<Real> take(const RawSample& raw) {
    shaft_.take(raw);
    strainwave::RippleSample<Real> sample;
    sample.interval_s = static_cast<Real>(shaft_.interval.interval_s);
    sample.measured_torque_Nm = number<Real>(raw.torque, 4096);
    sample.expected_torque_Nm = number<Real>(raw.expected, 4096);
    sample.phase_valid = raw.angle_known;
    sample.motor_phase = shaft_.phase;
    const auto reading = step(config_, state_, sample);
    return {reading.torque_Nm, reading.ripple_Nm, reading.status | shaft_.interval.status};
  }

 private:
  Config config_;
  strainwave::RippleFilterState<Real, MaxPairs> state_;
  Shaft shaft_;
};

template <class Real>
class Chain {
 public:
  using Double = strainwave::RippleSensorConfig<double, gauge_count, 9>;
  using Config = strainwave::RippleSensorConfig<Real, gauge_count, 9>;
  Chain()
      : config_(strainwave::converted<Real, gauge_count, 9>(told())),
        state_(strainwave::initial_state(config_)) {}

  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const strainwave::RippleSensorState<Real, gauge_count, 9>& state() const {
    return state_;
  }
  [[nodiscard]] static Double told() {
    auto config = sensor_config<Double>();
    config.filter = ripple_config<double, 9>(true, true, false);
    return config;
  }
  Answer<Real> take(const RawSample& raw) {
    shaft_.take(raw);
    strainwave::TorqueSensorSample<gauge_count, Real> sample;
    for (std::size_t j = 0; j < gauge_count; ++j) {
      sample.codes[j] = {static_cast<std::int32_t>(raw.gauges[j])};
    }
    sample.expected_torque_Nm = number<Real>(raw.expected, 4096);
    sample.temperature_degC = number<Real>(raw.temperature, 256);
    sample.sequence = raw.sequence;
    sample.phase_valid = raw.angle_known;
    sample.motor_phase = shaft_.phase;
    // What the clock has refused the chain shall refuse as well.
    sample.interval_s = has(shaft_.interval.status, strainwave::StatusFlag::sample_out_of_order)
                            ? Real(-1)
                            : static_cast<Real>(shaft_.interval.interval_s);
    const auto reading = step(config_, state_, sample);
    return {reading.torque_Nm, reading.ripple_Nm, reading.status | shaft_.interval.status};
  }

 private:
  Config config_;
  strainwave::RippleSensorState<Real, gauge_count, 9> state_;
  Shaft shaft_;
};

/// Hands every chain to a visitor, with its golden answers and in the order of the file.
template <class Real, class Visitor>
void for_each_chain(Visitor&& visit) {
  using strainwave::taghirad1999;
  using strainwave::taghirad1999_4;
  visit(published_4, Published<Real, 2>(taghirad1999_4<Real, 2>()));
  visit(published_6, Published<Real, 3>(taghirad1999<Real, 3>({100, 1})));
  visit(default_3_orders, Ripple<Real, 3>(ripple_config<Real, 3>(false, false, false)));
  visit(default_3_orders_load_speed_direction,
        Ripple<Real, 12>(ripple_config<Real, 12>(true, true, true)));
  visit(chain_4_gauges, Chain<Real>());
}

}  // namespace golden
