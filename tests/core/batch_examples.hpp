// Channels of every kind for the tests of batches: joints that differ, speeds, faults.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "oscillator_examples.hpp"
#include "strainwave/batch.hpp"

inline constexpr std::size_t batch_orders = 12;

template <class Real>
using BatchConfig = strainwave::OscillatorFilterConfig<Real, batch_orders>;
template <class Real>
using BatchState = strainwave::OscillatorFilterState<Real, batch_orders>;

/// Numbers from 0 to 1, the same on every platform.
class Noise {
 public:
  explicit Noise(std::uint32_t seed) : random_(seed * 2654435761U + 1U) {}
  double next() {
    random_ = random_ * 1664525U + 1013904223U;
    return static_cast<double>(random_ >> 8U) / 16777216.0;
  }

 private:
  std::uint32_t random_;
};

/// A joint that no other number has: orders 2 and 4, with 1/ratio, without a double, one, five and
/// ten orders; published and protected tunings.
template <class Real>
BatchConfig<Real> joint(std::size_t number) {
  BatchConfig<Real> config;
  switch (number % 6) {
    case 0:
      config = strainwave::taghirad1999<Real, batch_orders>(
          {static_cast<std::uint32_t>(100 + number), 1});
      break;
    case 1:
      config = tuned<Real, batch_orders>(3);
      config.orders[2] = {2, static_cast<std::uint32_t>(161 + number)};
      break;
    case 2:
      config = tuned<Real, batch_orders>(2);
      config.orders[1] = {7, 2};
      break;
    case 3:
      config = tuned<Real, batch_orders>(1);
      break;
    case 4:
      config = tuned<Real, batch_orders>(5);
      break;
    default:
      config = tuned<Real, batch_orders>(8);
      config.order_count = 10;
      config.orders[8] = {9, 1};
      config.orders[9] = {5, 3};
      config.process_noise_variance_Nm2[8] = config.process_noise_variance_Nm2[9] = Real(1e-4);
  }
  config.measurement_noise_variance_Nm2 *= static_cast<Real>(1.0 + 0.03 * double(number));
  config.sample_period_s = static_cast<Real>(1e-3 * (1.0 + 0.01 * double(number % 7)));
  return config;
}

/// A channel's recording and what a filter makes of it.
template <class Real>
struct Log {
  std::vector<Real> torque_Nm;
  std::vector<Real> speed_rad_s;
  std::vector<Real> expected_Nm;
  std::vector<Real> clean_Nm;
  std::vector<Real> ripple_Nm;
  std::vector<strainwave::Status> status;

  [[nodiscard]] strainwave::OscillatorChannel<Real> channel(std::size_t start, std::size_t end) {
    strainwave::OscillatorChannel<Real> channel;
    channel.sample_count = end - start;
    channel.measured_torque_Nm = torque_Nm.data() + start;
    channel.motor_speed_rad_s = speed_rad_s.data() + start;
    channel.expected_torque_Nm = expected_Nm.empty() ? nullptr : expected_Nm.data() + start;
    channel.torque_Nm = clean_Nm.data() + start;
    channel.ripple_Nm = ripple_Nm.data() + start;
    channel.status = status.data() + start;
    return channel;
  }
  [[nodiscard]] strainwave::OscillatorChannel<Real> channel() {
    return channel(0, torque_Nm.size());
  }
};

/// Ripple, load and noise of a joint that reverses, rests and creeps.
template <class Real>
Log<Real> quiet_log(std::size_t number, std::size_t samples) {
  Log<Real> log;
  log.torque_Nm.resize(samples);
  log.speed_rad_s.resize(samples);
  log.clean_Nm.assign(samples, Real(-99));
  log.ripple_Nm.assign(samples, Real(-99));
  log.status.assign(samples, 0xFFFFFFFFU);
  Noise noise(static_cast<std::uint32_t>(number));
  double angle_rad = 0.0;
  for (std::size_t k = 0; k < samples; ++k) {
    const double phase = 0.002 * static_cast<double>(k) + static_cast<double>(number);
    double speed_rad_s = 40.0 + 120.0 * std::sin(phase);
    if (number % 4 == 1 && k % 1024 > 700) {
      speed_rad_s = k % 2048 < 1024 ? 0.0 : 0.7;
    }
    log.speed_rad_s[k] = static_cast<Real>(speed_rad_s);
    log.torque_Nm[k] = static_cast<Real>(
        3.0 * std::cos(2 * angle_rad + 0.3) + std::sin(4 * angle_rad) +
        5.0 * std::sin(0.01 * angle_rad) + std::sin(0.7 * phase) + 0.1 * noise.next());
    angle_rad += speed_rad_s * 1e-3;
  }
  return log;
}

/// The same with everything in it that a filter has to refuse or to flag.
template <class Real>
Log<Real> wild_log(std::size_t number, std::size_t samples) {
  using Limits = std::numeric_limits<Real>;
  const Real wild[] = {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(),
                       Limits::max(),       Real(1e16),         Real(-1e30)};
  Log<Real> log = quiet_log<Real>(number, samples);
  if (number % 3 != 0) {
    log.expected_Nm.assign(samples, Real(0));
  }
  Noise noise(static_cast<std::uint32_t>(number) + 1000U);
  for (std::size_t k = 0; k < samples; ++k) {
    const Real value = wild[static_cast<std::size_t>(noise.next() * 6.0)];
    const double what = noise.next();
    if (what < 0.01) {
      log.torque_Nm[k] = value;
    } else if (what < 0.02) {
      log.speed_rad_s[k] = value;
    } else if (what < 0.025) {
      log.speed_rad_s[k] = static_cast<Real>(900.0 + 300.0 * noise.next());  // above Nyquist
    } else if (what < 0.03 && !log.expected_Nm.empty()) {
      log.expected_Nm[k] = value;
    }
  }
  for (std::size_t k = samples / 2; k < samples / 2 + 40 && k < samples; ++k) {
    log.torque_Nm[k] = Limits::quiet_NaN();  // a cable that is out for a while
  }
  return log;
}

/// Vector levels that this machine can run; one by one is what they are held against.
inline std::vector<strainwave::VectorLevel> vector_levels() {
  using strainwave::VectorLevel;
  std::vector<VectorLevel> levels;
  for (const VectorLevel level : {VectorLevel::portable, VectorLevel::x86_64_v2,
                                  VectorLevel::x86_64_v3, VectorLevel::x86_64_v4}) {
    if (strainwave::is_available(level)) {
      levels.push_back(level);
    }
  }
  return levels;
}
