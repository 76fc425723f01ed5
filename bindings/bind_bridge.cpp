// SPDX-License-Identifier: Apache-2.0
#include "strainwave/bridge.hpp"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <utility>
#include <vector>

#include "common.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

using RosetteD = Rosette<double>;
using AmplifierD = Amplifier<double>;
using ConverterD = Converter<double>;

std::pair<VectorOut<double>, VectorOut<double>> strain_of_rosette(
    const RosetteD& rosette, const nb::handle& radial_strain,
    const nb::handle& circumferential_strain, const nb::handle& shear_strain) {
  const auto radial = to_vector<double>(radial_strain, "radial");
  const auto circumferential = to_vector<double>(circumferential_strain, "circumferential");
  const auto shear = to_vector<double>(shear_strain, "shear");
  const std::size_t size = radial.shape(0);
  require_same_length("circumferential", circumferential.shape(0), "radial", size);
  require_same_length("shear", shear.shape(0), "radial", size);
  FilledVector<double> first(size);
  FilledVector<double> second(size);
  for (std::size_t k = 0; k < size; ++k) {
    const RosetteStrain<double> strain =
        rosette_strain(rosette, {radial.data()[k], circumferential.data()[k], shear.data()[k]});
    first.data()[k] = strain.first;
    second.data()[k] = strain.second;
  }
  return {first.give(), second.give()};
}

double to_supply_V(const nb::handle& value) {
  const double supply_V = to_real_number(value, "supply_V");
  require(is_finite(supply_V)
              ? Violation<double>{}
              : Violation<double>{"supply_V", -1, supply_V, "V", "a finite number"});
  return supply_V;
}

std::vector<RosetteD> to_rosettes(const nb::handle& value) {
  std::vector<RosetteD> rosettes;
  if (!nb::try_cast(value, rosettes)) {
    raise_wrong_type("rosettes", value, "a list of Rosette");
  }
  return rosettes;
}

VectorOut<double> half_bridge(const RosetteD& rosette, const nb::handle& first_strain,
                              const nb::handle& second_strain, const nb::handle& supply) {
  const auto first = to_vector<double>(first_strain, "first");
  const auto second = to_vector<double>(second_strain, "second");
  const double supply_V = to_supply_V(supply);
  const std::size_t size = first.shape(0);
  require_same_length("second", second.shape(0), "first", size);
  FilledVector<double> out(size);
  for (std::size_t k = 0; k < size; ++k) {
    out.data()[k] = half_bridge_V(
        rosette.gauge_factor, RosetteStrain<double>{first.data()[k], second.data()[k]}, supply_V);
  }
  return out.give();
}

VectorOut<double> full_bridge(const nb::handle& list_of_rosettes, const nb::handle& first_strain,
                              const nb::handle& second_strain, const nb::handle& supply) {
  const std::vector<RosetteD> rosettes = to_rosettes(list_of_rosettes);
  const auto first = to_matrix<double>(first_strain, "first");
  const auto second = to_matrix<double>(second_strain, "second");
  const double supply_V = to_supply_V(supply);
  const std::size_t size = first.shape(0);
  require_same_length("first's second axis", first.shape(1), "rosettes", rosettes.size());
  require_same_length("second's first axis", second.shape(0), "first's first axis", size);
  require_same_length("second's second axis", second.shape(1), "rosettes", rosettes.size());
  if (rosettes.size() < 2) {
    raise_input_error("rosettes has " + std::to_string(rosettes.size()) +
                      " elements: expected at least 2; a single rosette is a half bridge");
  }
  FilledVector<double> out(size);
  std::vector<RosetteStrain<double>> strains(rosettes.size());
  for (std::size_t k = 0; k < size; ++k) {
    for (std::size_t j = 0; j < rosettes.size(); ++j) {
      const std::size_t at = k * rosettes.size() + j;
      strains[j] = {first.data()[at], second.data()[at]};
    }
    out.data()[k] = full_bridge_V(rosettes.data(), strains.data(), rosettes.size(), supply_V);
  }
  return out.give();
}

}  // namespace

void bind_bridge(nb::module_& m) {
  nb::class_<RosetteD>(m, "Rosette", "Where and how one pair of crossed gauges is bonded.")
      .def(
          "__init__",
          [](RosetteD* self, const nb::handle& position_rad, const nb::handle& radius_m,
             const nb::handle& orientation_error_rad, const nb::handle& gauge_factor) {
            const RosetteD rosette{to_real_number(position_rad, "position_rad"),
                                   to_real_number(radius_m, "radius_m"),
                                   to_real_number(orientation_error_rad, "orientation_error_rad"),
                                   to_real_number(gauge_factor, "gauge_factor")};
            require(check(rosette));
            new (self) RosetteD(rosette);
          },
          nb::kw_only(), "position_rad"_a.none() = RosetteD{}.position_rad,
          "radius_m"_a.none() = RosetteD{}.radius_m,
          "orientation_error_rad"_a.none() = RosetteD{}.orientation_error_rad,
          "gauge_factor"_a.none() = RosetteD{}.gauge_factor,
          nb::sig("def __init__(self, *, position_rad: float = 0.0, radius_m: float = 0.015, "
                  "orientation_error_rad: float = 0.0, gauge_factor: float = 2.0) -> None"),
          "position_rad counts against the wave-generator angle: gauge j of M equally spaced ones "
          "stands at pi (j-1)/M and leads by 2 i pi (j-1)/M in harmonic i.")
      .def("__repr__",
           [](const nb::handle& self) {
             return repr_of(self,
                            {"position_rad", "radius_m", "orientation_error_rad", "gauge_factor"});
           })
      .def_ro("position_rad", &RosetteD::position_rad)
      .def_ro("radius_m", &RosetteD::radius_m)
      .def_ro("orientation_error_rad", &RosetteD::orientation_error_rad)
      .def_ro("gauge_factor", &RosetteD::gauge_factor)
      .def("strain", &strain_of_rosette, "radial"_a.none(), "circumferential"_a.none(),
           "shear"_a.none(),
           nb::sig("def strain(self, radial: numpy.typing.ArrayLike, circumferential: "
                   "numpy.typing.ArrayLike, shear: numpy.typing.ArrayLike) -> "
                   "tuple[numpy.typing.NDArray[numpy.float64], "
                   "numpy.typing.NDArray[numpy.float64]]"),
           "Strains along both gauges from the surface strain (polar; engineering shear). "
           "Taghirad & Belanger 1999, eq. (1).")
      .def("half_bridge_V", &half_bridge, "first"_a.none(), "second"_a.none(), "supply_V"_a.none(),
           nb::sig("def half_bridge_V(self, first: numpy.typing.ArrayLike, second: "
                   "numpy.typing.ArrayLike, supply_V: float) -> "
                   "numpy.typing.NDArray[numpy.float64]"),
           "K/4 (epsilon_1 - epsilon_2) E_sup, V.");
  m.def("full_bridge_V", &full_bridge, "rosettes"_a.none(), "first"_a.none(), "second"_a.none(),
        "supply_V"_a.none(),
        nb::sig("def full_bridge_V(rosettes: collections.abc.Sequence[Rosette], first: "
                "numpy.typing.ArrayLike, "
                "second: numpy.typing.ArrayLike, supply_V: float) -> "
                "numpy.typing.NDArray[numpy.float64]"),
        "Output of all rosettes in one full bridge, V; strains have the shape (samples, rosettes). "
        "Taghirad & Belanger 1999, eq. (4).");

  nb::class_<AmplifierD>(m, "Amplifier", "Instrumentation amplifier that ends at its rails.")
      .def(
          "__init__",
          [](AmplifierD* self, const nb::handle& gain, const nb::handle& offset_V,
             const nb::handle& rail_V) {
            const AmplifierD amplifier{to_real_number(gain, "gain"),
                                       to_real_number(offset_V, "offset_V"),
                                       to_real_number(rail_V, "rail_V")};
            require(check(amplifier));
            new (self) AmplifierD(amplifier);
          },
          nb::kw_only(), "gain"_a.none() = AmplifierD{}.gain,
          "offset_V"_a.none() = AmplifierD{}.offset_V, "rail_V"_a.none() = AmplifierD{}.rail_V,
          nb::sig("def __init__(self, *, gain: float = 1000.0, offset_V: float = 0.0, rail_V: "
                  "float = 10.0) -> None"))
      .def("__repr__",
           [](const nb::handle& self) { return repr_of(self, {"gain", "offset_V", "rail_V"}); })
      .def_ro("gain", &AmplifierD::gain)
      .def_ro("offset_V", &AmplifierD::offset_V)
      .def_ro("rail_V", &AmplifierD::rail_V)
      .def(
          "amplified_V",
          [](const AmplifierD& self, const nb::handle& values) {
            const auto input_V = to_vector<double>(values, "input_V");
            FilledVector<double> out(input_V.shape(0));
            for (std::size_t k = 0; k < input_V.shape(0); ++k) {
              out.data()[k] = amplified_V(self, input_V.data()[k]);
            }
            return out.give();
          },
          "input_V"_a.none(),
          nb::sig("def amplified_V(self, input_V: numpy.typing.ArrayLike) -> "
                  "numpy.typing.NDArray[numpy.float64]"));

  nb::class_<ConverterD>(m, "Converter", "Analogue-to-digital converter.")
      .def(
          "__init__",
          [](ConverterD* self, const nb::handle& bits, const nb::handle& minimum_V,
             const nb::handle& maximum_V, const nb::handle& lowest_code) {
            const ConverterD converter{
                to_whole_number<std::uint32_t>(bits, "bits", "a whole number, 1 to 24"),
                to_real_number(minimum_V, "minimum_V"), to_real_number(maximum_V, "maximum_V"),
                to_whole_number<std::int32_t>(lowest_code, "lowest_code",
                                              "a whole number, 0 (straight binary) or "
                                              "-2^(bits-1) (two's complement)")};
            require(check(converter));
            new (self) ConverterD(converter);
          },
          nb::kw_only(), "bits"_a.none() = ConverterD{}.bits,
          "minimum_V"_a.none() = ConverterD{}.minimum_V,
          "maximum_V"_a.none() = ConverterD{}.maximum_V,
          "lowest_code"_a.none() = ConverterD{}.lowest_code,
          nb::sig("def __init__(self, *, bits: int = 16, minimum_V: float = -10.0, maximum_V: "
                  "float = 10.0, lowest_code: int = 0) -> None"),
          "lowest_code: 0 for straight binary, -2^(bits-1) for two's complement.")
      .def("__repr__",
           [](const nb::handle& self) {
             return repr_of(self, {"bits", "minimum_V", "maximum_V", "lowest_code"});
           })
      .def_ro("bits", &ConverterD::bits)
      .def_ro("minimum_V", &ConverterD::minimum_V)
      .def_ro("maximum_V", &ConverterD::maximum_V)
      .def_ro("lowest_code", &ConverterD::lowest_code)
      .def_prop_ro("highest_code", &highest_code<double>)
      .def_prop_ro("step_V", &step_V<double>, "Volts per code.")
      .def(
          "to_code",
          [](const ConverterD& self, const nb::handle& values) {
            const auto input_V = to_vector<double>(values, "input_V");
            FilledVector<std::int32_t> out(input_V.shape(0));
            for (std::size_t k = 0; k < input_V.shape(0); ++k) {
              out.data()[k] = to_code(self, input_V.data()[k]).value;
            }
            return out.give();
          },
          "input_V"_a.none(),
          nb::sig("def to_code(self, input_V: numpy.typing.ArrayLike) -> "
                  "numpy.typing.NDArray[numpy.int32]"))
      .def(
          "to_volts",
          [](const ConverterD& self, const nb::handle& values) {
            const auto codes = to_vector<std::int32_t>(values, "codes");
            FilledVector<double> out(codes.shape(0));
            for (std::size_t k = 0; k < codes.shape(0); ++k) {
              out.data()[k] = to_volts(self, ConverterCode{codes.data()[k]});
            }
            return out.give();
          },
          "codes"_a.none(),
          nb::sig("def to_volts(self, codes: numpy.typing.ArrayLike) -> "
                  "numpy.typing.NDArray[numpy.float64]"))
      .def(
          "is_saturated",
          [](const ConverterD& self, const nb::handle& values) {
            const auto codes = to_vector<std::int32_t>(values, "codes");
            FilledVector<bool> out(codes.shape(0));
            for (std::size_t k = 0; k < codes.shape(0); ++k) {
              out.data()[k] = is_saturated(self, ConverterCode{codes.data()[k]});
            }
            return out.give();
          },
          "codes"_a.none(),
          nb::sig("def is_saturated(self, codes: numpy.typing.ArrayLike) -> "
                  "numpy.typing.NDArray[numpy.bool_]"));
}

}  // namespace strainwave::bindings
