// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "bind_ripple_filter.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

RippleOrder make_order(const nb::handle& order, bool with_load, bool with_speed,
                       bool with_direction, bool keep) {
  return {to_valid_rational(order, "order", "cycles per motor turn"), with_load, with_speed,
          with_direction, keep};
}

/// Orders from RippleOrder objects and plain numbers.
void put_orders(const nb::sequence& orders, std::size_t& count, RippleOrder* into) {
  const std::size_t given = nb::len(orders);
  if (given < 1 || given > most_pairs) {
    raise_input_error("orders has " + std::to_string(given) + " elements: expected 1 to " +
                      std::to_string(most_pairs) + "; give a list of that length");
  }
  count = given;
  for (std::size_t a = 0; a < given; ++a) {
    const nb::object each(orders[a]);
    if (!nb::try_cast(each, into[a])) {
      into[a] = make_order(each, false, false, false, false);
    }
  }
}

void put_frozen(const nb::sequence& frozen, RippleConfigD& config) {
  const std::size_t given = nb::len(frozen);
  if (given > largest_frozen_terms) {
    raise_input_error("frozen has " + std::to_string(given) + " elements: expected at most " +
                      std::to_string(largest_frozen_terms) + "; give fewer terms");
  }
  config.frozen_count = given;
  for (std::size_t f = 0; f < given; ++f) {
    const nb::object each(frozen[f]);
    if (!nb::try_cast(each, config.frozen[f])) {
      raise_wrong_type("frozen", each, "a FrozenTerm");
    }
  }
}

void put_values(const nb::handle& values, const char* name, const RippleOrder* orders,
                std::size_t order_count, double* into) {
  std::size_t expected = 0;
  for (std::size_t a = 0; a < order_count; ++a) {
    expected += 2 * pairs_of(orders[a]);
  }
  const Vector<double> vector = to_vector<double>(values, name);
  require_same_length(name, vector.shape(0), "the coefficients of the orders", expected);
  if (expected > 2 * most_pairs) {
    raise_input_error("orders have " + std::to_string(expected / 2) +
                      " pairs of coefficients: expected at most " + std::to_string(most_pairs) +
                      "; leave out terms");
  }
  for (std::size_t i = 0; i < expected; ++i) {
    into[i] = vector.data()[i];
  }
}

std::vector<double> values_of(const LearnedD& self, const double* values) {
  std::size_t count = 0;
  for (std::size_t a = 0; a < self.order_count; ++a) {
    count += 2 * pairs_of(self.orders[a]);
  }
  return {values, values + count};
}

void bind_order(nb::module_& m) {
  nb::class_<RippleOrder>(m, "RippleOrder", "One order of the ripple, and what it depends on.")
      .def(
          "__init__",
          [](RippleOrder* self, const nb::handle& order, bool with_load, bool with_speed,
             bool with_direction, bool keep) {
            new (self) RippleOrder(make_order(order, with_load, with_speed, with_direction, keep));
          },
          "order"_a, nb::kw_only(), "with_load"_a = false, "with_speed"_a = false,
          "with_direction"_a = false, "keep"_a = false,
          nb::sig("def __init__(self, order: float | numbers.Rational | Rational, *, "
                  "with_load: bool = ..., with_speed: bool = ..., with_direction: bool = ..., "
                  "keep: bool = ...) -> None"),
          "order in cycles per motor turn. with_...: a further pair of coefficients, times the "
          "low-passed load, |speed| or the direction. keep: learned, but left in the torque.")
      .def_ro("order", &RippleOrder::order)
      .def_ro("with_load", &RippleOrder::with_load)
      .def_ro("with_speed", &RippleOrder::with_speed)
      .def_ro("with_direction", &RippleOrder::with_direction)
      .def_ro("keep", &RippleOrder::keep)
      .def(
          "__eq__", [](const RippleOrder& a, const RippleOrder& b) { return a == b; },
          nb::is_operator())
      .def("__hash__",
           [](const RippleOrder& self) {
             return (std::uint64_t{self.order.numerator} << 31U) ^ self.order.denominator;
           })
      .def("__repr__", [](const nb::handle& self) {
        return repr_of(self, {"order", "with_load", "with_speed", "with_direction", "keep"});
      });

  nb::class_<FrozenTerm<double>>(m, "FrozenTerm",
                                 "A term known from commissioning, applied and never learned.")
      .def(
          "__init__",
          [](FrozenTerm<double>* self, const nb::handle& order, double cosine_Nm, double sine_Nm) {
            new (self) FrozenTerm<double>{
                to_valid_rational(order, "order", "cycles per motor turn"), cosine_Nm, sine_Nm};
          },
          "order"_a, nb::kw_only(), "cosine_Nm"_a, "sine_Nm"_a,
          nb::sig("def __init__(self, order: float | numbers.Rational | Rational, *, "
                  "cosine_Nm: float, sine_Nm: float) -> None"),
          "order in cycles per motor turn: n cycles per output turn are n / ratio.")
      .def_ro("order", &FrozenTerm<double>::order)
      .def_ro("cosine_Nm", &FrozenTerm<double>::cosine_Nm)
      .def_ro("sine_Nm", &FrozenTerm<double>::sine_Nm)
      .def("__repr__",
           [](const nb::handle& self) { return repr_of(self, {"order", "cosine_Nm", "sine_Nm"}); });
}

void bind_learned(nb::module_& m) {
  nb::class_<LearnedD>(m, "LearnedRipple",
                       "Coefficients against the motor's angle, to keep over a power cycle.")
      .def(
          "__init__",
          [](LearnedD* self, const nb::sequence& orders, const nb::handle& coefficients_Nm,
             const nb::handle& standard_deviations_Nm, double innovation_scale_Nm) {
            LearnedD kept;
            put_orders(orders, kept.order_count, kept.orders);
            put_values(coefficients_Nm, "coefficients_Nm", kept.orders, kept.order_count,
                       kept.coefficients_Nm);
            put_values(standard_deviations_Nm, "standard_deviations_Nm", kept.orders,
                       kept.order_count, kept.standard_deviations_Nm);
            kept.innovation_scale_Nm = innovation_scale_Nm;
            new (self) LearnedD(kept);
          },
          nb::kw_only(), "orders"_a, "coefficients_Nm"_a, "standard_deviations_Nm"_a,
          "innovation_scale_Nm"_a = 0.0,
          nb::sig("def __init__(self, *, orders: Sequence[RippleOrder | float | numbers.Rational | "
                  "Rational], coefficients_Nm: numpy.typing.ArrayLike, standard_deviations_Nm: "
                  "numpy.typing.ArrayLike, innovation_scale_Nm: float = ...) -> None"),
          "Cosine and sine of each pair in turn, pairs in the order of the orders and, within one, "
          "constant, load, speed, direction.")
      .def_prop_ro("orders",
                   [](const LearnedD& self) {
                     return std::vector<RippleOrder>(self.orders, self.orders + self.order_count);
                   })
      .def_prop_ro("coefficients_Nm",
                   [](const LearnedD& self) { return values_of(self, self.coefficients_Nm); })
      .def_prop_ro(
          "standard_deviations_Nm",
          [](const LearnedD& self) { return values_of(self, self.standard_deviations_Nm); })
      .def_ro("innovation_scale_Nm", &LearnedD::innovation_scale_Nm)
      .def("__repr__", [](const nb::handle& self) {
        return repr_of(
            self, {"orders", "coefficients_Nm", "standard_deviations_Nm", "innovation_scale_Nm"});
      });
}

}  // namespace

void bind_ripple_config(nb::module_& m) {
  bind_order(m);
  bind_learned(m);

  constexpr RippleFilterConfig<double, 1> standard;
  nb::class_<RippleConfigD>(m, "RippleFilterConfig",
                            "Configuration of the ripple filter, strainwave's default.")
      .def(
          "__init__",
          [](RippleConfigD* self, const nb::sequence& orders, double memory_turns,
             double torque_noise_Nm, double torque_walk_Nm_per_sqrt_s, double initial_amplitude_Nm,
             double rated_torque_Nm, double reference_speed_rad_s, double angle_to_torque_delay_s,
             double minimum_speed_rad_s, const nb::sequence& frozen) {
            RippleConfigD config;
            put_orders(orders, config.order_count, config.orders);
            put_frozen(frozen, config);
            config.memory_turns = memory_turns;
            config.torque_noise_Nm = torque_noise_Nm;
            config.torque_walk_Nm_per_sqrt_s = torque_walk_Nm_per_sqrt_s;
            config.initial_amplitude_Nm = initial_amplitude_Nm;
            config.rated_torque_Nm = rated_torque_Nm;
            config.reference_speed_rad_s = reference_speed_rad_s;
            config.angle_to_torque_delay_s = angle_to_torque_delay_s;
            config.minimum_speed_rad_s = minimum_speed_rad_s;
            require(check(config));
            new (self) RippleConfigD(config);
          },
          nb::kw_only(), "orders"_a, "memory_turns"_a = standard.memory_turns,
          "torque_noise_Nm"_a = standard.torque_noise_Nm,
          "torque_walk_Nm_per_sqrt_s"_a = standard.torque_walk_Nm_per_sqrt_s,
          "initial_amplitude_Nm"_a = standard.initial_amplitude_Nm,
          "rated_torque_Nm"_a = standard.rated_torque_Nm,
          "reference_speed_rad_s"_a = standard.reference_speed_rad_s,
          "angle_to_torque_delay_s"_a = standard.angle_to_torque_delay_s,
          "minimum_speed_rad_s"_a = standard.minimum_speed_rad_s, "frozen"_a = nb::tuple(),
          nb::sig("def __init__(self, *, orders: Sequence[RippleOrder | float | numbers.Rational | "
                  "Rational], memory_turns: float = ..., torque_noise_Nm: float = ..., "
                  "torque_walk_Nm_per_sqrt_s: float = ..., initial_amplitude_Nm: float = ..., "
                  "rated_torque_Nm: float = ..., reference_speed_rad_s: float = ..., "
                  "angle_to_torque_delay_s: float = ..., minimum_speed_rad_s: float = ..., "
                  "frozen: Sequence[FrozenTerm] = ...) -> None"),
          "orders: numbers, or RippleOrder where more is to be said. memory_turns: the one "
          "parameter to choose. angle_to_torque_delay_s: positive where the torque lags.")
      .def("__repr__",
           [](const nb::handle& self) {
             return repr_of(
                 self, {"orders", "memory_turns", "torque_noise_Nm", "torque_walk_Nm_per_sqrt_s",
                        "initial_amplitude_Nm", "rated_torque_Nm", "reference_speed_rad_s",
                        "angle_to_torque_delay_s", "minimum_speed_rad_s", "frozen"});
           })
      .def_prop_ro("orders",
                   [](const RippleConfigD& self) {
                     return std::vector<RippleOrder>(self.orders, self.orders + self.order_count);
                   })
      .def_prop_ro("frozen",
                   [](const RippleConfigD& self) {
                     return std::vector<FrozenTerm<double>>(self.frozen,
                                                            self.frozen + self.frozen_count);
                   })
      .def_ro("memory_turns", &RippleConfigD::memory_turns)
      .def_ro("torque_noise_Nm", &RippleConfigD::torque_noise_Nm)
      .def_ro("torque_walk_Nm_per_sqrt_s", &RippleConfigD::torque_walk_Nm_per_sqrt_s)
      .def_ro("initial_amplitude_Nm", &RippleConfigD::initial_amplitude_Nm)
      .def_ro("rated_torque_Nm", &RippleConfigD::rated_torque_Nm)
      .def_ro("reference_speed_rad_s", &RippleConfigD::reference_speed_rad_s)
      .def_ro("angle_to_torque_delay_s", &RippleConfigD::angle_to_torque_delay_s)
      .def_ro("minimum_speed_rad_s", &RippleConfigD::minimum_speed_rad_s);
}

}  // namespace strainwave::bindings
