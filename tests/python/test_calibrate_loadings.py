"""Loading series: which side a load was reached from, and the errors that are read off them."""

from __future__ import annotations

import numpy as np
import pytest

from helpers.load_tables import FULL_SCALE_NM, GAIN, Truth, experiments, series
from strainwave.calibrate.loading_series import series_errors
from strainwave.calibrate.loadings import Loadings, paths, require_loads
from strainwave.calibrate.torque import sensor_gain
from strainwave.calibrate.variance_components import variance_components
from strainwave.errors import InputError


def _lines(loadings: Loadings):
    return [
        sensor_gain(loadings.voltage_V[rows], loadings.load_Nm[rows], intercept=True)
        for rows in loadings.rows()
    ]


def test_the_order_of_loading_tells_the_side() -> None:
    loads = np.array([0.0, 5, 10, 10, 5, 0, -5, -10, -5, 0, 5])
    assert paths(loads).tolist() == [0, 1, 1, 1, -1, -1, -1, -1, 1, 1, 1]


def test_words_tell_the_same_but_for_the_first_zero_of_a_direction() -> None:
    loads = np.array([0.0, 5, 10, 5, 0, 0, -5, -10, -5, 0])
    words = np.array([1, 1, 1, -1, -1, 1, 1, 1, -1, -1], np.int8)
    assert paths(loads, words).tolist() == [0, 1, 1, -1, -1, 0, -1, -1, 1, 1]


def test_words_do_not_need_the_order_of_loaded_rows() -> None:
    loads = np.array([10.0, 5, 5, -5, -10, -5])
    words = np.array([1, -1, 1, 1, 1, -1], np.int8)
    turned = np.array([4, 2, 0, 5, 1, 3])
    assert paths(loads, words)[turned].tolist() == paths(loads[turned], words[turned]).tolist()


@pytest.mark.parametrize("gain", [GAIN, -GAIN])
def test_hysteresis_is_the_width_that_was_put_in(gain: float) -> None:
    found = experiments(Truth(gain=gain, hysteresis=0.01), count=2)
    errors = series_errors(found, _lines(found))
    # The loop is widest at zero, which was read after weights of either direction.
    assert errors.hysteresis_Nm / FULL_SCALE_NM == pytest.approx(0.01, rel=0.02)
    widths = 0.01 * np.sqrt(1 - np.array([0.2, 0.4, 0.6, 0.8]) ** 2)
    assert errors.reversibility_Nm / FULL_SCALE_NM == pytest.approx(widths.mean(), rel=0.02)


def test_no_loop_where_loads_went_up_alone() -> None:
    found = experiments(Truth(hysteresis=0.01), count=1, loads=np.linspace(0, 40, 6))
    errors = series_errors(found, _lines(found))
    assert np.isnan(errors.hysteresis_Nm).all()
    assert np.isnan(errors.zero_return_Nm).all()


def test_loads_that_differ_up_and_down_are_interpolated() -> None:
    loads = [0.0, 10, 20, 30, 40, 35, 25, 15, 5, 0]
    found = experiments(Truth(hysteresis=0.02), count=1, loads=loads)
    errors = series_errors(found, _lines(found))
    assert errors.hysteresis_Nm[0] / FULL_SCALE_NM == pytest.approx(0.02, rel=0.05)


def test_linearity_counts_both_sides_alike_and_no_hysteresis() -> None:
    straight = experiments(Truth(hysteresis=0.02), count=1)
    assert series_errors(straight, _lines(straight)).linearity_Nm[0] < 0.011 * FULL_SCALE_NM
    # A cubic less its least-squares line: largest at the ends, from its own formula.
    bent = experiments(Truth(cubic=-0.02), count=1)
    x = bent.voltage_V
    left = bent.load_Nm - np.polyval(np.polyfit(x, bent.load_Nm, 1), x)
    found = series_errors(bent, _lines(bent)).linearity_Nm[0]
    assert found == pytest.approx(np.max(np.abs(left)), rel=1e-6)
    assert 0.003 < found / FULL_SCALE_NM < 0.02


def test_zero_return_is_last_less_first() -> None:
    found = experiments(count=1, loads=series(both=False))
    moved = found.voltage_V.copy()
    moved[-1] += 0.01
    errors = series_errors(found.with_voltage(moved), _lines(found))
    assert errors.zero_return_Nm[0] == pytest.approx(0.01 * GAIN, rel=1e-6)


def test_repeatability_within_a_setup_and_reproducibility_between() -> None:
    found = experiments(count=4, loads=series(both=False))
    volts = found.voltage_V.copy()
    top = np.flatnonzero(found.load_Nm == FULL_SCALE_NM)
    volts[top] += np.array([0.0, 0.01, 0.05, 0.06])
    paired = Loadings(
        found.names,
        found.experiment,
        found.load_Nm,
        volts,
        found.path,
        np.array([0.0, 0.0, 1.0, 1.0]),
    )
    errors = series_errors(paired, _lines(found))
    assert errors.repeatability_Nm == pytest.approx(0.01 * GAIN, rel=1e-6)
    assert errors.reproducibility_Nm == pytest.approx(0.05 * GAIN, rel=1e-6)
    single = series_errors(found, _lines(found))
    assert np.isnan(single.repeatability_Nm)


def test_loads_that_determine_nothing_are_refused() -> None:
    with pytest.raises(InputError, match="experiment 1: all of its 3 loads are 5 Nm"):
        require_loads(experiments(count=1, loads=[5.0, 5.0, 5.0]), intercept=True)
    with pytest.raises(InputError, match="experiment 1: none of its 2 loads differs from 0"):
        require_loads(experiments(count=1, loads=[0.0, 0.0]), intercept=False)
    require_loads(experiments(count=1, loads=[5.0, 5.0]), intercept=False)


def test_variance_components_are_those_of_the_groups() -> None:
    rng = np.random.default_rng(3)
    within, between, covered = [], [], []
    for _ in range(1000):
        groups = np.repeat(np.arange(6), 3)
        gains = 5.0 * (1 + 0.02 * rng.normal(size=6)[groups] + 0.01 * rng.normal(size=18))
        found = variance_components(gains, groups.tolist())
        assert found is not None
        within.append(found.within**2)
        between.append(found.between**2)
        of_groups = found.of_groups
        reach = 2.5706 * of_groups.standard_uncertainty * of_groups.gain_Nm_per_V
        covered.append(abs(of_groups.gain_Nm_per_V - 5.0) <= reach)
    assert 0.93 < np.mean(covered) < 0.97
    assert np.sqrt(np.mean(within)) == pytest.approx(0.01, rel=0.04)
    assert np.sqrt(np.mean(between)) == pytest.approx(0.02, rel=0.06)
    assert variance_components([1.0, 2.0], ["a", "b"]) is None
    assert variance_components([1.0, 2.0], ["a", "a"]) is None


def test_a_slow_sweep_has_sides_and_loads_too() -> None:
    one_way = np.linspace(0.0, 40.0, 20_001)
    loads = np.concatenate([one_way, one_way[::-1]])
    found = experiments(Truth(hysteresis=0.01), count=1, loads=loads)
    assert 480 <= len(np.unique(found.levels())) <= 502
    assert found.path[300] == 1
    assert found.path[-300] == -1
    errors = series_errors(found, _lines(found))
    assert errors.hysteresis_Nm[0] / FULL_SCALE_NM == pytest.approx(0.01, rel=0.03)
