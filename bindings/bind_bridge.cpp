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
    const RosetteD& rosette, const Vector<double>& radial, const Vector<double>& circumferential,
    const Vector<double>& shear) {
  const std::size_t size = radial.shape(0);
  require_same_length("circumferential", circumferential.shape(0), "radial", size);
  require_same_length("shear", shear.shape(0), "radial", size);
  NewVector<double> first(size);
  NewVector<double> second(size);
  for (std::size_t k = 0; k < size; ++k) {
    const RosetteStrain<double> strain =
        rosette_strain(rosette, {radial.data()[k], circumferential.data()[k], shear.data()[k]});
    first.data()[k] = strain.first;
    second.data()[k] = strain.second;
  }
  return {first.give(), second.give()};
}

VectorOut<double> half_bridge(const RosetteD& rosette, const Vector<double>& first,
                              const Vector<double>& second, double supply_V) {
  const std::size_t size = first.shape(0);
  require_same_length("second", second.shape(0), "first", size);
  NewVector<double> out(size);
  for (std::size_t k = 0; k < size; ++k) {
    out.data()[k] = half_bridge_V(
        rosette.gauge_factor, RosetteStrain<double>{first.data()[k], second.data()[k]}, supply_V);
  }
  return out.give();
}

VectorOut<double> full_bridge(const std::vector<RosetteD>& rosettes, const Matrix<double>& first,
                              const Matrix<double>& second, double supply_V) {
  const std::size_t size = first.shape(0);
  require_same_length("first's second axis", first.shape(1), "rosettes", rosettes.size());
  require_same_length("second's first axis", second.shape(0), "first's first axis", size);
  require_same_length("second's second axis", second.shape(1), "rosettes", rosettes.size());
  if (rosettes.size() < 2) {
    raise_input_error("rosettes has " + std::to_string(rosettes.size()) +
                      " elements: expected at least 2; a single rosette is a half bridge");
  }
  NewVector<double> out(size);
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
          [](RosetteD* self, double position_rad, double radius_m, double orientation_error_rad,
             double gauge_factor) {
            const RosetteD rosette{position_rad, radius_m, orientation_error_rad, gauge_factor};
            require(check(rosette));
            new (self) RosetteD(rosette);
          },
          nb::kw_only(), "position_rad"_a = RosetteD{}.position_rad,
          "radius_m"_a = RosetteD{}.radius_m,
          "orientation_error_rad"_a = RosetteD{}.orientation_error_rad,
          "gauge_factor"_a = RosetteD{}.gauge_factor,
          "position_rad counts against the wave-generator angle: gauge j of M equally spaced ones "
          "stands at pi (j-1)/M and leads by 2 i pi (j-1)/M in harmonic i.")
      .def_ro("position_rad", &RosetteD::position_rad)
      .def_ro("radius_m", &RosetteD::radius_m)
      .def_ro("orientation_error_rad", &RosetteD::orientation_error_rad)
      .def_ro("gauge_factor", &RosetteD::gauge_factor)
      .def("strain", &strain_of_rosette, "radial"_a, "circumferential"_a, "shear"_a,
           "Strains along both gauges from the surface strain (polar; engineering shear). "
           "Taghirad & Belanger 1999, eq. (1).")
      .def("half_bridge_V", &half_bridge, "first"_a, "second"_a, "supply_V"_a,
           "K/4 (epsilon_1 - epsilon_2) E_sup, V.");
  m.def("full_bridge_V", &full_bridge, "rosettes"_a, "first"_a, "second"_a, "supply_V"_a,
        "Output of all rosettes in one full bridge, V; strains have the shape (samples, rosettes). "
        "Taghirad & Belanger 1999, eq. (4).");

  nb::class_<AmplifierD>(m, "Amplifier", "Instrumentation amplifier that ends at its rails.")
      .def(
          "__init__",
          [](AmplifierD* self, double gain, double offset_V, double rail_V) {
            const AmplifierD amplifier{gain, offset_V, rail_V};
            require(check(amplifier));
            new (self) AmplifierD(amplifier);
          },
          nb::kw_only(), "gain"_a = AmplifierD{}.gain, "offset_V"_a = AmplifierD{}.offset_V,
          "rail_V"_a = AmplifierD{}.rail_V)
      .def_ro("gain", &AmplifierD::gain)
      .def_ro("offset_V", &AmplifierD::offset_V)
      .def_ro("rail_V", &AmplifierD::rail_V)
      .def(
          "amplified_V",
          [](const AmplifierD& self, const Vector<double>& input_V) {
            NewVector<double> out(input_V.shape(0));
            for (std::size_t k = 0; k < input_V.shape(0); ++k) {
              out.data()[k] = amplified_V(self, input_V.data()[k]);
            }
            return out.give();
          },
          "input_V"_a);

  nb::class_<ConverterD>(m, "Converter", "Analogue-to-digital converter.")
      .def(
          "__init__",
          [](ConverterD* self, std::uint32_t bits, double minimum_V, double maximum_V,
             std::int32_t lowest_code) {
            const ConverterD converter{bits, minimum_V, maximum_V, lowest_code};
            require(check(converter));
            new (self) ConverterD(converter);
          },
          nb::kw_only(), "bits"_a = ConverterD{}.bits, "minimum_V"_a = ConverterD{}.minimum_V,
          "maximum_V"_a = ConverterD{}.maximum_V, "lowest_code"_a = ConverterD{}.lowest_code,
          "lowest_code: 0 for straight binary, -2^(bits-1) for two's complement.")
      .def_ro("bits", &ConverterD::bits)
      .def_ro("minimum_V", &ConverterD::minimum_V)
      .def_ro("maximum_V", &ConverterD::maximum_V)
      .def_ro("lowest_code", &ConverterD::lowest_code)
      .def_prop_ro("highest_code", &highest_code<double>)
      .def_prop_ro("step_V", &step_V<double>, "Volts per code.")
      .def(
          "to_code",
          [](const ConverterD& self, const Vector<double>& input_V) {
            NewVector<std::int32_t> out(input_V.shape(0));
            for (std::size_t k = 0; k < input_V.shape(0); ++k) {
              out.data()[k] = to_code(self, input_V.data()[k]).value;
            }
            return out.give();
          },
          "input_V"_a)
      .def(
          "to_volts",
          [](const ConverterD& self, const Vector<std::int32_t>& codes) {
            NewVector<double> out(codes.shape(0));
            for (std::size_t k = 0; k < codes.shape(0); ++k) {
              out.data()[k] = to_volts(self, ConverterCode{codes.data()[k]});
            }
            return out.give();
          },
          "codes"_a)
      .def(
          "is_saturated",
          [](const ConverterD& self, const Vector<std::int32_t>& codes) {
            NewVector<bool> out(codes.shape(0));
            for (std::size_t k = 0; k < codes.shape(0); ++k) {
              out.data()[k] = is_saturated(self, ConverterCode{codes.data()[k]});
            }
            return out.give();
          },
          "codes"_a);
}

}  // namespace strainwave::bindings
