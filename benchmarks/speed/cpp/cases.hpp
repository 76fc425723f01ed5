// SPDX-License-Identifier: Apache-2.0
/// @file cases.hpp
/// What each file of cases adds to its program.
#pragma once

#include "case.hpp"

namespace speed {

void add_core(Cases& cases);
void add_series(Cases& cases);
void add_states(Cases& cases);
void add_published_eigen(Cases& cases);
void add_default_eigen(Cases& cases);
void add_sequential(Cases& cases);
void add_batch(Cases& cases);
void add_long(Cases& cases);
void add_issue(Cases& cases);

}  // namespace speed
