// SPDX-License-Identifier: Apache-2.0
/// @file bind_gauge_monitor.hpp
/// The gauge monitor's types with the capacity that Python holds.
#pragma once

#include "common.hpp"
#include "strainwave/gauge_monitor_config.hpp"

namespace strainwave::bindings {

using ConsistencyD = ConsistencyCheck<double, most_gauges>;
using MonitorConfigD = GaugeMonitorConfig<double, most_gauges>;

}  // namespace strainwave::bindings
