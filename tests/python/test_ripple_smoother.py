"""The ripple smoother against a dense Rauch-Tung-Striebel smoother written out anew."""

from __future__ import annotations

import numpy as np
import pytest

import strainwave
from strainwave import _core
from strainwave.errors import InputError

INTERVAL_S = 1e-3


def _recording(samples: int, seed: int = 5) -> dict[str, np.ndarray]:
    """Ripple whose amplitude wanders, at constant speed, with a slow true torque."""
    generator = np.random.default_rng(seed)
    time_s = np.arange(samples) * INTERVAL_S
    angle_rad = 120.0 * time_s
    amplitude = 1.0 + 0.3 * np.sin(angle_rad / 250.0)
    ripple_Nm = amplitude * np.cos(2 * angle_rad - 0.4) + 0.3 * np.sin(4 * angle_rad)
    torque_Nm = 2.0 * np.sin(2 * np.pi * time_s / 3.0)
    measured_Nm = torque_Nm + ripple_Nm + 0.04 * generator.standard_normal(samples)
    return {
        "time_s": time_s,
        "angle_rad": angle_rad,
        "ripple_Nm": ripple_Nm,
        "torque_Nm": torque_Nm,
        "measured_Nm": measured_Nm,
    }


def _dense_smoother(
    config: strainwave.RippleFilterConfig, run: dict[str, np.ndarray], start: int
) -> np.ndarray:
    """Kalman filter and Rauch-Tung-Striebel smoother, dense, with the ripple filter's model.

    An innovation beyond three scales raises T's variance by what brings it back there. Process noise
    comes after a row.
    """
    orders = np.array([2.0, 4.0])
    noise = config.torque_noise_Nm**2
    walk = config.torque_walk_Nm_per_sqrt_s**2 * INTERVAL_S
    angle = run["angle_rad"]
    size = 1 + 2 * len(orders)
    rows = np.ones((len(angle), size))
    for a, order in enumerate(orders):
        rows[:, 1 + 2 * a] = np.cos(order * angle)
        rows[:, 2 + 2 * a] = np.sin(order * angle)
    step_rad = 120.0 * INTERVAL_S
    share = (step_rad / (2 * np.pi * config.memory_turns)) ** 2
    chords = 2 - 2 * np.cos(orders * step_rad)
    gained = 2 * share * (noise + walk / chords)
    mean = np.zeros(size)
    covariance = np.eye(size) * config.initial_amplitude_Nm**2
    # T's variance is infinite before the first row that is learned from: written as 1e6.
    covariance[0, 0] = 1e6
    scale = 3 * config.torque_noise_Nm
    before, after = [], []
    for k in range(start, len(angle)):
        covariance = covariance.copy()
        covariance[0, 0] += walk * (k > start)
        h = rows[k]
        variance = h @ covariance @ h + noise
        innovation = run["measured_Nm"][k] - h @ mean
        ripple_variance = h[1:] @ covariance[1:, 1:] @ h[1:]
        excess = innovation**2 / (9 * max(scale**2, ripple_variance))
        if k > start:
            change = 0.06 * step_rad * ((abs(innovation) > scale) - 0.3)
            scale *= 1 + change + change**2 / 2
        if k > start and excess > 1:
            covariance[0, 0] += variance * (excess - 1)
            variance *= excess
        before.append((mean, covariance))
        gain = covariance @ h / variance
        mean = mean + gain * innovation
        covariance = covariance - np.outer(gain, gain) * variance
        covariance = (covariance + covariance.T) / 2
        after.append((mean, covariance))
        if k > start:
            variances = np.diag(covariance)[1:].reshape(-1, 2).sum(axis=1)
            given = gained * (1 - variances / (2 * config.initial_amplitude_Nm**2))
            covariance = covariance + np.diag(np.concatenate([[0.0], np.repeat(given, 2)]))
    smoothed = after[-1][0]
    ripple = np.empty(len(angle) - start)
    ripple[-1] = rows[-1, 1:] @ smoothed[1:]
    for k in range(len(after) - 2, -1, -1):
        smoother_gain = np.linalg.solve(before[k + 1][1], after[k][1]).T
        smoothed = after[k][0] + smoother_gain @ (smoothed - before[k + 1][0])
        ripple[k] = rows[start + k, 1:] @ smoothed[1:]
    return ripple


def _config(**changes: float) -> strainwave.RippleFilterConfig:
    return strainwave.RippleFilterConfig(
        **{
            "orders": [2, 4],
            "memory_turns": 6.0,
            "torque_noise_Nm": 0.04,
            "torque_walk_Nm_per_sqrt_s": 1.3,
            "initial_amplitude_Nm": 2.0,
            **changes,
        }
    )


def _smooth(
    config: strainwave.RippleFilterConfig, run: dict[str, np.ndarray], finished: int | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rows = len(run["time_s"])
    return _core.RippleSmoother(config).process(
        run["time_s"],
        run["angle_rad"],
        run["measured_Nm"],
        np.zeros(rows),
        rows if finished is None else finished,
    )


def test_agrees_with_a_dense_rauch_tung_striebel_smoother() -> None:
    run = _recording(3000)
    config = _config()
    torque_Nm, ripple_Nm, status = _smooth(config, run)
    # Learning starts once the speed, smoothed over 50 ms, is above its limit: the second row on.
    moving = np.flatnonzero(status & strainwave.StatusFlag.at_rest.value == 0)
    assert moving[0] <= 3
    assert np.all(np.diff(moving) == 1)
    dense = _dense_smoother(config, run, moving[0])
    assert np.abs(ripple_Nm[moving[0] :] - dense).max() < 1e-7
    assert np.allclose(torque_Nm + ripple_Nm, run["measured_Nm"], atol=1e-12)


def test_halves_the_error_of_the_filter() -> None:
    run = _recording(12_000)
    config = _config()
    filtered = strainwave.RippleFilter(config).process(
        run["time_s"], run["angle_rad"], run["measured_Nm"]
    )
    settled = slice(3000, 9000)
    error_of_filter = np.std((filtered.ripple_Nm - run["ripple_Nm"])[settled])
    error_of_smoother = np.std((_smooth(config, run)[1] - run["ripple_Nm"])[settled])
    assert 0.1 * error_of_filter < error_of_smoother < 0.5 * error_of_filter


def test_looks_no_further_than_some_memories() -> None:
    run = _recording(12_000)
    config = _config()
    whole = _smooth(config, run)[1][:5000]
    ahead = {name: values[:8000] for name, values in run.items()}
    assert np.abs(_smooth(config, ahead, 5000)[1] - whole).max() < 1e-5
    near = {name: values[:5050] for name, values in run.items()}
    assert np.abs(_smooth(config, near, 5000)[1] - whole).max() > 1e-3


def test_a_contact_at_rest_and_a_row_without_torque() -> None:
    run = _recording(6000)
    angle_rad = np.minimum(run["angle_rad"], run["angle_rad"][3000])
    ripple_Nm = 1.0 * np.cos(2 * angle_rad - 0.4)
    contact_Nm = 10.0 * (run["time_s"] > 4.0)
    measured_Nm = ripple_Nm + contact_Nm
    measured_Nm[1000] = np.nan
    torque_Nm, smoothed_Nm, status = _core.RippleSmoother(_config()).process(
        run["time_s"], angle_rad, measured_Nm, np.zeros(6000), 6000
    )
    assert np.isfinite(torque_Nm).all()
    assert status[1000] == strainwave.StatusFlag.torque_not_finite.value
    assert torque_Nm[1000] == torque_Nm[999]
    at_rest = slice(3200, None)
    assert np.abs(smoothed_Nm[at_rest] - ripple_Nm[at_rest]).max() < 2e-3
    assert np.ptp(smoothed_Nm[at_rest]) == pytest.approx(0.0, abs=1e-9)


def test_refuses_more_finished_rows_than_given() -> None:
    run = _recording(10)
    with pytest.raises(InputError, match=r"finished_rows = 11: expected at most the 10 rows"):
        _smooth(_config(), run, 11)
