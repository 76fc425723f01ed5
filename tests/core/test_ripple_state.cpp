// One prediction and one update at a time, against the same written with full matrices.
#include "strainwave/ripple_state.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "ripple_examples.hpp"

namespace {

constexpr std::size_t n = 5;  // T and two pairs
using Matrix = std::array<std::array<double, n>, n>;
using Vector = std::array<double, n>;
template <class Real>
using Regressors = strainwave::detail::Regressors<Real, 2>;

/// A covariance with every element taken, and regressors.
Matrix example_covariance() {
  Matrix p{};
  Random random(5);
  for (auto& row : p) {
    for (double& element : row) {
      element = random.uniform();
    }
  }
  Matrix square{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < n; ++k) {
        square[i][j] += 0.1 * p[i][k] * p[j][k];
      }
    }
    square[i][i] += 0.05;
  }
  return square;
}

constexpr Vector example_h = {1.0, 0.6, 0.8, -0.28, 0.96};
constexpr Vector example_x = {3.0, 1.5, -0.5, 0.2, 0.1};

template <class Real>
struct Setup {
  strainwave::RippleFilterConfig<Real, 2> config = two_orders<Real, 2>();
  strainwave::RippleFilterState<Real, 2> state = strainwave::initial_state(config);
  Regressors<Real> sample;

  Setup() {
    const Matrix p = example_covariance();
    sample.state_count = n;
    for (std::size_t a = 0; a < 2; ++a) {
      sample.terms[a] = {};
      sample.waves[a] = {static_cast<Real>(example_h[1 + 2 * a]),
                         static_cast<Real>(example_h[2 + 2 * a])};
    }
    for (std::size_t i = 0; i < n; ++i) {
      state.states_Nm[i] = static_cast<Real>(example_x[i]);
    }
    state.covariance = covariance_like<Real, 2>(p, n);
    state.torque_known = true;
  }

  /// Element of P.
  [[nodiscard]] Real covariance(std::size_t i, std::size_t j) const {
    return strainwave::detail::covariance_of(config, state.covariance, n - 1, i, j);
  }
};

/// Kalman update with gains K: (I - K h') P (I - K h')' + R K K'.
void joseph(Matrix& p, const Vector& gain, double noise_Nm2) {
  Matrix closed{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      closed[i][j] = (i == j ? 1.0 : 0.0) - gain[i] * example_h[j];
    }
  }
  Matrix half{};
  Matrix next{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < n; ++k) {
        half[i][j] += closed[i][k] * p[k][j];
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < n; ++k) {
        next[i][j] += half[i][k] * closed[j][k];
      }
      next[i][j] += noise_Nm2 * gain[i] * gain[j];
    }
  }
  p = next;
}

template <class Real>
class RippleStateOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(RippleStateOf, Precisions);

TYPED_TEST(RippleStateOf, UpdateIsJosephsFormWithTorqueRaisedByTheJump) {
  using Real = TypeParam;
  const double tolerance = sizeof(Real) == 4 ? 2e-6 : 1e-14;
  for (const double scale_Nm : {0.05, 0.9}) {
    for (const bool moving : {true, false}) {
      for (const double innovation_Nm : {0.1, -0.9, 4.0, -60.0}) {
        Setup<Real> our;
        our.config.torque_noise_Nm = Real(0.1);
        our.config.initial_amplitude_Nm = Real(100);
        our.state.innovation_scale_Nm = static_cast<Real>(scale_Nm);
        Matrix p = example_covariance();
        Vector ph{};
        double s = 0.01;
        for (std::size_t i = 0; i < n; ++i) {
          for (std::size_t j = 0; j < n; ++j) {
            ph[i] += p[i][j] * example_h[j];
          }
          s += example_h[i] * ph[i];
        }
        const double plain_variance = s;
        double ripple_variance = 0.0;  // of what the coefficients may still be wrong by
        for (std::size_t i = 1; i < n; ++i) {
          for (std::size_t j = 1; j < n; ++j) {
            ripple_variance += example_h[i] * p[i][j] * example_h[j];
          }
        }
        const double limit = 3.0 * std::fmax(scale_Nm, std::sqrt(ripple_variance));
        if (moving && std::fabs(innovation_Nm) > limit) {
          const double jump = s * (std::pow(innovation_Nm / limit, 2) - 1.0);
          p[0][0] += jump;
          ph[0] += jump;
          s += jump;
        }
        Vector gain{};
        for (std::size_t i = 0; i < n; ++i) {
          gain[i] = i == 0 || moving ? ph[i] / s : 0.0;
        }
        joseph(p, gain, 0.01);
        const auto found = strainwave::detail::update(our.config, our.state, our.sample,
                                                      static_cast<Real>(innovation_Nm), moving);
        EXPECT_EQ(found.status, 0U);
        EXPECT_NEAR(found.variance_Nm2, plain_variance, tolerance * 10);
        EXPECT_NEAR(found.jump_variance_Nm2, s - plain_variance, tolerance * 10 * s);
        const double size = 1.0 + innovation_Nm * innovation_Nm;
        for (std::size_t i = 0; i < n; ++i) {
          EXPECT_NEAR(our.state.states_Nm[i], example_x[i] + gain[i] * innovation_Nm,
                      tolerance * size);
          for (std::size_t j = 0; j <= i; ++j) {
            EXPECT_NEAR(our.covariance(i, j), p[i][j], tolerance * size)
                << i << j << moving << innovation_Nm;
          }
        }
        EXPECT_GT(smallest_pivot(our.config, our.state), 0.0);
      }
    }
  }
}

TYPED_TEST(RippleStateOf, AtRestTheCoefficientsAndTheirCovarianceKeepEveryBit) {
  using Real = TypeParam;
  Setup<Real> our;
  const Setup<Real> before = our;
  (void)strainwave::detail::update(our.config, our.state, our.sample, Real(7), false);
  for (std::size_t i = 1; i < n; ++i) {
    EXPECT_EQ(our.state.states_Nm[i], before.state.states_Nm[i]);
    for (std::size_t j = 1; j <= i; ++j) {
      EXPECT_EQ(our.covariance(i, j), before.covariance(i, j));
    }
  }
  EXPECT_NE(our.state.states_Nm[0], before.state.states_Nm[0]);
}

TYPED_TEST(RippleStateOf, TheFirstTorqueIsTheLimitOfOneThatIsNotKnown) {
  using Real = TypeParam;
  Setup<Real> our;
  Matrix p = example_covariance();
  strainwave::detail::start_torque(our.config, our.state, our.sample, Real(2.5));
  EXPECT_EQ(our.state.states_Nm[0], Real(2.5));
  EXPECT_TRUE(our.state.torque_known);
  // T with variance V: gain of T -> 1, of c -> 0, and Joseph's form is exact in that limit.
  for (std::size_t i = 1; i < n; ++i) {
    p[i][0] = p[0][i] = 0.0;
  }
  p[0][0] = 1e3;
  joseph(p, {1.0, 0.0, 0.0, 0.0, 0.0}, 0.04 * 0.04);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      EXPECT_NEAR(our.covariance(i, j), p[i][j], 1e-6);
    }
  }
}

TYPED_TEST(RippleStateOf, AJumpBeyondAllMeasureIsThatOfAMillionLimits) {
  using Real = TypeParam;
  for (const Real innovation_Nm : {Real(1e14), Real(-1e15), Real(3e9)}) {
    Setup<Real> our;
    our.state.innovation_scale_Nm = Real(1e3);
    const auto before = our.state;
    const auto found =
        strainwave::detail::update(our.config, our.state, our.sample, innovation_Nm, true);
    const auto expected = static_cast<double>(found.variance_Nm2) *
                          (std::fmin(1e12, std::pow(innovation_Nm / Real(3e3), 2)) - 1.0);
    EXPECT_NEAR(static_cast<double>(found.jump_variance_Nm2) / expected, 1.0, 1e-6);
    EXPECT_NEAR(our.state.states_Nm[0] / innovation_Nm, Real(1), Real(1e-5));
    for (std::size_t i = 1; i < n; ++i) {
      // What it leaves of the coefficients' gain is P h / s over a million squared at most.
      const auto most = 10.0 * std::fabs(static_cast<double>(innovation_Nm)) /
                        std::fmin(1e12, std::pow(innovation_Nm / Real(3e3), 2));
      EXPECT_NEAR(our.state.states_Nm[i], before.states_Nm[i], most);
    }
    EXPECT_GT(smallest_pivot(our.config, our.state), 0.0);
  }
}

/// What an order's variance gains: 2 R_eff (rotation / (2 pi n))^2.
double gained_Nm2(double order, double rotation_rad, double interval_s) {
  const double pi = 3.14159265358979323846;
  const double walk = 1.3 * 1.3 * interval_s;
  const double swing = std::fmin(std::fabs(order * rotation_rad), pi);
  const double noise = 0.04 * 0.04 + walk / (2.0 - 2.0 * std::cos(swing));
  return 2.0 * noise * std::pow(rotation_rad / (2.0 * pi * 30.0), 2);
}

/// What an order gains, as the core has it.
template <class Real>
double found_Nm2(const Setup<Real>& our, std::size_t order, double rotation_rad) {
  const auto way =
      strainwave::detail::way_of(our.config, our.state, static_cast<Real>(rotation_rad));
  return static_cast<double>(strainwave::detail::gained_variance(our.config, way, order));
}

template <class Real>
strainwave::Status let_ripple_walk(Setup<Real>& our, double rotation_rad) {
  return strainwave::detail::let_ripple_walk(our.config, our.state, our.sample.terms,
                                             static_cast<Real>(rotation_rad));
}

/// `added` is what the diagonal of P has gained since `before`, and nothing else has changed.
template <class Real>
void expect_added(const Setup<Real>& our, const Setup<Real>& before, const Vector& added) {
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double tolerance = sizeof(Real) == 4 ? 2e-7 : 1e-5 * added[i] + 1e-15;
      EXPECT_NEAR(
          static_cast<double>(our.covariance(i, j)) - static_cast<double>(before.covariance(i, j)),
          i == j ? added[i] : 0.0, tolerance)
          << i << j;
    }
  }
}

TYPED_TEST(RippleStateOf, ProcessNoiseIsThatOfTheMemory) {
  using Real = TypeParam;
  for (const double rotation_rad : {0.15, -0.02, 0.7, 0.785, -0.79, 2.0}) {
    Setup<Real> our;
    our.config.initial_amplitude_Nm = Real(1e4);
    our.state.time_since_update_s = Real(1e-3);
    const Setup<Real> before = our;
    const double two = gained_Nm2(2.0, rotation_rad, 1e-3);
    const double four = gained_Nm2(4.0, rotation_rad, 1e-3);
    EXPECT_NEAR(found_Nm2(our, 0, rotation_rad) / two, 1.0, 8e-6);
    EXPECT_NEAR(found_Nm2(our, 1, rotation_rad) / four, 1.0, 8e-6);
    EXPECT_EQ(let_ripple_walk(our, rotation_rad), 0U);
    expect_added(our, before, {0.0, two, two, four, four});
  }
}

TYPED_TEST(RippleStateOf, AnOrdersProcessNoiseIsSharedByTheSquaresOfItsFactors) {
  using Real = TypeParam;
  for (const double frame : {0.0, 0.75, -0.4}) {
    Setup<Real> our;
    our.config.initial_amplitude_Nm = Real(1e4);
    our.config.order_count = 1;
    our.config.orders[0].with_load = true;
    our.sample.terms[0].factors[0] = Real(0.75);
    our.state.covariance.frames[0][0] = static_cast<Real>(frame);
    our.state.time_since_update_s = Real(1e-3);
    const Setup<Real> before = our;
    const double each = gained_Nm2(2.0, 0.15, 1e-3) / (1.0 + 0.75 * 0.75);
    EXPECT_EQ(let_ripple_walk(our, 0.15), 0U);
    expect_added(our, before, {0.0, each, each, each, each});
  }
}

TYPED_TEST(RippleStateOf, AGapsProcessNoiseIsThatOfTheTypicalIntervalsInIt) {
  using Real = TypeParam;
  constexpr double orders[2] = {2.0, 4.0};
  const double typical_s = 1e-3;
  for (const double intervals : {2.01, 40.0, 5000.0}) {
    for (const double rotation_a_sample_rad : {0.02, -0.002}) {
      Setup<Real> our;
      our.state.time_since_update_s = static_cast<Real>(typical_s * intervals);
      our.state.typical_interval_s = static_cast<Real>(typical_s);
      for (std::size_t a = 0; a < 2; ++a) {
        const double expected = intervals * gained_Nm2(orders[a], rotation_a_sample_rad, typical_s);
        EXPECT_NEAR(found_Nm2(our, a, rotation_a_sample_rad * intervals) / expected, 1.0, 2e-5)
            << intervals;
      }
      our.state.time_since_update_s = static_cast<Real>(1.99 * typical_s);  // no gap
      EXPECT_NEAR(found_Nm2(our, 0, 0.4) / gained_Nm2(2.0, 0.4, 1.99 * typical_s), 1.0, 1e-5);
    }
  }
}

TYPED_TEST(RippleStateOf, NoOrderGainsMoreThanTwiceItsNoise) {
  // A rotation beyond the memory: what was learned says nothing any more.
  using Real = TypeParam;
  Setup<Real> our;
  our.state.time_since_update_s = Real(1e-3);
  EXPECT_NEAR(found_Nm2(our, 0, 6.2831853 * 31) / (2.0 * (0.0016 + 1.69e-3 / 4.0)), 1.0, 1e-5);
}

TYPED_TEST(RippleStateOf, TorqueWalksWithTimeUpToATenthOfASecond) {
  using Real = TypeParam;
  for (const double interval_s : {1e-3, 0.05, 5.0}) {
    Setup<Real> our;
    our.state.time_since_update_s = static_cast<Real>(interval_s);
    const Setup<Real> before = our;
    strainwave::detail::let_torque_walk(our.config, our.state);
    expect_added(our, before, {1.69 * std::fmin(interval_s, 0.1), 0.0, 0.0, 0.0, 0.0});
  }
}

TYPED_TEST(RippleStateOf, NothingIsLearnedWithoutRotation) {
  using Real = TypeParam;
  Setup<Real> our;
  our.state.time_since_update_s = Real(5);
  const Setup<Real> before = our;
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(let_ripple_walk(our, 0.0), 0U);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      EXPECT_EQ(our.covariance(i, j), before.covariance(i, j));
    }
  }
}

TYPED_TEST(RippleStateOf, VariancesBeyondThoseOfTheBeginningDoNotGrow) {
  using Real = TypeParam;
  Setup<Real> our;
  const Matrix p = example_covariance();
  const double first = 0.5 * (p[1][1] + p[2][2]);
  const double second = 0.5 * (p[3][3] + p[4][4]);
  ASSERT_GT(std::fabs(first - second), 1e-3);
  const double limit_Nm2 = 0.5 * (first + second);
  our.config.initial_amplitude_Nm = static_cast<Real>(std::sqrt(limit_Nm2));
  our.state.time_since_update_s = Real(1e-3);
  const Setup<Real> before = our;
  EXPECT_EQ(let_ripple_walk(our, 0.15), strainwave::mask(strainwave::StatusFlag::variance_limited));
  const double two = gained_Nm2(2.0, 0.15, 1e-3) * std::fmax(0.0, 1.0 - first / limit_Nm2);
  const double four = gained_Nm2(4.0, 0.15, 1e-3) * std::fmax(0.0, 1.0 - second / limit_Nm2);
  expect_added(our, before, {0.0, two, two, four, four});
  our.config.initial_amplitude_Nm = Real(2);
  EXPECT_EQ(let_ripple_walk(our, 0.15), 0U);
}

TYPED_TEST(RippleStateOf, ACovarianceThatHasLostItsSignIsReset) {
  using Real = TypeParam;
  for (const Real broken :
       {Real(-50), std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()}) {
    Setup<Real> our;
    our.state.covariance.torque_variance_Nm2 = broken;
    const auto found = strainwave::detail::update(our.config, our.state, our.sample, Real(1), true);
    EXPECT_EQ(found.status, strainwave::mask(strainwave::StatusFlag::covariance_reset));
    EXPECT_EQ(found.innovation_Nm, Real(0));
    EXPECT_EQ(found.variance_Nm2, Real(0));
    EXPECT_FALSE(our.state.torque_known);
    for (std::size_t i = 1; i < n; ++i) {
      EXPECT_EQ(our.state.states_Nm[i], static_cast<Real>(example_x[i]));
      EXPECT_EQ(our.covariance(i, i), Real(4));
    }
  }
}

TYPED_TEST(RippleStateOf, TheScaleIsExceededByThreeInnovationsInTen) {
  using Real = TypeParam;
  for (const double deviation_Nm : {0.01, 1.0, 300.0}) {
    Setup<Real> our;
    our.config.torque_noise_Nm = Real(1e-3);
    our.state.innovation_scale_Nm = Real(0.12);
    Random random(3);
    int beyond = 0;
    double sum = 0.0;
    for (int k = 0; k < 60'000; ++k) {
      const double e = deviation_Nm * random.gaussian();
      if (k >= 10'000) {
        beyond += std::fabs(e) > static_cast<double>(our.state.innovation_scale_Nm) ? 1 : 0;
        sum += static_cast<double>(our.state.innovation_scale_Nm);
      }
      strainwave::detail::track_scale(our.config, our.state, static_cast<Real>(e), Real(-0.15));
    }
    EXPECT_NEAR(beyond / 50'000.0, 0.3, 0.01);
    EXPECT_NEAR(sum / 50'000.0 / deviation_Nm, 1.036, 0.06);  // the normal 70 % quantile of |e|
  }
  Setup<Real> still;
  for (int k = 0; k < 100'000; ++k) {
    strainwave::detail::track_scale(still.config, still.state, Real(0), Real(0.15));
  }
  EXPECT_EQ(still.state.innovation_scale_Nm, Real(0.5) * still.config.torque_noise_Nm);
}

}  // namespace
