// The covariance in its frame, one operation at a time, against matrices of the coefficients
// themselves, written out.
#include "strainwave/ripple_covariance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ripple_examples.hpp"

namespace {

using Matrix = std::vector<std::vector<double>>;
using Vector = std::vector<double>;

template <class Real>
class RippleCovarianceOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(RippleCovarianceOf, Precisions);

/// Relative to the matrix' size.
template <class Real>
constexpr double tolerance = sizeof(Real) == 4 ? 1e-5 : 1e-12;

constexpr std::uint64_t seeds[] = {1, 2, 3};
constexpr std::size_t structures = 5;

/// Orders with no further pairs and with up to three.
template <class Real, std::size_t MaxPairs>
strainwave::RippleFilterConfig<Real, MaxPairs> structure(std::size_t index) {
  strainwave::RippleFilterConfig<Real, MaxPairs> config;
  constexpr std::size_t order_counts[structures] = {1, 1, 2, 2, 3};
  config.order_count = order_counts[index];
  for (std::uint32_t a = 0; a < config.order_count; ++a) {
    config.orders[a].order = {2 * (a + 1), 1};
  }
  config.orders[0].with_load = index > 0;
  config.orders[0].with_speed = index > 2;
  config.orders[0].with_direction = index == 3;
  config.orders[1].with_speed = index == 2 || index == 4;
  return config;
}

/// B B' + 0.05, with elements of B from -0.5 to 0.5; 0 is T.
Matrix random_covariance(std::size_t states, Random& random) {
  Matrix b(states, Vector(states));
  for (Vector& row : b) {
    for (double& element : row) {
      element = 0.5 * random.uniform();
    }
  }
  Matrix p(states, Vector(states));
  for (std::size_t i = 0; i < states; ++i) {
    for (std::size_t j = 0; j < states; ++j) {
      for (std::size_t k = 0; k < states; ++k) {
        p[i][j] += b[i][k] * b[j][k];
      }
    }
    p[i][i] += 0.05;
  }
  return p;
}

/// A covariance in a frame of its own, and `dense`, that of T and the coefficients themselves.
template <class Real>
struct Example {
  static constexpr std::size_t max_pairs = 7;
  using Terms = strainwave::OrderTerms<Real>;

  strainwave::RippleFilterConfig<Real, max_pairs> config;
  std::size_t states;
  std::size_t count;
  Random random;
  strainwave::RippleCovariance<Real, max_pairs> p;
  Matrix dense;
  Terms terms[max_pairs] = {};
  strainwave::CosSin<Real> waves[max_pairs] = {};

  Example(std::size_t index, std::uint64_t seed)
      : config(structure<Real, max_pairs>(index)),
        states(1 + 2 * strainwave::pair_count(config)),
        count(states - 1),
        random(100 * index + seed) {
    const Matrix framed = random_covariance(states, random);
    p = covariance_like<Real, max_pairs>(framed, states);
    for (std::size_t a = 0; a < config.order_count; ++a) {
      for (Real& each : p.frames[a]) {
        each = static_cast<Real>(random.uniform());
      }
    }
    const Matrix back = from_frame();
    dense = Matrix(states, Vector(states));
    for (std::size_t i = 0; i < states; ++i) {
      for (std::size_t j = 0; j < states; ++j) {
        for (std::size_t k = 0; k < states; ++k) {
          for (std::size_t m = 0; m < states; ++m) {
            dense[i][j] += back[i][k] * framed[k][m] * back[j][m];
          }
        }
      }
    }
    look(0.5);
  }

  /// New factors so far from the frame's, and a new angle.
  void look(double distance) {
    for (std::size_t a = 0; a < config.order_count; ++a) {
      for (std::size_t t = 0; t < 3; ++t) {
        terms[a].factors[t] = p.frames[a][t] + static_cast<Real>(distance * random.uniform());
      }
      const double angle_rad = 3.0 * random.uniform();
      waves[a] = {static_cast<Real>(std::cos(angle_rad)), static_cast<Real>(std::sin(angle_rad))};
    }
  }

  /// Calls with each order's index, its first state and how many further pairs it has.
  template <class Call>
  void each(const Call& call) const {
    std::size_t first = 1;
    for (std::size_t a = 0; a < config.order_count; ++a) {
      const std::size_t further = strainwave::pairs_of(config.orders[a]) - 1;
      call(a, first, further);
      first += 2 * (1 + further);
    }
  }

  /// Coefficients from what the frame describes: a first pair is the order's ripple less what the
  /// further pairs make of it.
  [[nodiscard]] Matrix from_frame() const {
    Matrix back(states, Vector(states));
    for (std::size_t i = 0; i < states; ++i) {
      back[i][i] = 1.0;
    }
    each([&](std::size_t a, std::size_t first, std::size_t further) {
      for (std::size_t t = 0; t < further; ++t) {
        for (std::size_t side = 0; side < 2; ++side) {
          back[first + side][first + 2 * (t + 1) + side] = -static_cast<double>(p.frames[a][t]);
        }
      }
    });
    return back;
  }

  /// What T and the coefficients themselves are multiplied by.
  [[nodiscard]] Vector regressors() const {
    Vector h(states, 1.0);
    each([&](std::size_t a, std::size_t first, std::size_t further) {
      for (std::size_t t = 0; t <= further; ++t) {
        const double factor = t == 0 ? 1.0 : static_cast<double>(terms[a].factors[t - 1]);
        h[first + 2 * t] = factor * static_cast<double>(waves[a].cosine);
        h[first + 2 * t + 1] = factor * static_cast<double>(waves[a].sine);
      }
    });
    return h;
  }

  [[nodiscard]] double element(std::size_t i, std::size_t j) const {
    return static_cast<double>(strainwave::detail::covariance_of(config, p, count, i, j));
  }
  void expect_dense(const char* what) const {
    double largest = 1.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < states; ++i) {
      for (std::size_t j = 0; j < states; ++j) {
        largest = std::fmax(largest, std::fabs(dense[i][j]));
        worst = std::fmax(worst, std::fabs(element(i, j) - dense[i][j]));
      }
    }
    EXPECT_LT(worst, tolerance<Real> * largest) << what << ", " << states;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_EQ(strainwave::detail::element_of(p, i, j), strainwave::detail::element_of(p, j, i));
      }
    }
  }
};

/// Every operation for each structure and seed.
template <class Real, class Check>
void for_examples(const Check& check) {
  for (std::size_t index = 0; index < structures; ++index) {
    for (const std::uint64_t seed : seeds) {
      Example<Real> example(index, seed);
      check(example);
    }
  }
}

TYPED_TEST(RippleCovarianceOf, ElementsAreThoseOfTheCoefficientsThemselves) {
  for_examples<TypeParam>([](Example<TypeParam>& its) { its.expect_dense("elements"); });
}

TYPED_TEST(RippleCovarianceOf, UncorrelatedIsADiagonal) {
  using Real = TypeParam;
  Example<Real> its(4, 1);
  strainwave::detail::set_uncorrelated(its.p, Real(4));
  for (std::size_t i = 0; i < its.states; ++i) {
    for (std::size_t j = 0; j < its.states; ++j) {
      EXPECT_EQ(its.element(i, j), i == j && i > 0 ? 4.0 : 0.0);
    }
  }
}

TYPED_TEST(RippleCovarianceOf, TheFrameMovesWithoutChangingWhatItDescribes) {
  for_examples<TypeParam>([](Example<TypeParam>& its) {
    std::size_t orders_with_terms = 0;
    its.each([&](std::size_t, std::size_t, std::size_t further) {
      orders_with_terms += further > 0 ? 1U : 0U;
    });
    its.look(3.0);
    for (std::size_t calls = 0; calls < 4; ++calls) {
      std::size_t there = 0;
      its.each([&](std::size_t a, std::size_t, std::size_t further) {
        bool all = further > 0;
        for (std::size_t t = 0; t < further; ++t) {
          all = all && std::fabs(static_cast<double>(its.terms[a].factors[t]) -
                                 static_cast<double>(its.p.frames[a][t])) < 1e-6;
        }
        there += all ? 1U : 0U;
      });
      EXPECT_EQ(there, std::min(calls, orders_with_terms));  // one order a call
      strainwave::detail::follow(its.config, its.p, its.count, its.terms);
      its.expect_dense("moved");
    }
  });
}

TYPED_TEST(RippleCovarianceOf, TheFrameStaysWhileFactorsAreNear) {
  for_examples<TypeParam>([](Example<TypeParam>& its) {
    its.look(0.06);
    const auto before = its.p;
    strainwave::detail::follow(its.config, its.p, its.count, its.terms);
    its.each([&](std::size_t a, std::size_t, std::size_t further) {
      for (std::size_t t = 0; t < further; ++t) {
        EXPECT_EQ(its.p.frames[a][t], before.frames[a][t]);
      }
    });
  });
}

TYPED_TEST(RippleCovarianceOf, ProcessNoiseIsThatOfTheCoefficientsThemselves) {
  using Real = TypeParam;
  for_examples<Real>([](Example<Real>& its) {
    its.each([&](std::size_t a, std::size_t first, std::size_t further) {
      const double noise_Nm2 = 0.03 * static_cast<double>(a + 1);
      EXPECT_FALSE(strainwave::detail::add_noise(its.p, a, first - 1, further,
                                                 static_cast<Real>(noise_Nm2), Real(1e15)));
      for (std::size_t i = first; i < first + 2 * (1 + further); ++i) {
        its.dense[i][i] += noise_Nm2;
      }
    });
    its.expect_dense("with noise");
  });
}

TYPED_TEST(RippleCovarianceOf, APairGainsTheLessTheLessItIsKnown) {
  using Real = TypeParam;
  for (const double of_mean : {100.0, 2.0, 0.9}) {
    Example<Real> its(3, 2);  // the first order has all three further pairs
    const double limit_Nm2 = of_mean * 0.5 * (its.dense[5][5] + its.dense[6][6]);
    std::size_t nothing = 0;
    const auto add = [&](std::size_t i, double variances_Nm2, double most_Nm2) {
      const double share = std::fmax(0.0, 1.0 - variances_Nm2 / most_Nm2);
      nothing += share > 0.0 ? 0U : 1U;
      its.dense[i][i] += 0.02 * share;
      its.dense[i + 1][i + 1] += 0.02 * share;
    };
    double weight = 1.0;
    for (const Real each : its.p.frames[0]) {
      weight += static_cast<double>(each * each);
    }
    add(1,
        static_cast<double>(strainwave::detail::element_of(its.p, 0, 0) +
                            strainwave::detail::element_of(its.p, 1, 1)),
        2.0 * weight * limit_Nm2);
    for (std::size_t i = 3; i <= 7; i += 2) {
      add(i, its.dense[i][i] + its.dense[i + 1][i + 1], 2.0 * limit_Nm2);
    }
    const bool limited =
        strainwave::detail::add_noise(its.p, 0, 0, 3, Real(0.02), static_cast<Real>(limit_Nm2));
    EXPECT_EQ(limited, nothing > 0);
    EXPECT_EQ(limited, of_mean < 1.0);
    its.expect_dense("given");
  }
}

TYPED_TEST(RippleCovarianceOf, AMeasurementIsKalmansUpdate) {
  using Real = TypeParam;
  for (const double noise : {1e-3, 0.2, 30.0}) {
    for (const double jump_Nm2 : {0.0, 7.0, 1e12}) {
      for_examples<Real>([&](Example<Real>& its) {
        its.look(0.3);
        const Vector h = its.regressors();
        its.dense[0][0] += jump_Nm2;
        Vector ph(its.states);
        double variance = noise;
        double ripple_variance = 0.0;
        for (std::size_t i = 0; i < its.states; ++i) {
          for (std::size_t j = 0; j < its.states; ++j) {
            ph[i] += its.dense[i][j] * h[j];
            ripple_variance += i > 0 && j > 0 ? h[i] * its.dense[i][j] * h[j] : 0.0;
          }
          variance += h[i] * ph[i];
        }
        strainwave::detail::SeenCovariance<Real, 7> seen{};
        Real row[16] = {};
        strainwave::detail::enter_frame(its.config, its.p, its.terms, its.waves, seen.h);
        strainwave::detail::see(its.p, its.count, seen);
        EXPECT_NEAR(static_cast<double>(seen.ripple_variance_Nm2), ripple_variance,
                    10 * tolerance<Real>);
        const double found = noise + jump_Nm2 + static_cast<double>(its.p.torque_variance_Nm2) +
                             2.0 * static_cast<double>(seen.shared_Nm2) +
                             static_cast<double>(seen.ripple_variance_Nm2);
        EXPECT_NEAR(found / variance, 1.0, tolerance<Real>);
        strainwave::detail::measure_torque(its.p, its.count, seen, static_cast<Real>(noise),
                                           static_cast<Real>(1.0 / variance), row);
        strainwave::detail::measure_coefficients(its.p, its.count, row,
                                                 static_cast<Real>(std::sqrt(1.0 / variance)));
        strainwave::detail::leave_frame(its.config, its.p, row);
        for (std::size_t i = 1; i < its.states; ++i) {
          EXPECT_NEAR(static_cast<double>(row[i - 1]), ph[i], 10 * tolerance<Real>);
        }
        // T's row of (I - g h') P (I - g h')' + R g g', which loses nothing to a large jump.
        const double left = 1.0 - ph[0] / variance;
        Matrix after = its.dense;
        for (std::size_t i = 1; i < its.states; ++i) {
          for (std::size_t j = 1; j < its.states; ++j) {
            after[i][j] -= ph[i] * ph[j] / variance;
          }
          double ripple_row = 0.0;
          for (std::size_t j = 1; j < its.states; ++j) {
            ripple_row += its.dense[i][j] * h[j];
          }
          after[0][i] = after[i][0] = left * ph[i] - ripple_row;
        }
        double rest = noise + ripple_variance;
        for (std::size_t j = 1; j < its.states; ++j) {
          rest += its.dense[0][j] * h[j];
        }
        after[0][0] = noise + ripple_variance - rest * rest / variance;
        its.dense = after;
        its.expect_dense("measured");
        EXPECT_GT(its.p.torque_variance_Nm2, Real(0));
      });
    }
  }
}

TYPED_TEST(RippleCovarianceOf, TwoThatCannotBeToldApartKeepTheirSign) {
  // An order at one load: its ripple's variance falls by seven decades, its load pair's does not.
  using Real = TypeParam;
  Example<Real> its(1, 1);
  strainwave::detail::set_uncorrelated(its.p, Real(4));
  its.terms[0].factors[0] = Real(0.3);
  strainwave::detail::SeenCovariance<Real, 7> seen{};
  for (int k = 0; k < 1000; ++k) {
    const double angle_rad = 0.15 * k;
    its.waves[0] = {static_cast<Real>(std::cos(angle_rad)), static_cast<Real>(std::sin(angle_rad))};
    strainwave::detail::follow(its.config, its.p, its.count, its.terms);
    strainwave::detail::enter_frame(its.config, its.p, its.terms, its.waves, seen.h);
    strainwave::detail::see(its.p, its.count, seen);
    const Real variance = seen.ripple_variance_Nm2 + Real(1e-4);
    strainwave::detail::measure_coefficients(its.p, its.count, seen.ripple_row_Nm2,
                                             Real(1) / std::sqrt(variance));
  }
  // Least squares: each of cosine and sine from half of the samples, R / 500.
  EXPECT_NEAR(static_cast<double>(seen.ripple_variance_Nm2) / 2e-7, 1.0, 0.01);
  // Of the load pair what the ripple's knowledge leaves: 4 (1 - 0.3^2 / (1 + 0.3^2)).
  EXPECT_NEAR(its.element(3, 3), 4.0 / 1.09, 1e-4);
  EXPECT_NEAR(its.element(4, 4), 4.0 / 1.09, 1e-4);
}

TYPED_TEST(RippleCovarianceOf, ResultsDoNotDependOnTheCapacity) {
  using Real = TypeParam;
  const auto small = structure<Real, 6>(4);
  const auto config = structure<Real, 32>(4);
  const std::size_t count = 2 * strainwave::pair_count(small);
  ASSERT_EQ(count, 12U);  // all of the smaller capacity
  Random random(11);
  const Matrix dense = random_covariance(1 + count, random);
  auto exact = covariance_like<Real, 6>(dense, 1 + count);
  auto large = covariance_like<Real, 32>(dense, 1 + count);
  strainwave::OrderTerms<Real> terms[3] = {};
  strainwave::CosSin<Real> waves[3] = {};
  const auto step = [&](const auto& its_config, auto& p, auto& seen) {
    Real row[64] = {};
    strainwave::detail::follow(its_config, p, count, terms);
    strainwave::detail::enter_frame(its_config, p, terms, waves, seen.h);
    strainwave::detail::see(p, count, seen);
    const Real variance =
        Real(0.1) + p.torque_variance_Nm2 + Real(2) * seen.shared_Nm2 + seen.ripple_variance_Nm2;
    strainwave::detail::measure_torque(p, count, seen, Real(0.1), Real(1) / variance, row);
    strainwave::detail::measure_coefficients(p, count, row, std::sqrt(Real(1) / variance));
    (void)strainwave::detail::add_noise(p, 0, 0, 2, Real(0.01), Real(1));
    p.torque_variance_Nm2 += Real(0.003);
    return variance;
  };
  for (int k = 0; k < 200; ++k) {
    for (std::size_t a = 0; a < 3; ++a) {
      terms[a].factors[0] = static_cast<Real>(random.uniform());
      terms[a].factors[1] = static_cast<Real>(random.uniform());
      waves[a] = {static_cast<Real>(random.uniform()), static_cast<Real>(random.uniform())};
    }
    strainwave::detail::SeenCovariance<Real, 6> seen{};
    strainwave::detail::SeenCovariance<Real, 32> seen_large{};
    ASSERT_EQ(step(small, exact, seen), step(config, large, seen_large));
    for (std::size_t i = 0; i <= count; ++i) {
      for (std::size_t j = 0; j <= count; ++j) {
        ASSERT_EQ(strainwave::detail::covariance_of(small, exact, count, i, j),
                  strainwave::detail::covariance_of(config, large, count, i, j));
      }
    }
  }
}

}  // namespace
