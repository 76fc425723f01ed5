// The factored covariance, one operation at a time, against matrices written out.
#include "strainwave/ripple_covariance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ripple_examples.hpp"

namespace {

using strainwave::RippleCovariance;
using Matrix = std::vector<std::vector<double>>;
using Vector = std::vector<double>;

template <class Real>
class RippleCovarianceOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(RippleCovarianceOf, Precisions);

/// Relative to the matrix' size.
template <class Real>
constexpr double tolerance = sizeof(Real) == 4 ? 1e-5 : 1e-12;

constexpr std::size_t pairs[] = {1, 2, 3, 5, 7};
constexpr std::uint64_t seeds[] = {1, 2, 3};

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

/// T's is 1.
Vector random_regressors(std::size_t states, Random& random) {
  Vector h(states, 1.0);
  for (std::size_t i = 1; i < states; ++i) {
    h[i] = random.uniform();
  }
  return h;
}

/// Factors with room for seven pairs, used by less, and the same as a matrix.
template <class Real>
struct Example {
  static constexpr std::size_t max_pairs = 7;

  std::size_t states;
  std::size_t count;
  Random random;
  Matrix dense;
  Vector h;
  RippleCovariance<Real, max_pairs> p;

  Example(std::size_t pair_count, std::uint64_t seed)
      : states(1 + 2 * pair_count),
        count(2 * pair_count),
        random(100 * pair_count + seed),
        dense(random_covariance(states, random)),
        h(random_regressors(states, random)),
        p(factored<Real, max_pairs>(dense, states)) {}

  [[nodiscard]] double element(std::size_t i, std::size_t j) const {
    return static_cast<double>(strainwave::detail::covariance_of(p, count, i, j));
  }
  void expect_dense(const char* what) const {
    double largest = 0.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < states; ++i) {
      for (std::size_t j = 0; j < states; ++j) {
        largest = std::fmax(largest, std::fabs(dense[i][j]));
        worst = std::fmax(worst, std::fabs(element(i, j) - dense[i][j]));
      }
    }
    EXPECT_LT(worst, tolerance<Real> * std::fmax(largest, 1.0)) << what << ", " << states;
  }
};

/// Every operation for each size and seed.
template <class Real, class Check>
void for_examples(const Check& check) {
  for (const std::size_t pair_count : pairs) {
    for (const std::uint64_t seed : seeds) {
      Example<Real> example(pair_count, seed);
      check(example);
    }
  }
}

TYPED_TEST(RippleCovarianceOf, ElementsAreThoseOfLDL) {
  for_examples<TypeParam>([](Example<TypeParam>& its) {
    its.expect_dense("elements");
    for (std::size_t i = 0; i < its.count; ++i) {
      EXPECT_NEAR(static_cast<double>(strainwave::detail::variance_of(its.p, i)),
                  its.dense[i + 1][i + 1], tolerance<TypeParam>);
    }
  });
}

TYPED_TEST(RippleCovarianceOf, UncorrelatedIsADiagonal) {
  using Real = TypeParam;
  Example<Real> its(3, 1);
  strainwave::detail::set_uncorrelated(its.p, Real(4));
  for (std::size_t i = 0; i < its.states; ++i) {
    for (std::size_t j = 0; j < its.states; ++j) {
      EXPECT_EQ(its.element(i, j), i == j && i > 0 ? 4.0 : 0.0);
    }
  }
}

TYPED_TEST(RippleCovarianceOf, ProjectionIsLTransposedH) {
  // (L' h)' D (L' h) = h' P h for every h, and for a unit vector L's own row.
  using Real = TypeParam;
  for_examples<Real>([](Example<Real>& its) {
    Real h[14] = {};
    Real projected[14] = {};
    double expected = 0.0;
    for (std::size_t i = 0; i < its.count; ++i) {
      h[i] = static_cast<Real>(its.h[i + 1]);
      for (std::size_t j = 0; j < its.count; ++j) {
        expected += its.h[i + 1] * its.dense[i + 1][j + 1] * its.h[j + 1];
      }
    }
    strainwave::detail::project(its.p, its.count, h, projected);
    double found = 0.0;
    for (std::size_t j = 0; j < its.count; ++j) {
      found += static_cast<double>(projected[j]) * static_cast<double>(projected[j]) *
               static_cast<double>(its.p.variances_Nm2[j]);
    }
    EXPECT_NEAR(found / expected, 1.0, tolerance<Real>);
    for (std::size_t i = 0; i < its.count; ++i) {
      Real unit[14] = {};
      unit[i] = Real(1);
      strainwave::detail::project(its.p, its.count, unit, projected);
      for (std::size_t j = 0; j < its.count; ++j) {
        Real expected_element = i == j ? Real(1) : Real(0);
        if (i > j) {
          expected_element = strainwave::detail::column_of(its.p, j)[i - j - 1];
        }
        EXPECT_EQ(projected[j], expected_element);
      }
    }
  });
}

TYPED_TEST(RippleCovarianceOf, AddedVarianceIsOnTheDiagonalAlone) {
  using Real = TypeParam;
  for (const double variance : {0.0, 1e-4, 0.3, 50.0}) {
    for_examples<Real>([variance](Example<Real>& its) {
      for (std::size_t i = 0; i < its.count; ++i) {
        strainwave::detail::add_variance(its.p, its.count, i, static_cast<Real>(variance));
        its.dense[i + 1][i + 1] += variance;
        its.expect_dense("added");
      }
    });
  }
}

TYPED_TEST(RippleCovarianceOf, VarianceIsAddedToNothing) {
  using Real = TypeParam;
  for (const std::size_t pair_count : pairs) {
    Example<Real> its(pair_count, 1);
    its.p = {};
    its.dense = Matrix(its.states, Vector(its.states));
    its.expect_dense("nothing");
    for (std::size_t i = its.count; i-- > 0;) {
      strainwave::detail::add_variance(its.p, its.count, i, Real(0));
      its.expect_dense("nothing to nothing");
      strainwave::detail::add_variance(its.p, its.count, i, Real(0.7));
      its.dense[i + 1][i + 1] = static_cast<double>(Real(0.7));
      its.expect_dense("something to nothing");
    }
  }
}

TYPED_TEST(RippleCovarianceOf, VarianceIsAddedBesideAPivotOfNothing) {
  // Coefficient 1 is known for sure, 2 and T go with 0: what 0 gains, 2 and T gain with it, and L
  // has no element for it in column 1.
  using Real = TypeParam;
  for (const bool by_zero : {false, true}) {
    Example<Real> its(2, 1);
    its.p = {};
    const Real pivots[4] = {Real(1), Real(0), Real(0.5), Real(0.25)};
    for (std::size_t j = 0; j < 4; ++j) {
      its.p.variances_Nm2[j] = pivots[j];
    }
    its.p.torque_variance_Nm2 = Real(0.1);
    strainwave::detail::column_of(its.p, 0)[0] = by_zero ? Real(0) : Real(0.5);
    strainwave::detail::column_of(its.p, 0)[1] = Real(0.5);
    its.p.torque_row[0] = Real(-0.5);
    for (std::size_t i = 0; i < its.states; ++i) {
      for (std::size_t j = 0; j < its.states; ++j) {
        its.dense[i][j] = its.element(i, j);
      }
    }
    strainwave::detail::add_variance(its.p, its.count, 0, Real(1));
    its.dense[1][1] += 1.0;
    its.expect_dense("beside nothing");
  }
}

TYPED_TEST(RippleCovarianceOf, AScaledDeviationKeepsCorrelations) {
  using Real = TypeParam;
  for (const double scale : {0.03, 0.9, 7.0}) {
    for_examples<Real>([scale](Example<Real>& its) {
      for (std::size_t i = 0; i < its.count; ++i) {
        strainwave::detail::scale_deviation(its.p, its.count, i, static_cast<Real>(scale));
        for (std::size_t j = 0; j < its.states; ++j) {
          its.dense[i + 1][j] *= scale;
          its.dense[j][i + 1] *= scale;
        }
        its.expect_dense("scaled");
      }
    });
  }
}

TYPED_TEST(RippleCovarianceOf, AMeasurementIsKalmansUpdate) {
  using Real = TypeParam;
  for (const double noise : {1e-3, 0.2, 30.0}) {
    for_examples<Real>([noise](Example<Real>& its) {
      for (int round = 0; round < 4; ++round) {
        its.h = random_regressors(its.states, its.random);
        Vector ph(its.states);
        double variance = noise;
        for (std::size_t i = 0; i < its.states; ++i) {
          for (std::size_t j = 0; j < its.states; ++j) {
            ph[i] += its.dense[i][j] * its.h[j];
          }
          variance += its.h[i] * ph[i];
        }
        Real h[15] = {};
        Real projected[14] = {};
        Real gains[15] = {};
        for (std::size_t i = 0; i < its.states; ++i) {
          h[i] = static_cast<Real>(its.h[i]);
        }
        strainwave::detail::project(its.p, its.count, h + 1, projected);
        const Real found = strainwave::detail::measure(its.p, its.count, projected,
                                                       static_cast<Real>(noise), gains);
        EXPECT_NEAR(static_cast<double>(found) / variance, 1.0, tolerance<Real>);
        for (std::size_t i = 0; i < its.states; ++i) {
          EXPECT_NEAR(static_cast<double>(gains[i]), ph[i] / variance, 10 * tolerance<Real>);
          for (std::size_t j = 0; j < its.states; ++j) {
            its.dense[i][j] -= ph[i] * ph[j] / variance;
          }
        }
        its.expect_dense("measured");
        EXPECT_GT(its.p.torque_variance_Nm2, Real(0));
        for (std::size_t j = 0; j < its.count; ++j) {
          EXPECT_GT(its.p.variances_Nm2[j], Real(0));
        }
      }
    });
  }
}

TYPED_TEST(RippleCovarianceOf, TwoThatCannotBeToldApartKeepTheirSign) {
  // Measured by their sum alone: its variance falls by eight decades, that of their difference not.
  using Real = TypeParam;
  RippleCovariance<Real, 1> p;
  strainwave::detail::set_uncorrelated(p, Real(4));
  const Real h[2] = {Real(0.6), Real(0.6)};
  Real projected[2] = {};
  Real gains[3] = {};
  for (int k = 0; k < 1000; ++k) {
    strainwave::detail::project(p, std::size_t{2}, h, projected);
    (void)strainwave::detail::measure(p, std::size_t{2}, projected, Real(1e-4), gains);
  }
  EXPECT_EQ(p.torque_variance_Nm2, Real(0));
  strainwave::detail::project(p, std::size_t{2}, h, projected);
  double sum = 0.0;
  for (std::size_t j = 0; j < 2; ++j) {
    ASSERT_GT(p.variances_Nm2[j], Real(0));
    sum += static_cast<double>(projected[j] * projected[j] * p.variances_Nm2[j]);
  }
  EXPECT_NEAR(sum / 1e-7, 1.0, sizeof(Real) == 4 ? 0.01 : 1e-6);  // the mean of 1000
  EXPECT_NEAR(strainwave::detail::variance_of(p, 0), 2.0, 1e-3);
  EXPECT_NEAR(strainwave::detail::variance_of(p, 1), 2.0, 1e-3);
}

TYPED_TEST(RippleCovarianceOf, ResultsDoNotDependOnTheCapacity) {
  using Real = TypeParam;
  constexpr std::size_t states = 7;
  Random random(11);
  const Matrix dense = random_covariance(states, random);
  auto exact = factored<Real, 3>(dense, states);
  auto large = factored<Real, 32>(dense, states);
  const auto step = [](auto& p, const Vector& with, std::size_t i, Real* gains) {
    Real h[states] = {};
    Real projected[states - 1] = {};
    for (std::size_t j = 0; j < states; ++j) {
      h[j] = static_cast<Real>(with[j]);
    }
    strainwave::detail::add_variance(p, states - 1, i, Real(0.01));
    strainwave::detail::scale_deviation(p, states - 1, (i + 2) % (states - 1), Real(0.97));
    p.torque_variance_Nm2 += Real(0.003);
    strainwave::detail::project(p, states - 1, h + 1, projected);
    return strainwave::detail::measure(p, states - 1, projected, Real(0.1), gains);
  };
  for (std::size_t k = 0; k < 200; ++k) {
    const Vector h = random_regressors(states, random);
    Real gains[2][states] = {};
    ASSERT_EQ(step(exact, h, k % (states - 1), gains[0]),
              step(large, h, k % (states - 1), gains[1]));
    for (std::size_t i = 0; i < states; ++i) {
      ASSERT_EQ(gains[0][i], gains[1][i]);
      for (std::size_t j = 0; j < states; ++j) {
        ASSERT_EQ(strainwave::detail::covariance_of(exact, states - 1, i, j),
                  strainwave::detail::covariance_of(large, states - 1, i, j));
      }
    }
  }
}

}  // namespace
