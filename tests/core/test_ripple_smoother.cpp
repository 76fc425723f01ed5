// Forwards and backwards against a dense smoother; tests/python has the long comparisons.
#include "strainwave/ripple_smoother.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "ripple_examples.hpp"

namespace {

template <class Real>
class RippleSmootherOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(RippleSmootherOf, Precisions);

constexpr std::size_t samples = 400;
constexpr std::size_t n = 5;  // T and two pairs
/// 0.15 rad, in whole counts of 2^-20 turn: a phase without rounding.
constexpr double turn_rad = 6.28318530717958647693 * 25033.0 / 1048576.0;
using Vector = std::array<double, n>;
using Matrix = std::array<Vector, n>;

/// Torque that wanders beside the ripple; two contacts.
std::vector<double> recording() {
  Random random(21);
  std::vector<double> torque_Nm;
  double walk_Nm = 3.0;
  for (std::size_t k = 0; k < samples; ++k) {
    walk_Nm += 0.041 * random.gaussian();
    walk_Nm += k == 150 || k == 290 ? 6.0 : 0.0;
    torque_Nm.push_back(walk_Nm + example_ripple_Nm(turn_rad * static_cast<double>(k)) +
                        0.04 * random.gaussian());
  }
  return torque_Nm;
}

template <class Real, std::size_t MaxPairs>
struct Run {
  std::vector<strainwave::SmootherTrace<Real, MaxPairs>> traces;
  std::vector<Real> ripple_Nm;
  std::size_t first = 0;  ///< that is learned from

  explicit Run(const strainwave::RippleFilterConfig<Real, MaxPairs>& config)
      : traces(samples), ripple_Nm(samples) {
    const std::vector<double> torque_Nm = recording();
    auto state = strainwave::initial_state(config);
    for (std::size_t k = 0; k < samples; ++k) {
      const auto reading = strainwave::step_forward(
          config, state, ripple_sample<Real>(torque_Nm[k], turn_rad * static_cast<double>(k)),
          traces[k]);
      first += has(reading.status, strainwave::StatusFlag::at_rest) ? 1U : 0U;
    }
    strainwave::SmootherState<Real, MaxPairs> back;
    for (std::size_t k = samples; k-- > 0;) {
      ripple_Nm[k] = strainwave::step_backward(back, traces[k]);
    }
  }
};

Vector row_at(std::size_t k) {
  const double angle_rad = turn_rad * static_cast<double>(k);
  return {1.0, std::cos(2 * angle_rad), std::sin(2 * angle_rad), std::cos(4 * angle_rad),
          std::sin(4 * angle_rad)};
}

Vector product(const Matrix& a, const Vector& x) {
  Vector result{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      result[i] += a[i][j] * x[j];
    }
  }
  return result;
}

double dot(const Vector& a, const Vector& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    sum += a[i] * b[i];
  }
  return sum;
}

/// P^-1 b of a positive definite P, by elimination.
Vector solved(Matrix p, Vector b) {
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = p[i][k] / p[k][k];
      for (std::size_t j = k; j < n; ++j) {
        p[i][j] -= factor * p[k][j];
      }
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) {
      b[k] -= p[k][j] * b[j];
    }
    b[k] /= p[k][k];
  }
  return b;
}

constexpr double noise = 0.04 * 0.04;
constexpr double walk = 1.3 * 1.3 * 1e-3;

/// Process noise of the coefficients, after a sample and before the next one's update.
void give_noise(Matrix& p) {
  const double pi = 3.14159265358979323846;
  for (std::size_t a = 0; a < 2; ++a) {
    const double chord = 2.0 - 2.0 * std::cos((a == 0 ? 2.0 : 4.0) * turn_rad);
    const double gained = 2.0 * (noise + walk / chord) * std::pow(turn_rad / (2.0 * pi * 30.0), 2);
    const std::size_t i = 1 + 2 * a;
    const double given = gained * std::fmax(0.0, 1.0 - (p[i][i] + p[i + 1][i + 1]) / 8.0);
    p[i][i] += given;
    p[i + 1][i + 1] += given;
  }
}

/// A measurement of variance s and innovation e, seen as P h.
void measure(Vector& x, Matrix& p, const Vector& ph, double s, double e) {
  for (std::size_t i = 0; i < n; ++i) {
    x[i] += ph[i] / s * e;
    for (std::size_t j = 0; j < n; ++j) {
      p[i][j] -= ph[i] * ph[j] / s;
    }
  }
}

Vector plus(Vector a, const Vector& b) {
  for (std::size_t i = 0; i < n; ++i) {
    a[i] += b[i];
  }
  return a;
}

Vector less(Vector a, const Vector& b) {
  for (std::size_t i = 0; i < n; ++i) {
    a[i] -= b[i];
  }
  return a;
}

/// Kalman's filter from sample `first` on and the smoother of Rauch, Tung and Striebel, x_k + P_k
/// P-_(k+1)^-1 (x_(k+1) - x-_(k+1)), with full matrices.
std::vector<double> dense_ripple(std::size_t first) {
  const std::vector<double> torque_Nm = recording();
  Vector x{};
  Matrix p{};
  for (std::size_t i = 1; i < n; ++i) {
    p[i][i] = 4.0;
  }
  double scale = 0.12;
  std::vector<Vector> before_x(samples);
  std::vector<Matrix> before_p(samples);
  std::vector<Vector> after_x(samples);
  std::vector<Matrix> after_p(samples);
  for (std::size_t k = first; k < samples; ++k) {
    const Vector h = row_at(k);
    p[0][0] += walk;
    if (k == first) {  // T's variance is infinite: written as the core's limit of it
      x[0] = torque_Nm[k];
      Vector covariance = product(p, {0.0, h[1], h[2], h[3], h[4]});
      covariance[0] = 0.0;
      for (std::size_t i = 1; i < n; ++i) {
        p[i][0] = p[0][i] = -covariance[i];
      }
      p[0][0] = noise + dot(h, covariance);
    } else {
      before_x[k] = x;
      before_p[k] = p;
      const double e = torque_Nm[k] - dot(h, x);
      double s = dot(h, product(p, h)) + noise;
      const Vector hc = {0.0, h[1], h[2], h[3], h[4]};
      const double ratio = e * e / (9.0 * std::fmax(scale * scale, dot(hc, product(p, hc))));
      if (ratio > 1.0) {
        p[0][0] += s * (ratio - 1.0);
        before_p[k] = p;
        s *= ratio;
      }
      measure(x, p, product(p, h), s, e);
      const double change = static_cast<double>(0.06F) * turn_rad *
                            ((std::fabs(e) > scale ? 1.0 : 0.0) - static_cast<double>(0.3F));
      scale = std::fmax(scale * (1.0 + change + change * change / 2.0), 0.02);
    }
    after_x[k] = x;
    after_p[k] = p;
    if (k > first) {
      give_noise(p);
    }
  }
  std::vector<double> ripple(samples);
  Vector smoothed = x;
  for (std::size_t k = samples; k-- > first;) {
    if (k + 1 < samples) {
      smoothed =
          plus(after_x[k],
               product(after_p[k], solved(before_p[k + 1], less(smoothed, before_x[k + 1]))));
    }
    ripple[k] = dot(row_at(k), smoothed) - smoothed[0];
  }
  return ripple;
}

TYPED_TEST(RippleSmootherOf, ForwardsAndBackwardsIsADenseSmoother) {
  using Real = TypeParam;
  const Run<Real, 2> ours(two_orders<Real, 2>());
  ASSERT_LT(ours.first, 5U);
  ASSERT_GT(ours.first, 0U);
  const std::vector<double> dense = dense_ripple(ours.first);
  double worst = 0.0;
  double error = 0.0;
  for (std::size_t k = ours.first; k < samples; ++k) {
    worst = std::fmax(worst, std::fabs(static_cast<double>(ours.ripple_Nm[k]) - dense[k]));
    error = std::fmax(error,
                      std::fabs(dense[k] - example_ripple_Nm(turn_rad * static_cast<double>(k))));
  }
  EXPECT_LT(worst, sizeof(Real) == 4 ? 1e-3 : 1e-9);
  EXPECT_LT(error, 0.2);
  EXPECT_GT(error, 1e-3);
}

TYPED_TEST(RippleSmootherOf, TheFirstRowsKnowWhatTheFilterLearnsLater) {
  using Real = TypeParam;
  const Run<Real, 2> ours(two_orders<Real, 2>());
  double filtered = 0.0;
  double smoothed = 0.0;
  for (std::size_t k = 0; k < 40; ++k) {
    const double ripple_Nm = example_ripple_Nm(turn_rad * static_cast<double>(k));
    filtered =
        std::fmax(filtered, std::fabs(static_cast<double>(ours.traces[k].ripple_Nm) - ripple_Nm));
    smoothed = std::fmax(smoothed, std::fabs(static_cast<double>(ours.ripple_Nm[k]) - ripple_Nm));
  }
  EXPECT_GT(filtered, 1.0);
  EXPECT_LT(smoothed, 0.2);
}

TYPED_TEST(RippleSmootherOf, KeptOrdersAreLearnedAndLeftIn) {
  // Each order's ripple alone, the other one kept; together they are the ripple of both.
  using Real = TypeParam;
  auto config = two_orders<Real, 2>();
  const Run<Real, 2> both(config);
  config.orders[1].keep = true;
  const Run<Real, 2> two(config);
  config.orders[0].keep = true;
  config.orders[1].keep = false;
  const Run<Real, 2> four(config);
  double largest = 0.0;
  for (std::size_t k = 0; k < samples; ++k) {
    ASSERT_NEAR(two.ripple_Nm[k] + four.ripple_Nm[k], both.ripple_Nm[k],
                sizeof(Real) == 4 ? 2e-5 : 1e-11)
        << k;
    largest = std::fmax(largest, std::fabs(static_cast<double>(four.ripple_Nm[k])));
  }
  EXPECT_NEAR(largest, 0.6, 0.1);
}

TYPED_TEST(RippleSmootherOf, ACovarianceThatIsResetLeavesNumbers) {
  using Real = TypeParam;
  const auto config = two_orders<Real, 2>();
  const std::vector<double> torque_Nm = recording();
  auto state = strainwave::initial_state(config);
  std::vector<strainwave::SmootherTrace<Real, 2>> traces(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    if (k == 200) {
      state.covariance.torque_variance_Nm2 = std::numeric_limits<Real>::quiet_NaN();
    }
    const auto sample = ripple_sample<Real>(torque_Nm[k], turn_rad * static_cast<double>(k));
    const auto reading = strainwave::step_forward(config, state, sample, traces[k]);
    ASSERT_EQ(has(reading.status, strainwave::StatusFlag::covariance_reset), k == 200);
    ASSERT_TRUE(strainwave::is_finite(reading.innovation_variance_Nm2));
  }
  strainwave::SmootherState<Real, 2> back;
  for (std::size_t k = samples; k-- > 0;) {
    ASSERT_TRUE(strainwave::is_finite(strainwave::step_backward(back, traces[k]))) << k;
  }
}

TYPED_TEST(RippleSmootherOf, ResultDoesNotDependOnTheCapacity) {
  using Real = TypeParam;
  const auto config = two_orders<Real, 2>();
  const Run<Real, 2> exact(config);
  const Run<Real, 8> middle(strainwave::converted<Real, 8>(config));
  const Run<Real, 32> large(strainwave::converted<Real, 32>(config));
  for (std::size_t k = 0; k < samples; ++k) {
    ASSERT_EQ(middle.ripple_Nm[k], exact.ripple_Nm[k]) << k;
    ASSERT_EQ(large.ripple_Nm[k], exact.ripple_Nm[k]) << k;
  }
}

}  // namespace
