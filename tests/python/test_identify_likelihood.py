"""Likelihoods of candidates side by side, against one after the other and a general search."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from strainwave import RippleFilterConfig, RippleOrder
from strainwave.identify.likelihood import Innovations, innovations, innovations_of_all
from strainwave.samples import Samples


def _excerpt(rows: int) -> Samples:
    random = np.random.default_rng(31)
    time_s = 1e-3 * np.arange(rows)
    angle_rad = np.cumsum(1e-3 * np.maximum(0.0, 60.0 + 100.0 * np.sin(1.3 * time_s)))
    torque_Nm = 8.0 * np.sin(2.1 * time_s) + 1.5 * np.cos(2 * angle_rad + 0.3)
    torque_Nm += 0.04 * random.standard_normal(rows)
    torque_Nm[rows // 3] = np.nan
    return Samples(time_s, angle_rad, torque_Nm, np.zeros(rows))


@pytest.mark.parametrize("scale", [1e-3, 0.3, 1.0, 40.0])
def test_the_scale_is_the_most_likely_one(scale: float) -> None:
    random = np.random.default_rng(9)
    rows = 5000
    variance_Nm2 = random.uniform(0.5, 2.0, rows)
    innovation_Nm = scale * np.sqrt(variance_Nm2) * random.standard_t(4, rows)
    found = Innovations(np.arange(rows), innovation_Nm, variance_Nm2).likelihoods()
    squares = innovation_Nm**2 / variance_Nm2 / 4.0

    def cost(log_scale: float) -> float:
        return 2.5 * float(np.mean(np.log1p(squares * np.exp(-log_scale)))) + 0.5 * log_scale

    best = minimize_scalar(cost, bounds=(-20.0, 20.0), method="bounded", options={"xatol": 1e-9})
    expected = -best.fun - 0.5 * float(np.mean(np.log(variance_Nm2)))
    assert float(np.mean(found)) == pytest.approx(expected, abs=1e-9)


def test_nothing_but_zeros_has_a_likelihood() -> None:
    rows = 100
    found = Innovations(np.arange(rows), np.zeros(rows), np.ones(rows)).likelihoods()
    # The scale ends at the lower end of its range.
    np.testing.assert_allclose(found, 10.0, atol=1e-4)


def _config(memory_turns: float, further: int) -> RippleFilterConfig:
    return RippleFilterConfig(
        orders=[
            RippleOrder(order, with_load=further > 0, with_speed=further > 1)
            for order in (2, 4, 6, 8)
        ],
        memory_turns=memory_turns,
        torque_noise_Nm=0.04,
    )


@pytest.mark.parametrize("most_further", [1, 2])
def test_side_by_side_is_as_one_after_the_other(most_further: int) -> None:
    # With two further pairs for each order there are more pairs than lanes have room for.
    excerpt = _excerpt(4000)
    configs = [
        _config(memory_turns, further)
        for further in (0, most_further)
        for memory_turns in (3.0, 20.0, 80.0)
    ]
    for config, found in zip(configs, innovations_of_all(excerpt, configs), strict=True):
        alone = innovations(excerpt, config)
        assert 2000 < len(found.rows) < 3500
        np.testing.assert_array_equal(found.rows, alone.rows)
        # Of a noise of 0.04 Nm; terms that have hardly been seen yet make rounding larger.
        np.testing.assert_allclose(found.innovation_Nm, alone.innovation_Nm, rtol=0, atol=1e-6)
        np.testing.assert_allclose(found.variance_Nm2, alone.variance_Nm2, rtol=1e-5)
