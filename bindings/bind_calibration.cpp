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
          [](CalibrationD* self, double gain_Nm_per_V, double zero_V, double full_scale_Nm,
             const std::vector<double>& linearisation, double reference_temperature_degC,
             double zero_drift_V_per_K, double gain_drift_per_K, double minimum_temperature_degC,
             double maximum_temperature_degC) {
            if (linearisation.size() > most_coefficients) {
              raise_input_error("linearisation has " + std::to_string(linearisation.size()) +
                                " elements: expected at most " + std::to_string(most_coefficients) +
                                ", c_2 to c_5; shorten the list");
            }
            CalibrationD calibration{gain_Nm_per_V,
                                     zero_V,
                                     full_scale_Nm,
                                     {},
                                     reference_temperature_degC,
                                     zero_drift_V_per_K,
                                     gain_drift_per_K,
                                     minimum_temperature_degC,
                                     maximum_temperature_degC};
            for (std::size_t n = 0; n < linearisation.size(); ++n) {
              calibration.linearisation[n] = linearisation[n];
            }
            require(check(calibration));
            new (self) CalibrationD(calibration);
          },
          nb::kw_only(), "gain_Nm_per_V"_a, "zero_V"_a = standard.zero_V,
          "full_scale_Nm"_a = standard.full_scale_Nm, "linearisation"_a = std::vector<double>{},
          "reference_temperature_degC"_a = standard.reference_temperature_degC,
          "zero_drift_V_per_K"_a = standard.zero_drift_V_per_K,
          "gain_drift_per_K"_a = standard.gain_drift_per_K,
          "minimum_temperature_degC"_a = standard.minimum_temperature_degC,
          "maximum_temperature_degC"_a = standard.maximum_temperature_degC,
          "linearisation: c_2, c_3, ..., dimensionless; torque = u + FS sum_n c_n (u/FS)^n with "
          "u = gain (volts - zero).")
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
          [](const CalibrationD& self, const Vector<double>& volts,
             const Vector<double>& temperature_degC) {
            require_same_length("temperature_degC", temperature_degC.shape(0), "volts",
                                volts.shape(0));
            NewVector<double> out(volts.shape(0));
            for (std::size_t k = 0; k < volts.shape(0); ++k) {
              out.data()[k] = torque_of_volts_Nm(self, volts.data()[k], temperature_degC.data()[k]);
            }
            return out.give();
          },
          "volts"_a, "temperature_degC"_a, "Torque of the gauges' weighted sum, Nm.");
}

}  // namespace strainwave::bindings
