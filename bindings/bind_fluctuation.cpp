// SPDX-License-Identifier: Apache-2.0
#include "strainwave/fluctuation.hpp"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <vector>

#include "common.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

using Gauge = GaugeFluctuation<double, most_harmonics>;

Gauge make_gauge(const std::vector<double>& amplitudes, const std::vector<double>& phase_errors_rad,
                 double position_rad, const nb::handle& factor) {
  require_same_length("phase_errors_rad", phase_errors_rad.size(), "amplitudes", amplitudes.size());
  if (amplitudes.empty() || amplitudes.size() > most_harmonics) {
    raise_input_error("amplitudes has " + std::to_string(amplitudes.size()) +
                      " elements: expected 1 to " + std::to_string(most_harmonics) +
                      ", one a harmonic; shorten the list");
  }
  Gauge gauge;
  gauge.harmonic_count = amplitudes.size();
  for (std::size_t i = 0; i < amplitudes.size(); ++i) {
    const auto index = static_cast<std::int32_t>(i);
    if (!is_finite(amplitudes[i])) {
      require(Violation<double>{"amplitudes", index, amplitudes[i], "", "a finite number"});
    }
    if (!is_representable_angle(phase_errors_rad[i])) {
      require(Violation<double>{"phase_errors_rad", index, phase_errors_rad[i], "rad",
                                "a finite angle"});
    }
    gauge.harmonics[i] = {amplitudes[i], phase_errors_rad[i]};
  }
  if (!is_representable_angle(position_rad)) {
    require(Violation<double>{"position_rad", -1, position_rad, "rad", "a finite angle"});
  }
  gauge.position_rad = position_rad;
  gauge.wave_factor = to_valid_rational(factor, "wave_factor", "wave turns per motor turn");
  return gauge;
}

}  // namespace

void bind_fluctuation(nb::module_& m) {
  nb::class_<Gauge>(m, "GaugeFluctuation",
                    "Signal fluctuation of one gauge. Godler 2000, eq. (3) to (8); Taghirad & "
                    "Belanger 1999, eq. (2) and (3).")
      .def(
          "__init__",
          [](Gauge* self, const std::vector<double>& amplitudes,
             const std::vector<double>& phase_errors_rad, double position_rad,
             const nb::handle& factor) {
            new (self) Gauge(make_gauge(amplitudes, phase_errors_rad, position_rad, factor));
          },
          nb::kw_only(), "amplitudes"_a, "phase_errors_rad"_a, "position_rad"_a = 0.0,
          "wave_factor"_a = 1,
          nb::sig("def __init__(self, *, amplitudes: Sequence[float], phase_errors_rad: "
                  "Sequence[float], position_rad: float = 0.0, wave_factor: float | "
                  "numbers.Rational | Rational = 1) -> None"),
          "amplitudes: a_ij of harmonics i = 1, 2, ... in any unit; phase_errors_rad: psi_ij in "
          "the sine form. position_rad counts against the wave-generator angle.")
      .def(
          "signal",
          [](const Gauge& self, const Vector<double>& motor_angle_rad) {
            const std::size_t size = motor_angle_rad.shape(0);
            NewVector<double> out(size);
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
          "motor_angle_rad"_a, "e_j at wave-generator angles, rad; in the unit of the amplitudes.")
      .def(
          "phasor",
          [](const Gauge& self, std::size_t harmonic) {
            if (harmonic < 1 || harmonic > self.harmonic_count) {
              raise_input_error("harmonic = " + std::to_string(harmonic) + ": expected 1 to " +
                                std::to_string(self.harmonic_count) +
                                "; choose one of the gauge's harmonics");
            }
            const CosSin<double> phasor = fluctuation_phasor(self, harmonic - 1);
            return std::pair{phasor.cosine, phasor.sine};
          },
          "harmonic"_a,
          "What multiplies sin(2 i m beta) and cos(2 i m beta). Godler 2000, eq. (8).");
  m.def(
      "equally_spaced_position_rad",
      [](std::size_t gauge, std::size_t count) {
        if (gauge < 1 || gauge > count) {
          raise_input_error("gauge = " + std::to_string(gauge) + ": expected 1 to " +
                            std::to_string(count) + ", the number of gauges; count from 1");
        }
        return equally_spaced_position_rad<double>(gauge, count);
      },
      "gauge"_a, "count"_a, "pi (j - 1) / M, the position of gauge j of M, rad.");
}

}  // namespace strainwave::bindings
