// SPDX-License-Identifier: Apache-2.0
#include "bind_gains.hpp"

#include <nanobind/stl/vector.h>

namespace strainwave::bindings {

using namespace nb::literals;

GainsD make_gains(const std::vector<double>& values) {
  if (values.empty() || values.size() > most_gauges) {
    raise_input_error("gains has " + std::to_string(values.size()) + " elements: expected 1 to " +
                      std::to_string(most_gauges) + ", one a gauge; give a list of that length");
  }
  GainsD gains;
  gains.count = values.size();
  for (std::size_t j = 0; j < values.size(); ++j) {
    gains.values[j] = values[j];
  }
  require(check(gains));
  return gains;
}

void bind_gains(nb::module_& m) {
  nb::class_<GainsD>(m, "Gains", "Per-gauge gains and their weighted sum.")
      .def(
          "__init__",
          [](GainsD* self, const nb::handle& list) {
            const auto values = to_vector<double>(list, "gains");
            new (self) GainsD(make_gains({values.data(), values.data() + values.size()}));
          },
          "values"_a.none(), nb::sig("def __init__(self, values: numpy.typing.ArrayLike) -> None"))
      .def("__repr__", [](const nb::handle& self) { return repr_of(self, {"values"}); })
      .def_prop_ro("values",
                   [](const GainsD& self) {
                     return std::vector<double>(self.values, self.values + self.count);
                   })
      .def_prop_ro("noise_factor", &noise_factor<double, most_gauges>,
                   "M sum(g^2) / (sum g)^2: 1 for equal gains, never below.")
      .def(
          "weighted_sum",
          [](const GainsD& self, const nb::handle& values) {
            const auto signals = to_matrix<double>(values, "signals");
            require_same_length("signals' second axis", signals.shape(1), "the gains", self.count);
            FilledVector<double> out(signals.shape(0));
            for (std::size_t k = 0; k < signals.shape(0); ++k) {
              out.data()[k] = weighted_sum(self, signals.data() + k * self.count);
            }
            return out.give();
          },
          "signals"_a.none(),
          nb::sig("def weighted_sum(self, signals: numpy.typing.ArrayLike) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "sum_j g_j e_j of signals with the shape (samples, gauges). Godler 2000, eq. (7).");
}

}  // namespace strainwave::bindings
