// SPDX-License-Identifier: Apache-2.0
/// @file inputs.hpp
/// The recording that the Python side wrote: files of doubles.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace speed {

inline constexpr double sample_period_s = 1e-3;

struct Recording {
  std::vector<double> torque_Nm;
  std::vector<double> motor_speed_rad_s;
  std::vector<double> motor_angle_rad;

  [[nodiscard]] std::size_t samples() const { return torque_Nm.size(); }
};

inline std::vector<double> read_doubles(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<double> values(std::filesystem::file_size(path) / sizeof(double));
  file.read(reinterpret_cast<char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(double)));
  if (!file) {
    throw std::runtime_error("cannot read " + path.string());
  }
  return values;
}

inline Recording read_recording(const std::filesystem::path& folder) {
  return {read_doubles(folder / "torque_Nm.f64"), read_doubles(folder / "motor_speed_rad_s.f64"),
          read_doubles(folder / "motor_angle_rad.f64")};
}

/// Values in another precision.
template <class Real>
std::vector<Real> converted(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

}  // namespace speed
