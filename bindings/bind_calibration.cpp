// SPDX-License-Identifier: Apache-2.0
#include "strainwave/calibration.hpp"

#include <nanobind/stl/vector.h>

#include <vector>

#include "common.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

using CalibrationD = TorqueCalibration<double>;

constexpr std::size_t most_coefficients = highest_linearisation_power - 1;

}  // namespace

void bind_calibration(nb::module_& m) {
  constexpr CalibrationD standard;
  nb::class_<CalibrationD>(m, "TorqueCalibration",
                           "From volts to torque: gain, zero, linearisation, temperature.")
      .def(
          "__init__",
          [](CalibrationD* self, const nb::handle& gain_Nm_per_V, const nb::handle& zero_V,
             const nb::handle& full_scale_Nm, const nb::handle& coefficients,
             const nb::handle& reference_temperature_degC, const nb::handle& zero_drift_V_per_K,
             const nb::handle& gain_drift_per_K, const nb::handle& minimum_temperature_degC,
             const nb::handle& maximum_temperature_degC) {
            const auto linearisation = to_vector<double>(coefficients, "linearisation");
            if (linearisation.size() > most_coefficients) {
              raise_input_error("linearisation has " + std::to_string(linearisation.size()) +
                                " elements: expected at most " + std::to_string(most_coefficients) +
                                ", c_2 to c_5; shorten the list");
            }
            CalibrationD calibration{
                to_real_number(gain_Nm_per_V, "gain_Nm_per_V"),
                to_real_number(zero_V, "zero_V"),
                to_real_number(full_scale_Nm, "full_scale_Nm"),
                {},
                to_real_number(reference_temperature_degC, "reference_temperature_degC"),
                to_real_number(zero_drift_V_per_K, "zero_drift_V_per_K"),
                to_real_number(gain_drift_per_K, "gain_drift_per_K"),
                to_real_number(minimum_temperature_degC, "minimum_temperature_degC"),
                to_real_number(maximum_temperature_degC, "maximum_temperature_degC")};
            for (std::size_t n = 0; n < linearisation.size(); ++n) {
              calibration.linearisation[n] = linearisation.data()[n];
            }
            require(check(calibration));
            new (self) CalibrationD(calibration);
          },
          nb::kw_only(), "gain_Nm_per_V"_a.none(), "zero_V"_a.none() = standard.zero_V,
          "full_scale_Nm"_a.none() = standard.full_scale_Nm,
          "linearisation"_a.none() = nb::make_tuple(),
          "reference_temperature_degC"_a.none() = standard.reference_temperature_degC,
          "zero_drift_V_per_K"_a.none() = standard.zero_drift_V_per_K,
          "gain_drift_per_K"_a.none() = standard.gain_drift_per_K,
          "minimum_temperature_degC"_a.none() = standard.minimum_temperature_degC,
          "maximum_temperature_degC"_a.none() = standard.maximum_temperature_degC,
          nb::sig("def __init__(self, *, gain_Nm_per_V: float, zero_V: float = 0.0, full_scale_Nm: "
                  "float = 40.0, linearisation: numpy.typing.ArrayLike = (), "
                  "reference_temperature_degC: float = 20.0, zero_drift_V_per_K: float = 0.0, "
                  "gain_drift_per_K: float = 0.0, minimum_temperature_degC: float = -40.0, "
                  "maximum_temperature_degC: float = 120.0) -> None"),
          "linearisation: c_2, c_3, ..., dimensionless; torque = u + FS sum_n c_n (u/FS)^n with "
          "u = gain (volts - zero).")
      .def("__repr__",
           [](const nb::handle& self) {
             return repr_of(self,
                            {"gain_Nm_per_V", "zero_V", "full_scale_Nm", "linearisation",
                             "reference_temperature_degC", "zero_drift_V_per_K", "gain_drift_per_K",
                             "minimum_temperature_degC", "maximum_temperature_degC"});
           })
      .def_ro("gain_Nm_per_V", &CalibrationD::gain_Nm_per_V)
      .def_ro("zero_V", &CalibrationD::zero_V)
      .def_ro("full_scale_Nm", &CalibrationD::full_scale_Nm)
      .def_prop_ro("linearisation",
                   [](const CalibrationD& self) {
                     return std::vector<double>(self.linearisation,
                                                self.linearisation + most_coefficients);
                   })
      .def_ro("reference_temperature_degC", &CalibrationD::reference_temperature_degC)
      .def_ro("zero_drift_V_per_K", &CalibrationD::zero_drift_V_per_K)
      .def_ro("gain_drift_per_K", &CalibrationD::gain_drift_per_K)
      .def_ro("minimum_temperature_degC", &CalibrationD::minimum_temperature_degC)
      .def_ro("maximum_temperature_degC", &CalibrationD::maximum_temperature_degC)
      .def(
          "torque_Nm",
          [](const CalibrationD& self, const nb::handle& signal_V, const nb::handle& temperatures) {
            const auto volts = to_vector<double>(signal_V, "volts");
            const auto temperature_degC = to_vector<double>(temperatures, "temperature_degC");
            require_same_length("temperature_degC", temperature_degC.shape(0), "volts",
                                volts.shape(0));
            FilledVector<double> out(volts.shape(0));
            for (std::size_t k = 0; k < volts.shape(0); ++k) {
              out.data()[k] = torque_of_volts_Nm(self, volts.data()[k], temperature_degC.data()[k]);
            }
            return out.give();
          },
          "volts"_a.none(), "temperature_degC"_a.none(),
          nb::sig("def torque_Nm(self, volts: numpy.typing.ArrayLike, temperature_degC: "
                  "numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]"),
          "Torque of the gauges' weighted sum, Nm.");
}

}  // namespace strainwave::bindings
