"""Gains for a circuit: against brute force, against rounding one by one, and the standard's series."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strainwave.calibrate.circuit import E24, E96, parse_circuit
from strainwave.calibrate.fluctuation import compensation_conditions, equally_spaced_positions_rad
from strainwave.calibrate.gains import compensating_gains
from strainwave.calibrate.quantise import quantise_gains
from strainwave.errors import InputError

GODLER = compensation_conditions(
    [[1.0, 1.07, 1.15]], np.deg2rad([[0.0, -1.5, -0.4]]), equally_spaced_positions_rad(3)
)


def left(conditions, gains):
    return np.hypot(*(conditions @ gains)) / gains.sum()


def test_series_are_those_of_the_standard() -> None:
    assert len(E24) == 24
    assert len(E96) == 96
    assert (E96[0], E96[1], E96[50], E96[-1]) == (1.0, 1.02, 3.32, 9.76)
    # Neighbours of a series are about a constant factor apart.
    assert max(b / a for a, b in itertools.pairwise(E24)) < 1.16
    assert max(b / a for a, b in itertools.pairwise(E96)) < 1.031


@pytest.mark.parametrize(
    "text", ["potentiometer:64", "potentiometer:256:0.5:1.5", "0.02", "E24", "E96"]
)
def test_no_worse_than_one_by_one_and_as_good_as_brute_force(text: str) -> None:
    circuit = parse_circuit(text)
    gains = compensating_gains(GODLER).gains
    found = quantise_gains(circuit, gains, GODLER, np.ones(3))
    assert np.all(np.isin(found.gains, circuit.values))
    assert left(GODLER, found.gains) <= left(GODLER, found.rounded)
    near = circuit.values[(circuit.values > 0.8) & (circuit.values < 1.25)]
    tried = np.array(list(itertools.product(near, repeat=3))) if len(near) < 60 else None
    if tried is not None:
        best = min(left(GODLER, each) for each in tried)
        assert left(GODLER, found.gains) <= best * 1.5 + 1e-12


@settings(max_examples=50, deadline=None)
@given(gains=st.lists(st.floats(-99, 99), min_size=1, max_size=9), step=st.floats(1e-4, 0.5))
def test_steps_are_the_nearest(gains: list[float], step: float) -> None:
    given_gains = np.array(gains)
    found = parse_circuit(repr(step)).nearest(given_gains)
    assert np.all(np.abs(found - given_gains) <= step / 2 * (1 + 1e-9) + 1e-9)


@pytest.mark.parametrize("name", ["e24", "E96", "potentiometer:17:-3:2", "potentiometer:2"])
@settings(max_examples=50, deadline=None)
@given(
    gains=st.lists(st.floats(-100, 100), min_size=1, max_size=5),
    width=st.sampled_from([1, 2, 3, 5]),
)
def test_nearest_and_neighbours_against_all_values(
    name: str, gains: list[float], width: int
) -> None:
    circuit = parse_circuit(name)
    series = {"e24": E24, "E96": E96}.get(name)
    everything = circuit.values
    if series is not None:
        # Input resistors against a feedback of 10 kOhm, from 100 Ohm to nearly 100 kOhm and above.
        magnitudes = 10.0 / np.outer(10.0 ** np.arange(-1, 4), series).ravel()
        everything = np.concatenate([magnitudes, -magnitudes])
    given_gains = np.array(gains)
    away = np.sort(np.abs(everything - given_gains[:, np.newaxis]), axis=1)
    found = circuit.nearest(given_gains)
    assert np.abs(found - given_gains) == pytest.approx(away[:, 0], abs=1e-12)
    several = circuit.neighbours(given_gains, width)
    assert several.shape == (len(gains), min(width, len(circuit.values)))
    distances = np.abs(several - given_gains[:, np.newaxis])
    assert distances[:, 0] == pytest.approx(away[:, 0], abs=1e-12)
    # Resistors keep the gain's sign; of magnitudes these are the nearest then.
    sized = np.abs(given_gains) if series is not None else given_gains
    best = np.sort(np.abs(circuit.values - sized[:, np.newaxis]), axis=1)[:, :width]
    assert distances == pytest.approx(best, abs=1e-12)


@pytest.mark.parametrize("name", ["E24", "E96", "0.01", "potentiometer:256"])
def test_values_of_a_circuit_stay(name: str) -> None:
    circuit = parse_circuit(name)
    assert np.array_equal(circuit.nearest(circuit.values), circuit.values)
    assert np.isnan(circuit.nearest(np.array([np.nan]))[0])


def test_finer_steps_leave_less() -> None:
    gains = compensating_gains(GODLER).gains
    amounts = [
        left(
            GODLER,
            quantise_gains(
                parse_circuit(f"potentiometer:{steps}"), gains, GODLER, np.ones(3)
            ).gains,
        )
        for steps in (16, 128, 1024)
    ]
    assert amounts[0] > 3 * amounts[1] > 9 * amounts[2]


@settings(max_examples=40)
@given(st.integers(3, 11), st.integers(0, 2**31), st.sampled_from(["potentiometer:256:0:4", "E96"]))
def test_never_worse_than_one_by_one(gauges: int, seed: int, text: str) -> None:
    rng = np.random.default_rng(seed)
    conditions = compensation_conditions(
        rng.uniform(0.9, 1.1, (1, gauges)),
        rng.normal(0, 0.1, (1, gauges)),
        equally_spaced_positions_rad(gauges),
    )
    gains = compensating_gains(conditions).gains
    found = quantise_gains(parse_circuit(text), gains, conditions, np.ones(gauges))
    assert left(conditions, found.gains) <= left(conditions, found.rounded) * (1 + 1e-9)
    assert np.all(np.abs(found.gains / gains - 1) < 0.3)


def test_resistors_keep_the_sign() -> None:
    found = quantise_gains(parse_circuit("E96"), np.array([1.0, -0.5, 1.2]), GODLER, np.ones(3))
    assert np.sign(found.gains).tolist() == [1, -1, 1]
    assert found.settings[1].endswith("kOhm, inverted input")


@pytest.mark.parametrize(
    "text",
    [
        "E12",
        "potentiometer",
        "potentiometer:1",
        "potentiometer:a",
        "potentiometer:9:2:1",
        "potentiometer:9:0",
        "potentiometer:9:0:x",
        "",
        "potentiometer:9:nan:2",
        "E48",
        "0",
        "nan",
        "-0.01",
        "0.6",
        "1e-5",
    ],
)
def test_what_is_no_circuit_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="expected potentiometer:256"):
        parse_circuit(text)


def test_gain_outside_the_range_is_refused() -> None:
    with pytest.raises(InputError, match=r"gauge 2 needs a gain of 2\.5"):
        quantise_gains(
            parse_circuit("potentiometer:256"), np.array([1, 2.5, 1]), GODLER, np.ones(3)
        )
