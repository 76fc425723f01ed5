// SPDX-License-Identifier: Apache-2.0
#include "strainwave/gear.hpp"

#include <nanobind/stl/optional.h>

#include <optional>

#include "common.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

using Gear = GearConfig<double>;

/// Refuses tooth counts that are no gear's, by name.
void require_teeth(std::uint32_t flexspline_teeth, std::uint32_t circular_spline_teeth) {
  if (flexspline_teeth < 1 || flexspline_teeth > largest_rational_part) {
    require(Violation<double>{"flexspline_teeth", -1, static_cast<double>(flexspline_teeth), "",
                              "1 to 2^31 - 1 teeth"});
  }
  if (circular_spline_teeth <= flexspline_teeth) {
    require(Violation<double>{"circular_spline_teeth", -1,
                              static_cast<double>(circular_spline_teeth), "",
                              "more teeth than flexspline_teeth"});
  }
}

}  // namespace

void bind_gear(nb::module_& m) {
  nb::enum_<GearConfiguration>(m, "GearConfiguration", "Which part of the gear is fixed.")
      .value("fixed_circular_spline", GearConfiguration::fixed_circular_spline,
             "the flexspline is the output and turns against the motor")
      .value("fixed_flexspline", GearConfiguration::fixed_flexspline,
             "the circular spline is the output and turns with the motor");

  nb::class_<Gear>(m, "Gear", "A strain wave gear.")
      .def(
          "__init__",
          [](Gear* self, const nb::handle& ratio, const nb::handle& configuration_name,
             double rated_torque_Nm, std::optional<int> output_direction) {
            Gear gear;
            const auto configuration =
                to_enum<GearConfiguration>(configuration_name, "configuration");
            gear.configuration = configuration;
            gear.ratio = to_valid_rational(ratio, "ratio", "motor turns per output turn");
            gear.rated_torque_Nm = rated_torque_Nm;
            gear.output_direction = output_direction.value_or(
                configuration == GearConfiguration::fixed_circular_spline ? -1 : 1);
            require(check(gear));
            new (self) Gear(gear);
          },
          nb::kw_only(), "ratio"_a, "configuration"_a = GearConfiguration::fixed_circular_spline,
          "rated_torque_Nm"_a = Gear{}.rated_torque_Nm, "output_direction"_a = nb::none(),
          nb::sig("def __init__(self, *, ratio: float | numbers.Rational | Rational, "
                  "configuration: GearConfiguration | str = ..., "
                  "rated_torque_Nm: float = 40.0, output_direction: int | None = None) -> None"),
          "ratio is a magnitude, motor turns per output turn; the output's direction follows from "
          "the configuration unless given.")
      .def_static(
          "from_teeth",
          [](std::uint32_t flexspline_teeth, std::uint32_t circular_spline_teeth,
             GearConfiguration configuration, double rated_torque_Nm) {
            require_teeth(flexspline_teeth, circular_spline_teeth);
            const Gear gear = gear_from_teeth(configuration, flexspline_teeth,
                                              circular_spline_teeth, rated_torque_Nm);
            require(check(gear));
            return gear;
          },
          nb::kw_only(), "flexspline_teeth"_a, "circular_spline_teeth"_a,
          "configuration"_a.sig("...") = GearConfiguration::fixed_circular_spline,
          "rated_torque_Nm"_a = Gear{}.rated_torque_Nm,
          "A gear from its tooth counts (Godler 2000, eq. 1 and 2).")
      .def("__repr__",
           [](const nb::handle& self) {
             return repr_of(self,
                            {"ratio", "configuration", "rated_torque_Nm", "output_direction"});
           })
      .def_ro("ratio", &Gear::ratio, "Motor turns per output turn, a magnitude.")
      .def_ro("configuration", &Gear::configuration)
      .def_ro("output_direction", &Gear::output_direction,
              "+1: the output turns with the motor, -1: against it.")
      .def_ro("rated_torque_Nm", &Gear::rated_torque_Nm, "Full scale of every figure in %FS, Nm.")
      .def_prop_ro("wave_factor", &wave_factor<double>,
                   "Factor m: turns of the wave against the flexspline per motor turn.")
      .def_prop_ro("misalignment_order", &misalignment_order<double>,
                   "Once per output turn: 1/ratio cycles per motor turn.");

  m.def(
      "nominal_ratio",
      [](std::uint32_t flexspline_teeth, std::uint32_t circular_spline_teeth) {
        require_teeth(flexspline_teeth, circular_spline_teeth);
        return nominal_ratio(flexspline_teeth, circular_spline_teeth);
      },
      "flexspline_teeth"_a, "circular_spline_teeth"_a,
      "R = z_f / (z_c - z_f). Godler 2000, eq. (1).");
  m.def("signed_reduction_ratio", &signed_reduction_ratio<double>, "configuration"_a, "nominal"_a,
        "R_c = -R with the circular spline fixed, R_f = R + 1 with the flexspline fixed. "
        "Godler 2000, eq. (2).");
}

}  // namespace strainwave::bindings
