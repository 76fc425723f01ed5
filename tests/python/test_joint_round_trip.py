"""Any joint survives being written and read."""

import math
import string
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from strainwave.joint import (
    SECTION_NAMES,
    AngleColumn,
    Gains,
    GainsWithoutGauge,
    Gauges,
    GaugeSignal,
    Gear,
    Joint,
    Misalignment,
    MisalignmentTerm,
    OscillatorFilter,
    Provenance,
    RippleFilter,
    Rosette,
    Signals,
    Temperature,
    TimeColumn,
    TorqueCalibration,
    TorqueColumn,
    VoltageColumn,
    canonical_hash,
    new_joint,
    read_joint,
    write_joint,
)

FINITE = st.floats(allow_nan=False, allow_infinity=False)
POSITIVE = st.floats(min_value=1e-300, max_value=1e300)
LINE = st.text(
    st.characters(exclude_categories=("Cc", "Cs")) | st.sampled_from("\"'#[]\\=é"), min_size=1
)
LINES = st.text(
    st.characters(exclude_categories=("Cc", "Cs")) | st.sampled_from("\n\t\"'#\\"), min_size=1
)
SIGN = st.sampled_from([1, -1])
TIMES = st.datetimes(
    min_value=datetime(1970, 1, 2),  # noqa: DTZ001 - hypothesis wants it without a zone
    max_value=datetime(2200, 1, 1),  # noqa: DTZ001
    timezones=st.integers(-14 * 60, 14 * 60).map(
        lambda minutes: timezone(timedelta(minutes=minutes))
    ),
)


def maybe(strategy: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.none() | strategy


def built(model: type, **fields: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    """Build a model; a field that draws None is left out."""
    return st.fixed_dictionaries(fields).map(
        lambda values: model(**{key: item for key, item in values.items() if item is not None})
    )


def tuples(strategy: st.SearchStrategy[Any], least: int, most: int) -> st.SearchStrategy[Any]:
    return st.lists(strategy, min_size=least, max_size=most).map(tuple)


def column(model: type, unit: st.SearchStrategy[str]) -> st.SearchStrategy[Any]:
    return built(model, column=LINE | st.integers(1, 1_000_000), unit=unit, sign=maybe(SIGN))


COUNTS = st.integers(1, 2**32).map(lambda count: f"counts/{count}")
VOLTAGE = column(VoltageColumn, st.sampled_from(["V", "mV"]))

PROVENANCE = built(
    Provenance,
    input=LINE,
    input_sha256=maybe(st.text(string.hexdigits, min_size=64, max_size=64)),
    created=TIMES,
    version=LINE,
    command=maybe(LINE),
)
GEAR = built(
    Gear,
    configuration=st.sampled_from(["fixed_circular_spline", "fixed_flexspline"]),
    ratio=st.floats(1.0, 1e6),
    output_direction=maybe(SIGN),
    rated_torque_Nm=POSITIVE,
    ratio_standard_uncertainty=maybe(POSITIVE),
    identified_factor_m=maybe(st.floats(0.5, 2.0)),
)


@st.composite
def gauge_sections(draw: st.DrawFn) -> dict[str, Any]:
    """Draw gauges, gains and signals that agree on the number of gauges."""
    count = draw(st.integers(2, 5))
    rosette = built(
        Rosette,
        position_rad=st.floats(-math.pi, math.pi),
        radius_m=maybe(st.floats(1e-3, 1.0)),
        orientation_error_rad=maybe(st.floats(-0.1, 0.1)),
        gauge_factor=st.floats(0.1, 200.0),
    )
    gauges = built(
        Gauges,
        wiring=st.just("half_bridge_each"),
        bridge_supply_V=st.floats(0.1, 30.0),
        amplifier_gain=st.floats(1.0, 1e5),
        amplifier_offset_V=maybe(FINITE),
        rosettes=tuples(rosette, count, count),
    )
    weights = st.lists(st.floats(0.01, 10.0), min_size=count, max_size=count)
    lost = draw(st.lists(st.integers(1, count), unique=True))
    gains = built(
        Gains,
        gains=weights.map(tuple),
        torque_sensitivities=maybe(weights.map(tuple)),
        harmonics=maybe(st.just((1, 2))),
        condition_number=maybe(st.floats(1.0, 1e9)),
        without_gauge=st.just(
            tuple(
                GainsWithoutGauge(
                    gauge=gauge,
                    gains=tuple(0.0 if j == gauge - 1 else 1.25 for j in range(count)),
                )
                for gauge in lost
            )
        ),
        gauge_signals=maybe(
            tuples(
                built(
                    GaugeSignal,
                    zero_V=FINITE,
                    amplitudes_V=tuples(FINITE, 2, 2),
                    phases_rad=tuples(FINITE, 2, 2),
                ),
                count,
                count,
            )
        ),
        noise_V=maybe(st.floats(1e-9, 1.0)),
        consistency_limit_V=maybe(st.floats(1e-9, 1.0)),
        consistency_limit_share=maybe(st.floats(0.0, 1.0)),
        detection_time_s=maybe(st.floats(1e-3, 1.0)),
    )
    signals = built(
        Signals,
        time=maybe(column(TimeColumn, st.sampled_from(["s", "ns"]))),
        motor_angle=maybe(column(AngleColumn, COUNTS | st.just("rad"))),
        output_angle=maybe(column(AngleColumn, COUNTS | st.just("deg"))),
        torque=maybe(column(TorqueColumn, st.just("Nm"))),
        sensor_voltage=maybe(VOLTAGE),
        gauges=tuples(VOLTAGE, count, count) | st.just(()),
        sampling_rate_Hz=maybe(st.floats(1e-3, 1e6)),
        angle_to_torque_delay_s=maybe(st.floats(-1.0, 1.0)),
    )
    return {"gauges": draw(gauges), "gains": draw(gains), "signals": draw(signals)}


OSCILLATOR_FILTER = built(
    OscillatorFilter,
    method=st.just("oscillator"),
    orders=st.sampled_from([(2.0,), (2.0, 4.0, "1/7"), (0.1, "3/1000000"), ("13m", "17/R")]),
    process_noise_variances_Nm2=st.tuples(POSITIVE),
    measurement_noise_variance_Nm2=POSITIVE,
    initial_variance_Nm2=POSITIVE,
    sample_period_s=st.floats(1e-6, 1.0),
)


@st.composite
def ripple_filters(draw: st.DrawFn) -> RippleFilter:
    """Draw a section of method ripple, with or without what was learned."""
    # A gear's factor m is at most 2 here, and n/R and nm are different from all others.
    orders = draw(
        st.lists(st.sampled_from([300.25, 301.5, "997/3", "29m"]), min_size=1, unique=True)
    )
    settings_Nm = st.floats(1e-9, 1e9)
    some = tuples(st.sampled_from(orders), 0, 4).map(lambda subset: tuple(dict.fromkeys(subset)))
    subsets = {
        f"{kind}_orders": draw(maybe(some)) for kind in ("load", "speed", "direction", "kept")
    }
    pairs = len(orders) + sum(
        len(subset or ()) for key, subset in subsets.items() if key != "kept_orders"
    )
    learned: dict[str, Any] = {}
    if draw(st.booleans()):
        learned = {
            "learned_coefficients_Nm": draw(tuples(st.floats(-1e9, 1e9), 2 * pairs, 2 * pairs)),
            "learned_standard_deviations_Nm": draw(
                tuples(st.floats(0.0, 1e9), 2 * pairs, 2 * pairs)
            ),
            "learned_innovation_scale_Nm": draw(maybe(st.floats(0.0, 1e9))),
        }
    return draw(
        built(
            RippleFilter,
            method=st.just("ripple"),
            orders=st.just(tuple(orders)),
            memory_turns=st.floats(0.1, 1e6),
            torque_noise_Nm=settings_Nm,
            torque_walk_Nm_per_sqrt_s=settings_Nm,
            initial_amplitude_Nm=maybe(settings_Nm),
            reference_speed_rad_s=maybe(st.floats(1e-3, 1e6)),
            minimum_speed_rad_s=maybe(st.floats(0.0, 100.0)),
            **{key: st.just(value) for key, value in (subsets | learned).items()},
        )
    )


OTHERS = st.fixed_dictionaries(
    {
        "gear": GEAR,
        "torque_calibration": built(
            TorqueCalibration,
            gain_Nm_per_V=POSITIVE | POSITIVE.map(lambda gain: -gain),
            zero_V=maybe(FINITE),
            linearisation=tuples(FINITE, 0, 4),
            consistency=maybe(POSITIVE),
            experiment_count=maybe(st.integers(1, 1000)),
        ),
        "ripple_filter": OSCILLATOR_FILTER | ripple_filters(),
        "misalignment": built(
            Misalignment,
            zero_of_output_angle_rad=maybe(FINITE),
            terms=st.lists(
                built(
                    MisalignmentTerm,
                    cycles_per_output_turn=st.integers(1, 1000),
                    cosine_Nm=FINITE,
                    sine_Nm=FINITE,
                ),
                min_size=1,
                max_size=4,
                unique_by=lambda term: term.cycles_per_output_turn,
            ).map(tuple),
        ),
        "temperature": built(
            Temperature,
            reference_temperature_degC=st.floats(-50.0, 100.0),
            zero_drift_V_per_K=FINITE,
            gain_drift_per_K=FINITE,
        ),
    }
)


@settings(max_examples=150, deadline=None)
@given(
    name=LINE,
    serial=maybe(LINE),
    notes=maybe(LINES),
    sections=st.tuples(gauge_sections(), OTHERS).map(lambda pair: {**pair[0], **pair[1]}),
    order=st.permutations(SECTION_NAMES),
    data=st.data(),
)
def test_any_joint_survives_writing_and_reading(
    name: str,
    serial: str | None,
    notes: str | None,
    sections: dict[str, Any],
    order: list[str],
    data: st.DataObject,
) -> None:
    joint_file = new_joint(name, serial=serial, notes=notes)
    expected: dict[str, Any] = {"joint": joint_file.joint.identity}
    # The gear first: linearisation and some orders need it.
    for section in ["gear", *data.draw(st.lists(st.sampled_from(order), unique=True))]:
        provenance = data.draw(PROVENANCE)
        joint_file.set_section(section, sections[section], provenance)
        expected[section] = sections[section].model_copy(update={"provenance": provenance})
    if joint_file.joint.history is not None:
        expected["history"] = joint_file.joint.history
    joint = Joint.model_validate(expected)
    assert joint_file.joint == joint
    with TemporaryDirectory() as folder:
        path = Path(folder) / "joint.toml"
        write_joint(joint_file, path)
        read = read_joint(path)
    assert read.joint == joint
    assert canonical_hash(read.joint) == canonical_hash(joint)
    assert (joint.identity.name, joint.identity.serial, joint.identity.notes) == (
        name,
        serial,
        notes,
    )


@given(TIMES)
def test_times_are_kept_in_utc_to_the_microsecond(time: datetime) -> None:
    provenance = Provenance(input="a", created=time, version="1")
    assert provenance.created == time
    assert provenance.created.tzinfo == UTC
