// SPDX-License-Identifier: Apache-2.0
/// @file bind_status.hpp
/// Event counters as a Python dict with the flags' names.
#pragma once

#include "common.hpp"

namespace strainwave::bindings {

using CountsByName = nb::typed<nb::dict, nb::str, nb::int_>;

[[nodiscard]] CountsByName counts_by_name(const EventCounters& counters);

}  // namespace strainwave::bindings
