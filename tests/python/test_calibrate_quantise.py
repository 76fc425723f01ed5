"""Gains for a circuit: against brute force, against rounding one by one, and the standard's series."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strainwave.calibrate.fluctuation import compensation_conditions, equally_spaced_positions_rad
from strainwave.calibrate.gains import compensating_gains
from strainwave.calibrate.quantise import E24, E96, parse_circuit, quantise_gains
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


@pytest.mark.parametrize("text", ["potentiometer:64", "potentiometer:256:0.5:1.5", "E24", "E96"])
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
