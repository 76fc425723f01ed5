// SPDX-License-Identifier: Apache-2.0
// The default ripple filter's equations with 15 states in Eigen's matrices of fixed size.  Checks
// of the sample, gaps, delays and frozen terms are left out, in this peer's favour.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cases.hpp"

namespace speed {

namespace {

constexpr int pairs = 7;
constexpr int size = 1 + 2 * pairs;
/// First pair of each order, and one past the last.
constexpr std::array<int, 4> first_pair = {0, 3, 6, 7};
constexpr std::array<double, 3> orders = {2.0, 4.0, 0.01};

template <class Real>
class DenseRipple {
 public:
  Real step(Real torque_Nm, double motor_angle_rad) {
    const Real rotation_rad = started_ ? static_cast<Real>(motor_angle_rad - last_angle_rad_) : 0;
    last_angle_rad_ = motor_angle_rad;
    speed_ += share(Real(0.01)) * (rotation_rad / interval_s - speed_);
    smoothed_speed_ += share(Real(0.05)) * (rotation_rad / interval_s - smoothed_speed_);
    const bool moving = std::abs(smoothed_speed_) >= Real(2);
    const Waves waves = waves_at(motor_angle_rad);
    set_regressors(waves);
    const Real ripple_Nm = h_.template tail<size - 1>().dot(x_.template tail<size - 1>());
    const Real rest_Nm = torque_Nm - ripple_Nm;
    if (started_) {
      P_(0, 0) += walk_Nm2_per_s * interval_s;
      if (moving) {
        add_noise(waves, rotation_rad);
      }
      const Real innovation_Nm = rest_Nm - x_(0);
      update(innovation_Nm, moving);
      if (moving) {
        track_scale(innovation_Nm, rotation_rad);
      }
      load_Nm_ += share(Real(1 / (2 * std::numbers::pi * 15))) * (rest_Nm - load_Nm_);
    } else {
      start(rest_Nm);
    }
    last_waves_ = waves;
    return ripple_Nm;
  }

 private:
  using Vector = Eigen::Matrix<Real, size, 1>;
  using Matrix = Eigen::Matrix<Real, size, size>;
  using Waves = Eigen::Matrix<Real, 2, 3>;

  static constexpr Real interval_s = static_cast<Real>(sample_period_s);
  static constexpr Real noise_Nm2 = Real(0.04 * 0.04);
  static constexpr Real walk_Nm2_per_s = Real(1.3 * 1.3);
  static constexpr Real initial_Nm2 = Real(4);
  static constexpr Real memory_rad = Real(2 * std::numbers::pi * 300);

  static constexpr Real share(Real time_constant_s) {
    return interval_s / (interval_s + time_constant_s);
  }

  static Waves waves_at(double motor_angle_rad) {
    Waves waves;
    for (int a = 0; a < 3; ++a) {
      const double turns =
          orders[static_cast<std::size_t>(a)] * motor_angle_rad / (2 * std::numbers::pi);
      const Real angle =
          static_cast<Real>((turns - std::floor(turns + 0.5)) * 2 * std::numbers::pi);
      waves.col(a) << std::cos(angle), std::sin(angle);
    }
    return waves;
  }

  void set_regressors(const Waves& waves) {
    const Real load = load_Nm_ / Real(40);
    const Real factors[] = {Real(1), load / (Real(1) + std::abs(load)),
                            std::abs(speed_) / Real(150)};
    int i = 1;
    for (int a = 0; a < 3; ++a) {
      for (int f = 0; i < 1 + 2 * first_pair[static_cast<std::size_t>(a) + 1]; ++f, i += 2) {
        h_.template segment<2>(i) = factors[f] * waves.col(a);
      }
    }
  }

  void start(Real torque_Nm) {
    started_ = true;
    x_(0) = torque_Nm;
    load_Nm_ = torque_Nm;
    const auto h = h_.template tail<size - 1>();
    P_.row(0).template tail<size - 1>() = -initial_Nm2 * h.transpose();
    P_.col(0).template tail<size - 1>() = -initial_Nm2 * h;
    P_(0, 0) = noise_Nm2 + initial_Nm2 * h.squaredNorm();
  }

  void add_noise(const Waves& waves, Real rotation_rad) {
    Eigen::Matrix<Real, pairs, 1> gained = Eigen::Matrix<Real, pairs, 1>::Zero();
    const Real share_of_memory = rotation_rad * rotation_rad / (memory_rad * memory_rad);
    for (int a = 0; a < 3; ++a) {
      const int begin = first_pair[static_cast<std::size_t>(a)];
      const int count = first_pair[static_cast<std::size_t>(a) + 1] - begin;
      const Real chord = (waves.col(a) - last_waves_.col(a)).squaredNorm();
      if (chord > Real(0)) {
        gained.segment(begin, count).array() = Real(2) * share_of_memory *
                                               (noise_Nm2 + walk_Nm2_per_s * interval_s / chord) /
                                               h_.segment(1 + 2 * begin, 2 * count).squaredNorm();
      }
    }
    for (int i = 1; i < size; ++i) {
      if (P_(i, i) > initial_Nm2) {
        const Real shrink = std::sqrt(initial_Nm2 / P_(i, i));
        P_.row(i) *= shrink;
        P_.col(i) *= shrink;
      }
      P_(i, i) += gained((i - 1) / 2);
    }
  }

  void update(Real innovation_Nm, bool moving) {
    Vector seen = P_ * h_;
    Real variance = h_.dot(seen) + noise_Nm2;
    if (!moving) {
      const Real gain = seen(0) / variance;
      x_(0) += gain * innovation_Nm;
      P_.row(0) -= gain * seen.transpose();
      P_.col(0) -= gain * seen;
      P_(0, 0) += gain * gain * variance;
      return;
    }
    const Real ripple_variance =
        h_.template tail<size - 1>().dot((seen - P_.col(0)).template tail<size - 1>());
    const Real limit = Real(9) * std::max(scale_Nm_ * scale_Nm_, ripple_variance);
    if (innovation_Nm * innovation_Nm > limit) {
      const Real jump = variance * (innovation_Nm * innovation_Nm / limit - Real(1));
      P_(0, 0) += jump;
      seen(0) += jump;
      variance += jump;
    }
    const Vector gain = seen / variance;
    x_ += gain * innovation_Nm;
    P_ -= gain * seen.transpose();
  }

  void track_scale(Real innovation_Nm, Real rotation_rad) {
    const Real beyond = std::abs(innovation_Nm) > scale_Nm_ ? Real(1) : Real(0);
    scale_Nm_ *=
        std::exp(Real(0.06) * std::min(std::abs(rotation_rad), Real(3)) * (beyond - Real(0.3)));
    scale_Nm_ = std::max(scale_Nm_, Real(0.02));
  }

  Vector x_ = Vector::Zero();
  Matrix P_ = initial_Nm2 * Matrix::Identity();
  Vector h_ = Vector::Unit(0);
  Waves last_waves_ = Waves::Zero();
  Real scale_Nm_ = Real(0.12);
  Real speed_ = 0;
  Real smoothed_speed_ = 0;
  Real load_Nm_ = 0;
  double last_angle_rad_ = 0;
  bool started_ = false;
};

template <class Real>
Case dense(const Recording& recording, const Options& /*options*/) {
  return single_channel(std::vector<Real>(recording.samples()),
                        [torque = converted<Real>(recording.torque_Nm),
                         angle = recording.motor_angle_rad](std::size_t samples, Real* ripple_Nm) {
                          DenseRipple<Real> filter;
                          for (std::size_t k = 0; k < samples; ++k) {
                            ripple_Nm[k] = filter.step(torque[k], angle[k]);
                          }
                        });
}

}  // namespace

void add_default_eigen(Cases& cases) {
  cases["default_eigen_float"] = dense<float>;
  cases["default_eigen_double"] = dense<double>;
}

}  // namespace speed
