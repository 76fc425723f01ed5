#include "strainwave/tracking_notch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace {

using strainwave::has;
using strainwave::phase_from_radians;
using strainwave::StatusFlag;
using strainwave::TrackingNotchConfig;
using strainwave::TrackingNotchSample;
using strainwave::TrackingNotchState;

constexpr double sample_period_s = 1e-3;

template <class Real>
TrackingNotchConfig<Real, 3> notch_at(std::vector<strainwave::Order> orders, double bandwidth_Hz) {
  TrackingNotchConfig<Real, 3> config;
  config.order_count = orders.size();
  std::copy(orders.begin(), orders.end(), config.orders);
  config.bandwidth_Hz = static_cast<Real>(bandwidth_Hz);
  EXPECT_TRUE(check(config).ok());
  return config;
}

/// A notch with its state, fed with doubles.
template <class Real>
struct Driven {
  TrackingNotchConfig<Real, 3> config;
  TrackingNotchState<Real, 3> state = strainwave::initial_state(config);

  strainwave::TrackingNotchReading<Real> at(double angle_rad, double torque_Nm) {
    TrackingNotchSample<Real> sample;
    sample.measured_torque_Nm = static_cast<Real>(torque_Nm);
    sample.motor_phase = phase_from_radians(angle_rad);
    return strainwave::step(config, state, sample);
  }
};

/// The notch at constant speed: its impulse response, from the first sample with a known speed.
class Response {
 public:
  Response(double speed_rad_s, double bandwidth_Hz) {
    Driven<double> run{notch_at<double>({{2, 1}}, bandwidth_Hz)};
    const double step_rad = speed_rad_s * sample_period_s;
    (void)run.at(0.0, 0.0);
    for (int k = 1; k <= 8000; ++k) {
      impulse_.push_back(run.at(k * step_rad, k == 1 ? 1.0 : 0.0).torque_Nm);
    }
  }
  [[nodiscard]] std::complex<double> at(double angle_rad) const {
    std::complex<double> sum = 0.0;
    for (std::size_t k = 0; k < impulse_.size(); ++k) {
      sum += impulse_[k] * std::polar(1.0, -angle_rad * static_cast<double>(k));
    }
    return sum;
  }
  [[nodiscard]] double gain(double angle_rad) const { return std::abs(at(angle_rad)); }

 private:
  std::vector<double> impulse_;
};

constexpr double angle_of(double frequency_Hz) {
  return 2 * std::numbers::pi * frequency_Hz * sample_period_s;
}

TEST(TrackingNotch, RemovesItsCentreAndLeavesTheRest) {
  for (const double centre_Hz : {12.0, 47.0, 210.0, 420.0}) {
    const Response notch(std::numbers::pi * centre_Hz, 4.0);  // order 2: centre = speed / pi
    EXPECT_LT(notch.gain(angle_of(centre_Hz)), 1e-6) << centre_Hz;
    EXPECT_NEAR(notch.gain(0.0), 1.0, 1e-9);
    EXPECT_NEAR(notch.gain(std::numbers::pi), 1.0, 1e-9);
    // |H|^2 = 1 / (1 + beta^2 x^2), x = sin w / (cos w - cos w0)
    const double beta = std::tan(angle_of(4.0) / 2);
    for (const double frequency_Hz : {1.0, 5.0, 30.0, 100.0, 333.0, 480.0}) {
      const double w = angle_of(frequency_Hz);
      const double x = std::sin(w) / (std::cos(w) - std::cos(angle_of(centre_Hz)));
      const std::complex<double> expected = 1.0 / std::complex<double>(1.0, beta * x);
      EXPECT_LT(std::abs(notch.at(w) - expected), 1e-6) << centre_Hz << " " << frequency_Hz;
    }
  }
}

TEST(TrackingNotch, WidthBetweenHalfPowersIsTheBandwidth) {
  const double half_power = std::sqrt(0.5);
  for (const double bandwidth_Hz : {1.0, 4.0, 15.0}) {
    const Response notch(std::numbers::pi * 47.0, bandwidth_Hz);
    const auto edge_Hz = [&](double inside_Hz, double outside_Hz) {
      for (int i = 0; i < 40; ++i) {
        const double middle_Hz = 0.5 * (inside_Hz + outside_Hz);
        (notch.gain(angle_of(middle_Hz)) < half_power ? inside_Hz : outside_Hz) = middle_Hz;
      }
      return inside_Hz;
    };
    EXPECT_NEAR(edge_Hz(47.0, 90.0) - edge_Hz(47.0, 20.0), bandwidth_Hz, 1e-5 * bandwidth_Hz);
  }
}

TEST(TrackingNotch, GroupDelayIsTheFormulas) {
  const double bandwidth_Hz = 4.0;
  const Response notch(std::numbers::pi * 47.0, bandwidth_Hz);
  const double beta = std::tan(angle_of(bandwidth_Hz) / 2);
  const double cosine0 = std::cos(angle_of(47.0));
  for (const double frequency_Hz : {1.0, 10.0, 20.0, 44.0, 46.5, 60.0, 200.0}) {
    const double w = angle_of(frequency_Hz);
    constexpr double h = 1e-5;
    const double measured = -std::arg(notch.at(w + h) / notch.at(w - h)) / (2 * h);
    const double difference = std::cos(w) - cosine0;
    const double expected = beta * (1 - std::cos(w) * cosine0) /
                            (difference * difference + std::pow(beta * std::sin(w), 2));
    EXPECT_NEAR(measured, expected, 1e-5 * expected + 1e-7) << frequency_Hz;
  }
}

/// A speed that no motor has: it jumps at random between +-900 rad/s every few samples.
struct WildMotion {
  std::uint32_t random = 7;
  double angle_rad = 0.0;
  double speed_rad_s = 0.0;

  double draw() {
    random = random * 1664525U + 1013904223U;
    return random * 0x1p-31 - 1.0;
  }
  double next() {
    if (draw() > 0.6) {
      speed_rad_s = 900.0 * draw();
    }
    angle_rad += speed_rad_s * sample_period_s;
    return angle_rad;
  }
};

template <class Real>
class TrackingNotchOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(TrackingNotchOf, Precisions);

TYPED_TEST(TrackingNotchOf, NoSpeedMakesEnergy) {
  // One step is orthogonal: output and state hold at any time at most what came in.
  using Real = TypeParam;
  Driven<Real> run{notch_at<Real>({{2, 1}, {4, 1}, {7, 2}}, 20.0)};
  WildMotion motion;
  double energy_in = 0.0;
  double energy_out = 0.0;
  for (int k = 0; k < 200'000; ++k) {
    const double torque_Nm =
        k < 150'000 ? 3.0 * motion.draw() + (k % 5000 < 2500 ? 5.0 : 0.0) : 0.0;
    const auto reading = run.at(motion.next(), torque_Nm);
    energy_in += torque_Nm * torque_Nm;
    energy_out += static_cast<double>(reading.torque_Nm) * static_cast<double>(reading.torque_Nm);
    ASSERT_LE(energy_out, energy_in * (1 + 1e-4)) << k;
  }
  EXPECT_GT(energy_out, 0.5 * energy_in);  // and it is no dead wire
  for (std::size_t a = 0; a < 3; ++a) {    // 50 s without torque: what was learned has left
    EXPECT_LT(std::fabs(static_cast<double>(run.state.second_Nm[a])), 1e-3);
  }
}

TYPED_TEST(TrackingNotchOf, FollowsTheMotorThroughAReversal) {
  // Ripple is a function of the angle.  The pair turns back with the motor, so that nothing has to
  // be learned again but what the fade around zero speed let pass.
  using Real = TypeParam;
  Driven<Real> run{notch_at<Real>({{2, 1}, {4, 1}}, 1.0)};
  double before = 0.0;
  double after = 0.0;
  double angle_rad = 0.0;
  for (int k = 0; k < 12'000; ++k) {
    const double speed_rad_s = k < 8000 ? 80.0 : std::max(-80.0, 80.0 - 0.4 * (k - 8000));
    angle_rad += speed_rad_s * sample_period_s;
    const auto reading =
        run.at(angle_rad, 2 * std::cos(2 * angle_rad + 0.4) + std::sin(4 * angle_rad));
    double* const worst = k > 6000 && k <= 8000 ? &before : &after;
    if ((k > 6000 && k <= 8000) || (k >= 8300 && k < 8400)) {
      *worst = std::fmax(*worst, std::fabs(static_cast<double>(reading.torque_Nm)));
    }
  }
  EXPECT_LT(before, 5e-5);
  // One that has to start again removes nothing yet: it leaves 3 Nm.
  EXPECT_LT(after, 0.3);
}

TYPED_TEST(TrackingNotchOf, StandstillPassesTheTorqueBitExact) {
  using Real = TypeParam;
  Driven<Real> run{notch_at<Real>({{2, 1}, {4, 1}, {1, 100}}, 1.0)};
  for (int k = 0; k < 3000; ++k) {
    const double torque_Nm = k < 1000 ? 0.3 : 10.1 + 1e-3 * (k % 13);
    // An encoder of 4096 counts that dithers between two of them.
    const auto reading = run.at(k % 2 * 2 * std::numbers::pi / 4096, torque_Nm);
    ASSERT_EQ(reading.torque_Nm, static_cast<Real>(torque_Nm));
    ASSERT_EQ(reading.ripple_Nm, Real(0));
    ASSERT_EQ(reading.status, 0U);
  }
}

TYPED_TEST(TrackingNotchOf, FadesInAndOutWithoutAStep) {
  // From rest to a speed at which order 4 is above Nyquist, and back: no sample changes what is
  // removed by more than the notch and the ripple themselves can, order x rotation x amplitude.
  using Real = TypeParam;
  Driven<Real> run{notch_at<Real>({{4, 1}}, 1.0)};
  double angle_rad = 0.0;
  double last_ripple_Nm = 0.0;
  bool was_above = false;
  bool was_open = false;
  for (int k = 0; k < 40'000; ++k) {
    const double speed_rad_s = 850.0 * (0.5 - 0.5 * std::cos(k * std::numbers::pi / 20'000));
    angle_rad += speed_rad_s * sample_period_s;
    const auto reading = run.at(angle_rad, 2.0 * std::cos(4 * angle_rad));
    const auto ripple_Nm = static_cast<double>(reading.ripple_Nm);
    const double rotation_rad = 4 * speed_rad_s * sample_period_s;
    const double largest = 2.2 * std::fmin(2.0, rotation_rad) + 0.03;
    ASSERT_LT(std::fabs(ripple_Nm - last_ripple_Nm), largest) << k;
    ASSERT_EQ(has(reading.status, StatusFlag::order_above_nyquist), rotation_rad > std::numbers::pi)
        << k;
    if (rotation_rad > std::numbers::pi) {
      was_above = true;
      ASSERT_EQ(ripple_Nm, 0.0);
    }
    was_open = was_open || std::fabs(ripple_Nm) > 1.9;
    last_ripple_Nm = ripple_Nm;
  }
  EXPECT_TRUE(was_above);
  EXPECT_TRUE(was_open);
}

TYPED_TEST(TrackingNotchOf, WildSamplesAreFlaggedAndForgotten) {
  using Real = TypeParam;
  using Limits = std::numeric_limits<Real>;
  const Real wild[] = {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(),
                       Limits::max(),       Real(1e30),         Real(-1e16)};
  const auto config = notch_at<Real>({{2, 1}, {4, 1}}, 1.0);
  auto state = strainwave::initial_state(config);
  Real last_Nm = 0;
  for (int k = 0; k < 12'000; ++k) {
    TrackingNotchSample<Real> sample;
    sample.measured_torque_Nm = static_cast<Real>(2 * std::cos(2 * 0.15 * k));
    sample.motor_phase = phase_from_radians(0.15 * k);
    const bool is_bad = k >= 6000 && k < 7000 && k % 5 == 0;
    const bool is_lost = k >= 8000 && k < 8100;
    if (is_bad) {
      sample.measured_torque_Nm = wild[(k / 5) % 6];
    }
    if (is_lost) {
      sample.phase_valid = false;
      sample.motor_phase = {12345, 678};
    }
    const auto reading = strainwave::step(config, state, sample);
    ASSERT_EQ(has(reading.status, StatusFlag::torque_not_finite), is_bad) << k;
    ASSERT_EQ(has(reading.status, StatusFlag::rotation_invalid), is_lost) << k;
    ASSERT_TRUE(strainwave::is_finite(reading.torque_Nm) &&
                strainwave::is_finite(reading.ripple_Nm));
    if (is_bad) {
      ASSERT_EQ(reading.torque_Nm, last_Nm);
    }
    if (k > 5000) {
      ASSERT_NEAR(reading.torque_Nm, Real(0), Real(1e-4)) << k;
    }
    last_Nm = reading.torque_Nm;
  }
  EXPECT_EQ(state.counters.samples, 12'000U);
  EXPECT_EQ(state.counters.faults, 300U);
}

TYPED_TEST(TrackingNotchOf, SurvivesAnyPhase) {
  using Real = TypeParam;
  const auto config = notch_at<Real>({{1000, 1}, {4, 1}, {1, 161}}, 1.0);
  auto state = strainwave::initial_state(config);
  std::uint64_t random = 1;
  for (int k = 0; k < 5000; ++k) {
    random = random * 6364136223846793005U + 1442695040888963407U;
    TrackingNotchSample<Real> sample;
    sample.measured_torque_Nm = Real(1);
    sample.motor_phase = {static_cast<std::int64_t>(random),
                          static_cast<std::uint32_t>(random >> 7U)};
    ASSERT_LT(std::fabs(strainwave::step(config, state, sample).torque_Nm), Real(100));
  }
}

TEST(TrackingNotch, FloatIsDouble) {
  Driven<float> single{notch_at<float>({{2, 1}, {4, 1}}, 1.0)};
  Driven<double> twice{notch_at<double>({{2, 1}, {4, 1}}, 1.0)};
  double worst = 0.0;
  for (int k = 0; k < 60'000; ++k) {
    const double angle_rad = 300.0 * (1 - std::cos(5e-4 * k));
    const auto torque_Nm = static_cast<float>(5 * std::sin(2e-3 * k) + 2 * std::cos(2 * angle_rad));
    const float a = single.at(angle_rad, torque_Nm).torque_Nm;
    const double b = twice.at(angle_rad, torque_Nm).torque_Nm;
    worst = std::fmax(worst, std::fabs(static_cast<double>(a) - b));
  }
  EXPECT_LT(worst, 1e-4);
  EXPECT_GT(worst, 0.0);
}

TYPED_TEST(TrackingNotchOf, CapacityMakesNoDifference) {
  using Real = TypeParam;
  const auto small = notch_at<Real>({{2, 1}, {4, 1}}, 2.0);
  const auto large = strainwave::converted<Real, 32>(small);
  auto small_state = strainwave::initial_state(small);
  auto large_state = strainwave::initial_state(large);
  WildMotion motion;
  for (int k = 0; k < 3000; ++k) {
    TrackingNotchSample<Real> sample;
    sample.motor_phase = phase_from_radians(motion.next());
    sample.measured_torque_Nm = static_cast<Real>(motion.draw());
    ASSERT_EQ(strainwave::step(small, small_state, sample).torque_Nm,
              strainwave::step(large, large_state, sample).torque_Nm);
  }
}

TEST(TrackingNotch, CheckNamesWhatIsWrong) {
  constexpr TrackingNotchConfig<float, 2> standard;
  static_assert(check(standard).ok());
  const auto refused = [](auto change) {
    TrackingNotchConfig<double, 2> config;
    change(config);
    const auto violation = check(config);
    return std::string(violation.ok() ? "nothing" : violation.parameter);
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bandwidth_Hz : {0.0, -1.0, 126.0, 9e-4, nan}) {
    EXPECT_EQ(refused([&](auto& config) { config.bandwidth_Hz = bandwidth_Hz; }), "bandwidth_Hz");
  }
  for (const double period_s : {0.0, -1e-3, 2e3, nan}) {
    EXPECT_EQ(refused([&](auto& config) { config.sample_period_s = period_s; }), "sample_period_s");
  }
  EXPECT_EQ(refused([](auto& config) { config.order_count = 0; }), "orders");
  EXPECT_EQ(refused([](auto& config) { config.order_count = 3; }), "orders");
  EXPECT_EQ(refused([](auto& config) { config.orders[0] = {0, 1}; }), "orders");
  EXPECT_EQ(refused([](auto& config) {
              config.order_count = 2;
              config.orders[1] = config.orders[0];
            }),
            "orders");
}

}  // namespace
