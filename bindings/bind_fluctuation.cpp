// SPDX-License-Identifier: Apache-2.0
#include "strainwave/fluctuation.hpp"

#include <nanobind/stl/pair.h>

#include "common.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

using Gauge = GaugeFluctuation<double, most_harmonics>;

Gauge make_gauge(const nb::handle& amplitude_list, const nb::handle& phase_error_list,
                 const nb::handle& position_rad, const nb::handle& factor) {
  const auto amplitudes = to_vector<double>(amplitude_list, "amplitudes");
  const auto phase_errors_rad = to_vector<double>(phase_error_list, "phase_errors_rad");
  require_same_length("phase_errors_rad", phase_errors_rad.size(), "amplitudes", amplitudes.size());
  if (amplitudes.size() < 1 || amplitudes.size() > most_harmonics) {
    raise_input_error("amplitudes has " + std::to_string(amplitudes.size()) +
                      " elements: expected 1 to " + std::to_string(most_harmonics) +
                      ", one a harmonic; give a list of that length");
  }
  Gauge gauge;
  gauge.harmonic_count = amplitudes.size();
  for (std::size_t i = 0; i < amplitudes.size(); ++i) {
    gauge.harmonics[i] = {amplitudes.data()[i], phase_errors_rad.data()[i]};
  }
  gauge.position_rad = to_real_number(position_rad, "position_rad");
  gauge.wave_factor = to_valid_rational(factor, "wave_factor", "wave turns per motor turn");
  require(check(gauge));
  return gauge;
}

}  // namespace

void bind_fluctuation(nb::module_& m) {
  nb::class_<Gauge>(m, "GaugeFluctuation",
                    "Signal fluctuation of one gauge. Godler 2000, eq. (3) to (8); Taghirad & "
                    "Belanger 1999, eq. (2) and (3).")
      .def(
          "__init__",
          [](Gauge* self, const nb::handle& amplitudes, const nb::handle& phase_errors_rad,
             const nb::handle& position_rad, const nb::handle& factor) {
            new (self) Gauge(make_gauge(amplitudes, phase_errors_rad, position_rad, factor));
          },
          nb::kw_only(), "amplitudes"_a.none(), "phase_errors_rad"_a.none(),
          "position_rad"_a.none() = 0.0, "wave_factor"_a.none() = 1,
          nb::sig("def __init__(self, *, amplitudes: numpy.typing.ArrayLike, phase_errors_rad: "
                  "numpy.typing.ArrayLike, position_rad: float = 0.0, wave_factor: float | "
                  "numbers.Rational | Rational = 1) -> None"),
          "amplitudes: a_ij of harmonics i = 1, 2, ... in any unit; phase_errors_rad: psi_ij in "
          "the sine form. position_rad counts against the wave-generator angle.")
      .def(
          "signal",
          [](const Gauge& self, const nb::handle& angles) {
            const auto motor_angle_rad = to_vector<double>(angles, "motor_angle_rad");
            const std::size_t size = motor_angle_rad.shape(0);
            FilledVector<double> out(size);
            double* const signal = out.data();
            const double* const angle_rad = motor_angle_rad.data();
            for (std::size_t k = 0; k < size; ++k) {
              require(is_representable_angle(angle_rad[k])
                          ? Violation<double>{}
                          : Violation<double>{"motor_angle_rad", static_cast<std::int32_t>(k),
                                              angle_rad[k], "rad", "a finite angle"});
              signal[k] = signal_fluctuation(self, phase_from_radians(angle_rad[k]));
            }
            return out.give();
          },
          "motor_angle_rad"_a.none(),
          nb::sig("def signal(self, motor_angle_rad: numpy.typing.ArrayLike) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "e_j at wave-generator angles, rad; in the unit of the amplitudes.")
      .def(
          "phasor",
          [](const Gauge& self, const nb::handle& value) {
            const auto harmonic =
                to_whole_number<std::size_t>(value, "harmonic", "a whole number from 1 on");
            if (harmonic < 1 || harmonic > self.harmonic_count) {
              raise_input_error("harmonic = " + std::to_string(harmonic) + ": expected 1 to " +
                                std::to_string(self.harmonic_count) +
                                "; choose one of the gauge's harmonics");
            }
            const CosSin<double> phasor = fluctuation_phasor(self, harmonic - 1);
            return std::pair{phasor.cosine, phasor.sine};
          },
          "harmonic"_a.none(), nb::sig("def phasor(self, harmonic: int) -> tuple[float, float]"),
          "What multiplies sin(2 i m beta) and cos(2 i m beta). Godler 2000, eq. (8).");
  m.def(
      "equally_spaced_position_rad",
      [](const nb::handle& gauge_number, const nb::handle& number_of_gauges) {
        const char* const whole = "a whole number from 1 on";
        const auto gauge = to_whole_number<std::size_t>(gauge_number, "gauge", whole);
        const auto count = to_whole_number<std::size_t>(number_of_gauges, "count", whole);
        if (count < 1) {
          raise_input_error("count = 0: expected at least 1 gauge; give the number of gauges");
        }
        if (gauge < 1 || gauge > count) {
          raise_input_error("gauge = " + std::to_string(gauge) + ": expected 1 to " +
                            std::to_string(count) + ", the number of gauges; count from 1");
        }
        return equally_spaced_position_rad<double>(gauge, count);
      },
      "gauge"_a.none(), "count"_a.none(),
      nb::sig("def equally_spaced_position_rad(gauge: int, count: int) -> float"),
      "pi (j - 1) / M, the position of gauge j of M, rad.");
}

}  // namespace strainwave::bindings
