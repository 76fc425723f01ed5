// SPDX-License-Identifier: Apache-2.0
#include <nanobind/operators.h>

#include "common.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

Phase checked_phase(double turns, const char* parameter, double value, const char* unit) {
  require(is_representable_angle(turns * two_pi<double>)
              ? Violation<double>{}
              : Violation<double>{parameter, -1, value, unit, "a finite angle within 2^40 turns"});
  return phase_from_turns(turns);
}

}  // namespace

void bind_units(nb::module_& m) {
  nb::class_<Rational>(m, "Rational",
                       "A positive ratio of whole numbers: a gear ratio, or an order in cycles per "
                       "motor turn.")
      .def(
          "__init__",
          [](Rational* self, const nb::handle& value) {
            new (self) Rational(to_valid_rational(value, "value", ""));
          },
          "value"_a.none(),
          nb::sig("def __init__(self, value: float | numbers.Rational | Rational) -> None"),
          "From an int, a fractions.Fraction, or the simplest ratio within 1e-12 of a float.")
      .def_ro("numerator", &Rational::numerator)
      .def_ro("denominator", &Rational::denominator)
      .def("inverse", &inverse, "The ratio with numerator and denominator exchanged.")
      .def("__float__", &to_real<double>)
      .def(
          "__mul__",
          [](Rational a, Rational b) {
            return require_representable(multiply(a, b), "the product");
          },
          nb::is_operator())
      .def(nb::self == nb::self)
      .def("__hash__",
           [](Rational self) { return (std::uint64_t{self.numerator} << 31U) ^ self.denominator; })
      .def("__str__",
           [](Rational self) {
             return self.denominator == 1
                        ? std::to_string(self.numerator)
                        : std::to_string(self.numerator) + "/" + std::to_string(self.denominator);
           })
      .def("__repr__", [](Rational self) {
        return "Rational(" + std::to_string(self.numerator) + "/" +
               std::to_string(self.denominator) + ")";
      });

  nb::class_<Phase>(m, "Phase",
                    "Angle of a shaft: whole turns and a fraction in units of 2^-32 turn, which "
                    "loses nothing however long a joint runs.")
      .def(
          "__init__",
          [](Phase* self, std::int64_t turns, std::uint32_t fraction) {
            new (self) Phase{turns, fraction};
          },
          "turns"_a = 0, "fraction"_a = 0)
      .def_static(
          "from_radians",
          [](double angle_rad) {
            return checked_phase(angle_rad / two_pi<double>, "angle_rad", angle_rad, "rad");
          },
          "angle_rad"_a)
      .def_static(
          "from_turns", [](double turns) { return checked_phase(turns, "turns", turns, "turns"); },
          "turns"_a)
      .def_static(
          "from_counts",
          [](std::int64_t counts, std::uint32_t counts_per_turn) {
            require(counts_per_turn > 0
                        ? Violation<double>{}
                        : Violation<double>{"counts_per_turn", -1, 0.0, "counts", "at least 1"});
            return phase_from_counts(counts, counts_per_turn);
          },
          "counts"_a, "counts_per_turn"_a, "Exact to half a unit, for any number of counts a turn.")
      .def_ro("turns", &Phase::turns)
      .def_ro("fraction", &Phase::fraction)
      .def("to_radians", &to_radians<double>)
      .def("to_turns", &to_turns<double>)
      .def(
          "order_fraction",
          [](Phase self, const nb::handle& order) {
            return order_fraction(self, to_valid_rational(order, "order", "cycles per turn"));
          },
          "order"_a,
          nb::sig("def order_fraction(self, order: float | numbers.Rational | Rational) -> int"),
          "order x angle modulo one cycle, in units of 2^-32 cycle; exact for any number of turns.")
      .def(nb::self + nb::self)
      .def(nb::self - nb::self)
      .def(nb::self == nb::self)
      .def("__hash__",
           [](Phase self) {
             return static_cast<std::uint64_t>(self.turns) * 0x9E3779B97F4A7C15U ^ self.fraction;
           })
      .def("__repr__", [](Phase self) {
        return "Phase(turns=" + std::to_string(self.turns) +
               ", fraction=" + std::to_string(self.fraction) + ")";
      });

  nb::class_<EncoderCounter>(m, "EncoderCounter",
                             "Extends an encoder count that wraps at 32 bits to 64 bits.")
      .def(nb::init<>())
      .def("update", &EncoderCounter::update, "raw"_a,
           "Takes the next raw 32-bit count, returns the extended one.")
      .def_ro("counts", &EncoderCounter::counts);
}

}  // namespace strainwave::bindings
