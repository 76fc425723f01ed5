// SPDX-License-Identifier: Apache-2.0
/// @file bind_gains.hpp
/// Gains from a Python list, for the gains themselves and for the sensor's configuration.
#pragma once

#include <vector>

#include "common.hpp"
#include "strainwave/gains.hpp"

namespace strainwave::bindings {

using GainsD = Gains<double, most_gauges>;

[[nodiscard]] GainsD make_gains(const std::vector<double>& values);

}  // namespace strainwave::bindings
