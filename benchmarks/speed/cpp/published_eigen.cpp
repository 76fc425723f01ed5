// SPDX-License-Identifier: Apache-2.0
// The published filter as one writes it with Eigen's matrices of fixed size: dense, no checks.
#include <Eigen/Dense>
#include <cmath>

#include "cases.hpp"

namespace speed {

namespace {

template <class Real>
struct DenseFilter {
  using Matrix = Eigen::Matrix<Real, 6, 6>;
  using Vector = Eigen::Matrix<Real, 6, 1>;

  Vector state = Vector::Zero();
  Matrix covariance = Real(1e3) * Matrix::Identity();
  Matrix turn = Matrix::Zero();

  Real step(Real torque_Nm, Real motor_speed_rad_s) {
    const Vector row = (Vector() << 1, 0, 1, 0, 1, 0).finished();
    const Real ripple_Nm = row.dot(state);
    const Vector seen = covariance * row;
    const Vector gain = seen / (row.dot(seen) + Real(1));
    state += gain * (torque_Nm - ripple_Nm);
    covariance -= gain * seen.transpose();
    constexpr Real orders[] = {Real(2), Real(4), Real(0.01)};
    for (int a = 0; a < 3; ++a) {
      const Real angle = orders[a] * static_cast<Real>(sample_period_s) * motor_speed_rad_s;
      const Real cosine = std::cos(angle);
      const Real sine = std::sin(angle);
      turn.template block<2, 2>(2 * a, 2 * a) << cosine, sine, -sine, cosine;
    }
    state = turn * state;
    covariance = turn * covariance * turn.transpose() + Real(1e3) * Matrix::Identity();
    return ripple_Nm;
  }
};

template <class Real>
Case dense(const Recording& recording, const Options& /*options*/) {
  return single_channel(
      std::vector<Real>(recording.samples()),
      [torque = converted<Real>(recording.torque_Nm),
       speed = converted<Real>(recording.motor_speed_rad_s)](std::size_t samples, Real* ripple_Nm) {
        DenseFilter<Real> filter;
        for (std::size_t k = 0; k < samples; ++k) {
          ripple_Nm[k] = filter.step(torque[k], speed[k]);
        }
      });
}

}  // namespace

void add_published_eigen(Cases& cases) {
  cases["published_eigen_float"] = dense<float>;
  cases["published_eigen_double"] = dense<double>;
}

}  // namespace speed
