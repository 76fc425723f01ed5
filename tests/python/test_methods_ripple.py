"""The ripple filter over recordings: what it starts with."""

from __future__ import annotations

import numpy as np
import pytest

import strainwave
from benchmarks.accuracy.evaluation import log_of
from benchmarks.accuracy.joint import FULL_SCALE_NM, make_joint, simulate
from benchmarks.accuracy.ripple import RIGHT
from strainwave.methods.registry import Setting, build_method
from strainwave.methods.ripple import learned_at_the_start
from strainwave.samples import Samples


def _config(**changes: float) -> strainwave.RippleFilterConfig:
    return strainwave.RippleFilterConfig(**{"orders": [2, 4], "memory_turns": 20.0, **changes})


def _samples(rows: int, delay_s: float = 0.0, speed_rad_s: float = 120.0) -> Samples:
    time_s = np.arange(rows) * 1e-3
    angle_rad = 7.0 + speed_rad_s * time_s + 0.2 * np.sin(3.0 * time_s)
    of_torque_rad = np.interp(time_s - delay_s, time_s, angle_rad)
    ripple_Nm = 1.6 * np.cos(2 * of_torque_rad - 0.7) + 0.5 * np.sin(4 * of_torque_rad)
    noise_Nm = 0.04 * np.random.default_rng(8).standard_normal(rows)
    return Samples(time_s, angle_rad, 3.0 + ripple_Nm + noise_Nm, np.zeros(rows))


def test_the_first_rows_are_as_clean_as_the_others() -> None:
    run = simulate(make_joint(RIGHT, 41))
    log = log_of(run)
    samples = Samples(log.time_s, log.wave_angle_rad, log.torque_Nm, log.expected_torque_Nm)
    for excerpt, low, high in ((samples, 0.05, 0.16), (None, 0.5, 5.0)):
        method = build_method("ripple", Setting(1e-3, None, FULL_SCALE_NM, excerpt=excerpt))
        error_Nm = method.process(samples).torque_Nm - run.true_torque_Nm
        # Noise alone is 0.1 %FS.
        assert low < 100 * np.sqrt(np.mean(error_Nm[:100] ** 2)) / FULL_SCALE_NM < high


@pytest.mark.parametrize("delay_s", [0.0, 0.0023])
def test_coefficients_of_the_start_are_the_ripples(delay_s: float) -> None:
    learned = learned_at_the_start(
        _samples(6000, delay_s), _config(angle_to_torque_delay_s=delay_s)
    )
    assert learned is not None
    expected = [1.6 * np.cos(0.7), 1.6 * np.sin(0.7), 0.0, 0.5]
    deviations = np.array(learned.standard_deviations_Nm)
    # The lead that a turned delay is makes an error of its own.
    allowed = np.maximum(4 * deviations, 0.02 if delay_s else 0.0)
    assert np.all(np.abs(np.array(learned.coefficients_Nm) - expected) < allowed)
    assert np.all((deviations > 1e-4) & (deviations < 0.05))


def test_it_is_the_start_that_is_learned_and_not_the_end() -> None:
    samples = _samples(40_000)
    grown_Nm = samples.torque_Nm + 2.0 * (samples.time_s > 20.0) * np.cos(
        2 * samples.motor_angle_rad
    )
    grown = Samples(samples.time_s, samples.motor_angle_rad, grown_Nm, samples.expected_torque_Nm)
    learned = learned_at_the_start(grown, _config())
    assert learned is not None
    assert learned.coefficients_Nm[0] == pytest.approx(1.6 * np.cos(0.7), abs=0.03)


def test_where_nothing_can_be_learned_nothing_is_started_with() -> None:
    assert learned_at_the_start(_samples(3000, speed_rad_s=0.0), _config()) is None
    long_delay = _config(angle_to_torque_delay_s=0.02)
    assert learned_at_the_start(_samples(3000), long_delay) is None
    one = Samples(np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(1))
    assert learned_at_the_start(one, _config()) is None
    unknown = _samples(3000)
    unknown.motor_angle_rad[:] = np.nan
    assert learned_at_the_start(unknown, _config()) is None
