// SPDX-License-Identifier: Apache-2.0
#include "common.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

/// An object whose step() does nothing: what is left of a filter's is the call from Python.
struct EmptyStep {};

}  // namespace

void bind_empty_step(nb::module_& m) {
  nb::class_<EmptyStep>(m, "_EmptyStep", "The measure of step(): the same call, and no arithmetic.")
      .def(nb::init<>())
      .def(
          "step",
          [](EmptyStep& /*self*/, double torque_Nm, double /*motion*/) { return torque_Nm; },
          "torque_Nm"_a, "motion"_a);
}

}  // namespace strainwave::bindings
