"""A joint's configuration as a tree of values, in the order in which the core declares them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave import _core
from strainwave.configuration import consistency_settings_of, gear_of, learned_of, sensor_of
from strainwave.configuration.sections import missing
from strainwave.export.values import Elements, Enumerator, Fields, Node, Real, Truth, Whole, reals
from strainwave.joint import RippleFilter

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strainwave.joint import Joint

#: Capacities that the core fixes: powers of the linearisation, frozen terms, directions of the
#: gauges' signals and watched harmonics.
LINEARISATION_TERMS: Final = 4
FROZEN_TERMS: Final = 8
SIGNAL_DIRECTIONS: Final = 9
WATCHED_HARMONICS: Final = 4


@dataclass(frozen=True)
class JointValues:
    """All that a header says of a joint, and the capacities it needs.

    Attributes
    ----------
    filter : str
        ``ripple`` or ``oscillator``.
    gauges, capacity : int
        Channels, and pairs of coefficients or orders of the filter.
    gear, sensor : Fields
        The gear and the chain.
    learned : Fields or None
        What the ripple filter starts with; None where the joint has nothing.
    config : TorqueSensorConfig
        The same chain as the core holds it in Python.
    kept : LearnedRipple or None
        The same coefficients.
    """

    filter: str
    gauges: int
    capacity: int
    gear: Fields
    sensor: Fields
    learned: Fields | None
    config: _core.TorqueSensorConfig
    kept: _core.LearnedRipple | None

    @property
    def parts(self) -> list[Node]:
        """What the checksum covers, in its order."""
        return [self.gear, self.sensor, *([] if self.learned is None else [self.learned])]


def values_of(joint: Joint) -> JointValues:
    """Collect a joint's values.

    Parameters
    ----------
    joint : Joint
        A joint from which `strainwave.configuration.sensor_of` makes the whole chain.

    Returns
    -------
    JointValues
        The values.

    Raises
    ------
    InputError
        If a section is missing that the chain needs, or the core cannot use a value.
    """
    if joint.ripple_filter is None:
        raise missing(joint, "ripple_filter")
    config = sensor_of(joint)
    gauges = len(config.gains.values)
    members: dict[str, Node] = {
        "converter": _converter(config.converter),
        "gains": _gains(config.gains.values, gauges),
        "calibration": _calibration(config.calibration),
    }
    kept = learned = None
    if isinstance(config.filter, _core.RippleFilterConfig):
        capacity = sum(map(_pairs, config.filter.orders))
        members["filter"] = _ripple(config.filter, capacity)
        members["sample_period_s"] = Real(config.sample_period_s)
        kept = learned_of(joint)
        learned = None if kept is None else _learned(kept, capacity)
    else:
        capacity = len(config.filter.orders)
        members["filter"] = _oscillator(config.filter)
    members["monitor"] = _monitor(joint, config, gauges)
    left_out = frozenset(() if config.monitor is not None else ("monitor",))
    return JointValues(
        filter="ripple" if isinstance(joint.ripple_filter, RippleFilter) else "oscillator",
        gauges=gauges,
        capacity=capacity,
        gear=_gear(gear_of(joint)),
        sensor=Fields(members, left_out=left_out),
        learned=learned,
        config=config,
        kept=kept,
    )


def _pairs(order: _core.RippleOrder) -> int:
    return 1 + order.with_load + order.with_speed + order.with_direction


def _rational(value: _core.Rational) -> Fields:
    return _ratio(value.numerator, value.denominator)


def _ratio(numerator: int, denominator: int) -> Fields:
    return Fields(
        {"numerator": Whole(numerator, "u32"), "denominator": Whole(denominator, "u32")},
        is_flat=True,
    )


def _gear(gear: _core.Gear) -> Fields:
    names = {each: place for place, each in enumerate(_core.GearConfiguration)}
    configuration = gear.configuration
    return Fields(
        {
            "configuration": Enumerator(
                f"GearConfiguration::{configuration.name}", names[configuration]
            ),
            "ratio": _rational(gear.ratio),
            "output_direction": Whole(gear.output_direction, "i32"),
            "rated_torque_Nm": Real(gear.rated_torque_Nm),
        }
    )


def _converter(converter: _core.Converter) -> Fields:
    return Fields(
        {
            "bits": Whole(converter.bits, "u32"),
            "minimum_V": Real(converter.minimum_V),
            "maximum_V": Real(converter.maximum_V),
            "lowest_code": Whole(converter.lowest_code, "i32"),
        },
        is_flat=True,
    )


def _gains(values: Sequence[float], gauges: int) -> Fields:
    return Fields({"count": Whole(gauges, "count"), "values": reals(values)}, is_flat=True)


def _calibration(calibration: _core.TorqueCalibration) -> Fields:
    terms = list(calibration.linearisation)
    terms += [0.0] * (LINEARISATION_TERMS - len(terms))
    return Fields(
        {
            "gain_Nm_per_V": Real(calibration.gain_Nm_per_V),
            "zero_V": Real(calibration.zero_V),
            "full_scale_Nm": Real(calibration.full_scale_Nm),
            "linearisation": reals(terms),
            "reference_temperature_degC": Real(calibration.reference_temperature_degC),
            "zero_drift_V_per_K": Real(calibration.zero_drift_V_per_K),
            "gain_drift_per_K": Real(calibration.gain_drift_per_K),
            "minimum_temperature_degC": Real(calibration.minimum_temperature_degC),
            "maximum_temperature_degC": Real(calibration.maximum_temperature_degC),
        }
    )


def _order(order: _core.RippleOrder) -> Fields:
    return Fields(
        {
            "order": _rational(order.order),
            "with_load": Truth(order.with_load),
            "with_speed": Truth(order.with_speed),
            "with_direction": Truth(order.with_direction),
            "keep": Truth(order.keep),
        },
        is_flat=True,
    )


def _orders(orders: Sequence[_core.RippleOrder], capacity: int) -> Elements:
    """Write the orders; each has one pair at least, so that some of the room may be left."""
    unused = Fields({"order": _ratio(2, 1), "terms": Elements([Truth(False)] * 4)})
    return Elements([_order(order) for order in orders], [unused] * (capacity - len(orders)))


def _frozen(terms: Sequence[_core.FrozenTerm]) -> Elements:
    unused = Fields({"order": _ratio(1, 100), "amplitudes": reals([0.0, 0.0])})
    written = [
        Fields(
            {
                "order": _rational(term.order),
                "cosine_Nm": Real(term.cosine_Nm),
                "sine_Nm": Real(term.sine_Nm),
            },
            is_flat=True,
        )
        for term in terms
    ]
    return Elements(written, [unused] * (FROZEN_TERMS - len(terms)))


def _ripple(config: _core.RippleFilterConfig, capacity: int) -> Fields:
    return Fields(
        {
            "order_count": Whole(len(config.orders), "count"),
            "orders": _orders(config.orders, capacity),
            "memory_turns": Real(config.memory_turns),
            "torque_noise_Nm": Real(config.torque_noise_Nm),
            "torque_walk_Nm_per_sqrt_s": Real(config.torque_walk_Nm_per_sqrt_s),
            "initial_amplitude_Nm": Real(config.initial_amplitude_Nm),
            "rated_torque_Nm": Real(config.rated_torque_Nm),
            "reference_speed_rad_s": Real(config.reference_speed_rad_s),
            "angle_to_torque_delay_s": Real(config.angle_to_torque_delay_s),
            "minimum_speed_rad_s": Real(config.minimum_speed_rad_s),
            "frozen_count": Whole(len(config.frozen), "count"),
            "frozen": _frozen(config.frozen),
        }
    )


def _oscillator(config: _core.OscillatorFilterConfig) -> Fields:
    sources = {each: place for place, each in enumerate(_core.RotationSource)}
    source = config.rotation_source
    return Fields(
        {
            "order_count": Whole(len(config.orders), "count"),
            "orders": Elements([_rational(order) for order in config.orders]),
            "process_noise_variance_Nm2": reals(config.process_noise_variance_Nm2),
            "measurement_noise_variance_Nm2": Real(config.measurement_noise_variance_Nm2),
            "initial_variance_Nm2": Real(config.initial_variance_Nm2),
            "sample_period_s": Real(config.sample_period_s),
            "rotation_source": Enumerator(f"RotationSource::{source.name}", sources[source]),
            "minimum_travel_rad": Real(config.minimum_travel_rad),
            "minimum_speed_rad_s": Real(config.minimum_speed_rad_s),
            "variance_limit_ratio": Real(config.variance_limit_ratio),
        }
    )


def _learned(kept: _core.LearnedRipple, capacity: int) -> Fields:
    return Fields(
        {
            "order_count": Whole(len(kept.orders), "count"),
            "orders": _orders(kept.orders, capacity),
            "coefficients_Nm": reals(kept.coefficients_Nm),
            "standard_deviations_Nm": reals(kept.standard_deviations_Nm),
            "innovation_scale_Nm": Real(kept.innovation_scale_Nm),
        }
    )


def _monitor(joint: Joint, config: _core.TorqueSensorConfig, gauges: int) -> Fields:
    """Write the watch over the gauges; without one, the core's inactive default."""
    monitor = config.monitor
    shown = _core.GaugeMonitorConfig() if monitor is None else monitor
    rails = {each: place for place, each in enumerate(_core.TornGaugeRail)}
    rail = shown.torn_gauge_rail
    return Fields(
        {
            "active": Truth(monitor is not None),
            "rail_samples": Whole(shown.rail_samples, "u32"),
            "lowest_V": Real(shown.lowest_V),
            "highest_V": Real(shown.highest_V),
            "torn_gauge_rail": Enumerator(f"TornGaugeRail::{rail.name}", rails[rail]),
            "overload_V": Real(shown.overload_V),
            "stuck_samples": Whole(shown.stuck_samples, "u32"),
            "flat_travel_turns": Real(shown.flat_travel_turns),
            "flat_band_V": Real(shown.flat_band_V),
            "amplifier_zero_V": Real(shown.amplifier_zero_V),
            "short_band_V": Real(shown.short_band_V),
            "consistency": _consistency(joint, config, gauges),
            "residual_fluctuation_V": Real(shown.residual_fluctuation_V),
            "without": _without(shown.without, gauges),
        }
    )


def _consistency(joint: Joint, config: _core.TorqueSensorConfig, gauges: int) -> Fields:
    settings = None
    if config.monitor is not None:
        settings = consistency_settings_of(joint, config.sample_period_s)
    no_gauge = [reals([0.0] * gauges)]
    no_wave = [reals([0.0, 0.0])]
    if settings is None:
        directions = Elements([], no_gauge * SIGNAL_DIRECTIONS)
        wave = Elements([], no_wave * WATCHED_HARMONICS * gauges)
        zeros = Elements([], no_gauge)
        samples, direction_count, harmonics, factor = 0, 1, 0, _ratio(1, 1)
        delay = limit = growth = 0.0
    else:
        direction_count = len(settings.signal_directions)
        directions = Elements(
            [reals(row) for row in settings.signal_directions],
            no_gauge * (SIGNAL_DIRECTIONS - direction_count),
        )
        harmonics = len(settings.fluctuation_V) // 2
        wave = Elements(
            [_wave_of(settings.fluctuation_V[:, j]) for j in range(gauges)] if harmonics else [],
            [] if harmonics else no_wave * WATCHED_HARMONICS * gauges,
        )
        zeros = reals(settings.gauge_zero_V.tolist())
        samples, factor = settings.samples, _rational(_core.Rational(settings.wave_factor))
        delay, limit, growth = settings.delay_samples, settings.limit_V, settings.limit_per_V
    return Fields(
        {
            "samples": Whole(samples, "u32"),
            "direction_count": Whole(direction_count, "count"),
            "directions": directions,
            "harmonic_count": Whole(harmonics, "count"),
            "wave_factor": factor,
            "wave_V": wave,
            "zero_V": zeros,
            "delay_samples": Real(delay),
            "limit_V": Real(limit),
            "limit_per_V": Real(growth),
        }
    )


def _wave_of(rows_V: np.ndarray) -> Elements:
    """Write one gauge's harmonics; the rows alternate between sine and cosine of a phasor."""
    pairs = np.reshape(rows_V, (-1, 2))
    return Elements(
        [
            Fields({"cosine": Real(float(first)), "sine": Real(float(second))}, is_flat=True)
            for first, second in pairs
        ],
        [reals([0.0, 0.0])] * (WATCHED_HARMONICS - len(pairs)),
    )


def _without(sets: Sequence[_core.GainsWithoutGauge], gauges: int) -> Elements:
    by_gauge = {each.gauge: each for each in sets}
    unused = Fields(
        {
            "available": Truth(False),
            "gains": Fields(
                {"count": Whole(1, "count"), "values": reals([1.0] + [0.0] * (gauges - 1))},
                is_flat=True,
            ),
            "zero_shift_V": Real(0.0),
            "residual_fluctuation_V": Real(0.0),
        }
    )
    return Elements(
        [
            Fields(
                {
                    "available": Truth(True),
                    "gains": _gains(by_gauge[number].gains, gauges),
                    "zero_shift_V": Real(by_gauge[number].zero_shift_V),
                    "residual_fluctuation_V": Real(by_gauge[number].residual_fluctuation_V),
                }
            )
            if number in by_gauge
            else unused
            for number in range(1, gauges + 1)
        ]
    )
