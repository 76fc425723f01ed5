// SPDX-License-Identifier: Apache-2.0
#include "bind_gauge_monitor.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>
#include <vector>

#include "bind_gains.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

/// One entry of GaugeMonitorConfig.without, with the gauge it is for.
struct NumberedGains {
  std::size_t gauge = 0;  ///< from 1
  GainsWithoutGauge<double, most_gauges> set;
};

/// The consistency check, with the gauges it was made for.
struct NumberedConsistency {
  std::size_t gauge_count = 0;
  ConsistencyD check;
};

std::size_t require_gauge_count(std::size_t count, const char* name) {
  if (count < 1 || count > most_gauges) {
    raise_input_error(std::string(name) + " has " + std::to_string(count) +
                      " columns: expected 1 to " + std::to_string(most_gauges) +
                      ", one a gauge; give a matrix of that width");
  }
  return count;
}

NumberedConsistency make_consistency(std::uint32_t samples, const nb::handle& directions,
                                     const nb::handle& zeros, double limit_V, double limit_per_V,
                                     const nb::handle& conditions, const nb::handle& factor,
                                     double delay_samples) {
  NumberedConsistency made;
  ConsistencyD& parity = made.check;
  const auto direction = to_matrix<double>(directions, "signal_directions");
  const std::size_t count = require_gauge_count(direction.shape(1), "signal_directions");
  const auto zero_V = to_vector<double>(zeros, "gauge_zero_V");
  require_same_length("gauge_zero_V", zero_V.shape(0), "signal_directions' columns", count);
  made.gauge_count = count;
  parity.samples = samples;
  parity.direction_count = direction.shape(0);
  for (std::size_t d = 0; d < most_signal_directions && d < parity.direction_count; ++d) {
    for (std::size_t j = 0; j < count; ++j) {
      parity.directions[d][j] = direction.data()[d * count + j];
    }
  }
  for (std::size_t j = 0; j < count; ++j) {
    parity.zero_V[j] = zero_V.data()[j];
  }
  if (!conditions.is_none()) {
    const auto wave_V = to_matrix<double>(conditions, "fluctuation_V");
    require_same_length("fluctuation_V's second axis", wave_V.shape(1),
                        "signal_directions' columns", count);
    if (wave_V.shape(0) % 2 != 0) {
      raise_input_error("fluctuation_V has " + std::to_string(wave_V.shape(0)) +
                        " rows: expected two a harmonic, of sine and cosine; make it with "
                        "compensation_conditions");
    }
    parity.harmonic_count = wave_V.shape(0) / 2;
    for (std::size_t i = 0; i < most_watched_harmonics && i < parity.harmonic_count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        parity.wave_V[j][i] = {wave_V.data()[2 * i * count + j],
                               wave_V.data()[(2 * i + 1) * count + j]};
      }
    }
  }
  parity.wave_factor = to_valid_rational(factor, "wave_factor", "wave turns per motor turn");
  parity.delay_samples = delay_samples;
  parity.limit_V = limit_V;
  parity.limit_per_V = limit_per_V;
  require(detail::check_consistency(parity, count));
  return made;
}

NumberedGains make_gains_without(std::size_t gauge, const nb::handle& list, double zero_shift_V,
                                 double residual_fluctuation_V) {
  const auto values = to_vector<double>(list, "gains");
  NumberedGains made;
  made.gauge = gauge;
  made.set = {true, make_gains({values.data(), values.data() + values.size()}), zero_shift_V,
              residual_fluctuation_V};
  if (gauge < 1 || gauge > made.set.gains.count) {
    raise_input_error("gauge = " + std::to_string(gauge) + ": expected 1 to " +
                      std::to_string(made.set.gains.count) + ", the number of gains; count from 1");
  }
  MonitorConfigD alone;
  alone.without[gauge - 1] = made.set;
  require(detail::check_gains_without(alone, made.set.gains.count));
  return made;
}

void put_gains_without(const nb::sequence& sets, MonitorConfigD& config) {
  for (std::size_t i = 0; i < nb::len(sets); ++i) {
    NumberedGains each;
    const nb::object entry(sets[i]);
    if (!nb::try_cast(entry, each)) {
      raise_wrong_type("without", entry, "a GainsWithoutGauge");
    }
    if (config.without[each.gauge - 1].available) {
      raise_input_error("without has two entries for gauge " + std::to_string(each.gauge) +
                        ": expected one a gauge; remove one of them");
    }
    config.without[each.gauge - 1] = each.set;
  }
}

void bind_gains_without(nb::module_& m) {
  nb::class_<NumberedGains>(m, "GainsWithoutGauge",
                            "Gains solved beforehand for the loss of one gauge.")
      .def(
          "__init__",
          [](NumberedGains* self, std::size_t gauge, const nb::handle& gains, double zero_shift_V,
             double residual_fluctuation_V) {
            new (self) NumberedGains(
                make_gains_without(gauge, gains, zero_shift_V, residual_fluctuation_V));
          },
          "gauge"_a, "gains"_a.none(), nb::kw_only(), "zero_shift_V"_a = 0.0,
          "residual_fluctuation_V"_a = 0.0,
          nb::sig("def __init__(self, gauge: int, gains: numpy.typing.ArrayLike, *, zero_shift_V: "
                  "float = 0.0, residual_fluctuation_V: float = 0.0) -> None"),
          "gauge: its number from 1; gains: one a gauge, 0 for that one. zero_shift_V: their "
          "weighted zeros less those of the gains of all. residual_fluctuation_V: rms they leave.")
      .def_ro("gauge", &NumberedGains::gauge)
      .def_prop_ro("gains",
                   [](const NumberedGains& self) {
                     const GainsD& gains = self.set.gains;
                     return std::vector<double>(gains.values, gains.values + gains.count);
                   })
      .def_prop_ro("zero_shift_V", [](const NumberedGains& self) { return self.set.zero_shift_V; })
      .def_prop_ro("residual_fluctuation_V",
                   [](const NumberedGains& self) { return self.set.residual_fluctuation_V; })
      .def("__repr__", [](const nb::handle& self) {
        return repr_of(self, {"gauge", "gains", "zero_shift_V", "residual_fluctuation_V"});
      });
}

void bind_consistency(nb::module_& m) {
  nb::class_<NumberedConsistency>(
      m, "ConsistencyCheck",
      "Parity check of the gauges: what is left beside the directions of torque and wave.")
      .def(
          "__init__",
          [](NumberedConsistency* self, std::uint32_t samples, const nb::handle& directions,
             const nb::handle& zeros, double limit_V, double limit_per_V,
             const nb::handle& conditions, const nb::handle& factor, double delay_samples) {
            new (self) NumberedConsistency(make_consistency(samples, directions, zeros, limit_V,
                                                            limit_per_V, conditions, factor,
                                                            delay_samples));
          },
          nb::kw_only(), "samples"_a, "signal_directions"_a.none(), "gauge_zero_V"_a.none(),
          "limit_V"_a, "limit_per_V"_a = 0.0, "fluctuation_V"_a.none() = nb::none(),
          "wave_factor"_a.none() = 1, "delay_samples"_a = 0.0,
          nb::sig("def __init__(self, *, samples: int, signal_directions: numpy.typing.ArrayLike, "
                  "gauge_zero_V: numpy.typing.ArrayLike, limit_V: float, limit_per_V: float = 0.0, "
                  "fluctuation_V: numpy.typing.ArrayLike | None = None, wave_factor: float | "
                  "numbers.Rational | Rational = 1, delay_samples: float = 0.0) -> None"),
          "signal_directions: orthonormal rows with a column a gauge, the first that of torque; "
          "fluctuation_V: sine and cosine rows by harmonic, as compensation_conditions gives "
          "them, predicted from the motor's angle. Beyond limit_V + limit_per_V |torque's share| "
          "a gauge is suspected, after samples it is lost.")
      .def_ro("gauge_count", &NumberedConsistency::gauge_count)
      .def_prop_ro("samples", [](const NumberedConsistency& self) { return self.check.samples; })
      .def_prop_ro("limit_V", [](const NumberedConsistency& self) { return self.check.limit_V; })
      .def_prop_ro("limit_per_V",
                   [](const NumberedConsistency& self) { return self.check.limit_per_V; })
      .def_prop_ro("delay_samples",
                   [](const NumberedConsistency& self) { return self.check.delay_samples; })
      .def_prop_ro("wave_factor",
                   [](const NumberedConsistency& self) { return self.check.wave_factor; })
      .def("__repr__", [](const NumberedConsistency& self) {
        return "ConsistencyCheck(gauge_count=" + std::to_string(self.gauge_count) +
               ", samples=" + std::to_string(self.check.samples) +
               ", limit_V=" + std::to_string(self.check.limit_V) +
               ", limit_per_V=" + std::to_string(self.check.limit_per_V) + ")";
      });
}

}  // namespace

void bind_gauge_monitor(nb::module_& m) {
  nb::enum_<GaugeFault>(m, "GaugeFault", nb::is_arithmetic(),
                        "What has become of a gauge; numbers are stable, logs keep them.")
      .value("none", GaugeFault::none)
      .value("open", GaugeFault::open, "at the rail that a torn gauge drives its amplifier to")
      .value("shorted", GaugeFault::shorted, "at the amplifier's zero, whatever the others say")
      .value("stuck", GaugeFault::stuck, "one code, while others change or the motor turns")
      .value("saturated", GaugeFault::saturated, "at a rail that a torn gauge does not explain")
      .value("inconsistent", GaugeFault::inconsistent,
             "inside its range, but not what the others and the angle make it");
  nb::enum_<TornGaugeRail>(m, "TornGaugeRail", "The rail to which a torn gauge drives it.")
      .value("unknown", TornGaugeRail::unknown)
      .value("lower", TornGaugeRail::lower)
      .value("upper", TornGaugeRail::upper);
  bind_gains_without(m);
  bind_consistency(m);
  nb::class_<MonitorConfigD>(m, "GaugeMonitorConfig",
                             "Watch over the gauges: what a sound one does, and the gains without "
                             "each.")
      .def(
          "__init__",
          [](MonitorConfigD* self, std::uint32_t rail_samples, double lowest_V, double highest_V,
             const nb::handle& torn_gauge_rail, double overload_V, std::uint32_t stuck_samples,
             double flat_travel_turns, double flat_band_V, double amplifier_zero_V,
             double short_band_V, const std::optional<NumberedConsistency>& consistency,
             double residual_fluctuation_V, const nb::sequence& without) {
            MonitorConfigD config;
            config.active = true;
            config.rail_samples = rail_samples;
            config.lowest_V = lowest_V;
            config.highest_V = highest_V;
            config.torn_gauge_rail = to_enum<TornGaugeRail>(torn_gauge_rail, "torn_gauge_rail");
            config.overload_V = overload_V;
            config.stuck_samples = stuck_samples;
            config.flat_travel_turns = flat_travel_turns;
            config.flat_band_V = flat_band_V;
            config.amplifier_zero_V = amplifier_zero_V;
            config.short_band_V = short_band_V;
            config.residual_fluctuation_V = residual_fluctuation_V;
            put_gains_without(without, config);
            MonitorConfigD alone = config;  // the chain checks the rest, which needs the gauges
            for (auto& set : alone.without) {
              set.available = false;
            }
            require(check(alone, most_gauges));
            if (consistency) {
              config.consistency = consistency->check;
            }
            new (self) MonitorConfigD(config);
          },
          nb::kw_only(), "rail_samples"_a = MonitorConfigD{}.rail_samples,
          "lowest_V"_a = MonitorConfigD{}.lowest_V, "highest_V"_a = MonitorConfigD{}.highest_V,
          "torn_gauge_rail"_a = "unknown", "overload_V"_a = MonitorConfigD{}.overload_V,
          "stuck_samples"_a = 0, "flat_travel_turns"_a = 0.0, "flat_band_V"_a = 0.0,
          "amplifier_zero_V"_a = 0.0, "short_band_V"_a = 0.0, "consistency"_a = nb::none(),
          "residual_fluctuation_V"_a = 0.0, "without"_a = nb::make_tuple(),
          nb::sig("def __init__(self, *, rail_samples: int = 5, lowest_V: float = -1e9, highest_V: "
                  "float = 1e9, torn_gauge_rail: TornGaugeRail | str = 'unknown', "
                  "overload_V: float = 1e9, stuck_samples: int = 0, flat_travel_turns: float = "
                  "0.0, flat_band_V: float = 0.0, amplifier_zero_V: float = 0.0, short_band_V: "
                  "float = 0.0, consistency: ConsistencyCheck | None = None, "
                  "residual_fluctuation_V: float = 0.0, without: "
                  "collections.abc.Sequence[GainsWithoutGauge] = ()) -> None"),
          "0 samples or turns: no such check. Rails are the converter's ends, and lowest_V and "
          "highest_V where the amplifier ends before them.")
      .def_ro("rail_samples", &MonitorConfigD::rail_samples)
      .def_ro("lowest_V", &MonitorConfigD::lowest_V)
      .def_ro("highest_V", &MonitorConfigD::highest_V)
      .def_ro("torn_gauge_rail", &MonitorConfigD::torn_gauge_rail)
      .def_ro("overload_V", &MonitorConfigD::overload_V)
      .def_ro("stuck_samples", &MonitorConfigD::stuck_samples)
      .def_ro("flat_travel_turns", &MonitorConfigD::flat_travel_turns)
      .def_ro("flat_band_V", &MonitorConfigD::flat_band_V)
      .def_ro("amplifier_zero_V", &MonitorConfigD::amplifier_zero_V)
      .def_ro("short_band_V", &MonitorConfigD::short_band_V)
      .def_ro("residual_fluctuation_V", &MonitorConfigD::residual_fluctuation_V)
      .def_prop_ro("consistency_samples",
                   [](const MonitorConfigD& self) { return self.consistency.samples; })
      .def_prop_ro("without",
                   [](const MonitorConfigD& self) {
                     std::vector<NumberedGains> sets;
                     for (std::size_t j = 0; j < most_gauges; ++j) {
                       if (self.without[j].available) {
                         sets.push_back({j + 1, self.without[j]});
                       }
                     }
                     return sets;
                   })
      .def("__repr__", [](const nb::handle& self) {
        return repr_of(
            self, {"rail_samples", "lowest_V", "highest_V", "torn_gauge_rail", "overload_V",
                   "stuck_samples", "flat_travel_turns", "flat_band_V", "amplifier_zero_V",
                   "short_band_V", "residual_fluctuation_V", "without", "consistency_samples"});
      });
}

}  // namespace strainwave::bindings
