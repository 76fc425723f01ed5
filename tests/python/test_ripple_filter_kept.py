"""The ripple filter: capacities, kept and frozen terms, what was learned, configuration."""

from fractions import Fraction

import numpy as np
import pytest

from helpers.ripple_runs import (
    STRUCTURES,
    NOISE_Nm,
    angle_of,
    busy_day,
    configured,
    counts,
    driving,
    flattened,
)
from strainwave import (
    ConfigurationError,
    FrozenTerm,
    InputError,
    LearnedRipple,
    RippleFilter,
    RippleFilterConfig,
    RippleOrder,
)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("orders", [[2, 4], [RippleOrder(2, with_load=True, with_speed=True)]])
def test_capacity_does_not_change_a_bit(orders, dtype):
    time, angle, torque, expected = busy_day()
    results = []
    for least, capacity in ((1, 3), (4, 8), (9, 32)):
        ours = RippleFilter(
            configured(orders=orders, frozen=[FrozenTerm(1, cosine_Nm=1, sine_Nm=2)]),
            dtype=dtype,
            least_capacity=least,
        )
        assert ours.capacity == capacity
        results.append(
            ours.process(
                time, angle, torque.astype(dtype), expected_torque_Nm=expected.astype(dtype)
            )
        )
    for other in results[1:]:
        for name in vars(other):
            assert getattr(other, name).tobytes() == getattr(results[0], name).tobytes()


def test_a_kept_order_is_learned_and_left_in():
    time, angle, torque, _ = busy_day()
    removing = RippleFilter(configured(orders=[2, 4]))
    keeping = RippleFilter(configured(orders=[RippleOrder(2, keep=True), 4]))
    both = [f.process(time, angle, torque) for f in (removing, keeping)]
    assert np.abs(removing.state()[0] - keeping.state()[0]).max() < 1e-11
    assert np.abs(both[0].innovation_Nm - both[1].innovation_Nm).max() < 1e-11
    assert np.abs(both[0].torque_all_removed_Nm - both[1].torque_all_removed_Nm).max() < 1e-11
    np.testing.assert_array_equal(both[0].torque_Nm, both[0].torque_all_removed_Nm)
    stays = both[1].torque_Nm - both[1].torque_all_removed_Nm
    amplitude = np.sqrt(2 * np.mean(stays[1000:1500] ** 2))
    assert amplitude == pytest.approx(1.6, abs=0.4)


def test_frozen_terms_are_their_formula_and_wait_for_a_reference():
    time, angle, true, _ = driving(3000)
    terms = [
        FrozenTerm(Fraction(1, 100), cosine_Nm=2.0, sine_Nm=-1.0),
        FrozenTerm(3, cosine_Nm=0, sine_Nm=0.5),
    ]
    formula = 2 * np.cos(angle / 100) - np.sin(angle / 100) + 0.5 * np.sin(3 * angle)
    plain = RippleFilter(configured(orders=[2])).process(time, angle, true)
    frozen = RippleFilter(configured(orders=[2], frozen=terms))
    result = frozen.process(time, angle, true + formula)
    assert np.abs(result.ripple_Nm - plain.ripple_Nm - formula).max() < 1e-7
    assert np.abs(result.torque_Nm - plain.torque_Nm).max() < 1e-7
    waiting = RippleFilter(configured(orders=[2], frozen=terms))
    result = waiting.process(time, angle, true, angle_referenced=False)
    np.testing.assert_array_equal(result.ripple_Nm, plain.ripple_Nm)


def test_power_up_with_kept_coefficients_is_clean():
    time, angle, true, ripple = driving(20000)
    config = configured(orders=[2, 4])
    before = RippleFilter(config)
    before.process(time, angle, true + ripple)
    kept = before.learned()
    rng = np.random.default_rng(3)
    for at in (0.3, 1.0, 2.2):
        here = 1.6 * np.cos(2 * at + 0.3) + 0.6 * np.sin(4 * at)
        y = here + NOISE_Nm * rng.standard_normal(500)
        standing = (np.arange(500) * 1e-3, np.full(500, at), y)
        restored = RippleFilter(config, learned=kept).process(*standing)
        assert np.abs(restored.ripple_Nm - here).max() < 0.01 * 2.2
        fresh = RippleFilter(config).process(*standing)
        assert np.abs(fresh.ripple_Nm).max() == 0.0


def test_learned_round_trip():
    time, angle, torque, _ = busy_day()
    config = configured(orders=STRUCTURES["load and speed"])
    ours = RippleFilter(config)
    ours.process(time, angle, torque)
    kept = ours.learned()
    states, covariance = ours.state()
    np.testing.assert_array_equal(kept.coefficients_Nm, states[1:])
    np.testing.assert_allclose(
        kept.standard_deviations_Nm, np.sqrt(np.diag(covariance))[1:], rtol=1e-15
    )
    assert kept.orders == config.orders
    again = LearnedRipple(
        orders=kept.orders,
        coefficients_Nm=kept.coefficients_Nm,
        standard_deviations_Nm=kept.standard_deviations_Nm,
        innovation_scale_Nm=kept.innovation_scale_Nm,
    )
    twin = RippleFilter(config, learned=again)
    other = twin.learned()
    np.testing.assert_array_equal(other.coefficients_Nm, kept.coefficients_Nm)
    np.testing.assert_allclose(
        other.standard_deviations_Nm, kept.standard_deviations_Nm, rtol=1e-14
    )
    assert other.innovation_scale_Nm == kept.innovation_scale_Nm
    twin.process(time, angle, torque)
    twin.reset()
    np.testing.assert_array_equal(twin.learned().coefficients_Nm, kept.coefficients_Nm)


def test_coefficients_of_other_orders_are_refused():
    kept = RippleFilter(configured(orders=[2, 4])).learned()
    for orders in ([2], [4, 2], [2, 4, 6], [2, RippleOrder(4, with_load=True)], [2, 5]):
        with pytest.raises(ConfigurationError, match=r"learned\.orders"):
            RippleFilter(configured(orders=orders), learned=kept)
    for bad in ([np.nan, 0, 0, 0], [np.inf, 0, 0, 0], [0, 2e9, 0, 0]):
        with pytest.raises(ConfigurationError, match=r"learned\.coefficients_Nm"):
            RippleFilter(
                configured(orders=[2, 4]),
                learned=LearnedRipple(
                    orders=[2, 4], coefficients_Nm=bad, standard_deviations_Nm=[1] * 4
                ),
            )
    with pytest.raises(ConfigurationError, match=r"learned\.standard_deviations_Nm"):
        RippleFilter(
            configured(orders=[2, 4]),
            learned=LearnedRipple(
                orders=[2, 4], coefficients_Nm=[1] * 4, standard_deviations_Nm=[1, 1, -1, 1]
            ),
        )
    with pytest.raises(InputError, match="coefficients_Nm"):
        LearnedRipple(orders=[2, 4], coefficients_Nm=[1] * 3, standard_deviations_Nm=[1] * 4)
    # A kept order is learned like any other.
    RippleFilter(configured(orders=[2, RippleOrder(4, keep=True)]), learned=kept)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_amplitude_and_phase_are_the_true_ones(dtype):
    time, angle, true, _ = driving(20000)
    for phase in (-3.0, -1.2, 0.0, 0.4, 2.5):
        y = true + 1.6 * np.cos(2 * angle - phase) + 0.6 * np.cos(4 * angle + phase)
        ours = RippleFilter(configured(orders=[2, 4]), dtype=dtype)
        ours.process(time, angle, y.astype(dtype))
        amplitude, measured = ours.order_ripple()
        np.testing.assert_allclose(amplitude, [1.6, 0.6], atol=0.02)
        np.testing.assert_allclose(measured, [phase, -phase], atol=0.03)


def test_amplitude_is_that_of_the_present_load():
    time = np.arange(30000) * 1e-3
    angle = counts(120 * time)
    load = 20 * np.sin(0.5 * time)
    load[25000:] = 15.0
    y = load + (1.6 + 0.8 * flattened(load)) * np.cos(2 * angle)
    ours = RippleFilter(configured(orders=[RippleOrder(2, with_load=True)]))
    ours.process(time, angle, y)
    assert ours.order_ripple()[0][0] == pytest.approx(1.6 + 0.8 * flattened(15.0), abs=0.02)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_steady_load_neither_resets_nor_drifts(dtype):
    """A load pair at constant load is not seen: its variance is limited, its sum with c stays."""
    rng = np.random.default_rng(7)
    samples = 1_000_000
    time = np.arange(samples) * 1e-3
    angle = counts(156 * time)
    ripple = 1.6 * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)
    y = (12.0 + ripple + NOISE_Nm * rng.standard_normal(samples)).astype(dtype)
    orders = [RippleOrder(k, with_load=True, with_speed=True) for k in (2, 4)]
    ours = RippleFilter(configured(orders=orders), dtype=dtype)
    result = ours.process(time, angle, y)
    assert ours.counters["covariance_reset"] == 0
    error = result.ripple_Nm - ripple
    early, late = (
        np.sqrt(np.mean(error[a:b] ** 2))
        for a, b in ((1e5, 2e5), (9e5, 1e6))
        for a, b in [(int(a), int(b))]
    )
    assert late == pytest.approx(early, rel=0.25)
    assert abs(error[900000:].mean()) < 1e-3
    states, covariance = ours.state()
    assert np.abs(states[1:]).max() < 10
    assert np.linalg.eigvalsh(covariance)[0] > 0
    assert (np.diag(covariance)[1:] <= 4.0 * (1 + 1e-6)).all()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_covariance_stays_positive_definite_through_stops_and_starts(dtype):
    rng = np.random.default_rng(17)
    samples = 200_000
    time = np.arange(samples) * 1e-3
    speed = 150 * np.sign(np.sin(0.3 * time)) * (np.sin(1.1 * time) > 0)
    angle = angle_of(speed, time)
    y = 5 * np.sin(0.2 * time) + np.cos(2 * angle) + NOISE_Nm * rng.standard_normal(samples)
    orders = [RippleOrder(k, with_load=True, with_speed=True, with_direction=True) for k in (2, 4)]
    ours = RippleFilter(configured(orders=orders, memory_turns=5), dtype=dtype)
    for begin in range(0, samples, 1000):
        cut = slice(begin, begin + 1000)
        ours.process(time[cut], angle[cut], y[cut].astype(dtype))
        np.linalg.cholesky(ours.state()[1])
    assert ours.counters["covariance_reset"] == 0


@pytest.mark.parametrize(
    ("name", "bad", "good"),
    [
        ("memory_turns", [0.09, 1.1e6], [0.1, 1e6]),
        ("torque_noise_Nm", [0, -1, 1.1e9], [1e-8, 1e9]),
        ("torque_walk_Nm_per_sqrt_s", [0, 1.1e9], [1e-8, 1e9]),
        ("initial_amplitude_Nm", [0, 1.1e9], [1e-8, 1e9]),
        ("rated_torque_Nm", [0, -40, 1.1e9], [1e-8, 1e9]),
        ("reference_speed_rad_s", [0, 1.1e6], [1, 1e6]),
        ("angle_to_torque_delay_s", [-0.0051, 0.051], [-0.005, 0.05]),
        ("minimum_speed_rad_s", [-0.1, 101], [0, 100]),
    ],
)
def test_every_parameter_has_its_range(name, bad, good):
    for value in [*bad, np.nan, np.inf, -np.inf]:
        with pytest.raises(ConfigurationError, match=rf"^{name} = .*: expected a number from"):
            RippleFilterConfig(orders=[2], **{name: value})
    for value in good:
        config = RippleFilterConfig(orders=[2], **{name: value})
        assert getattr(config, name) == pytest.approx(value, rel=1e-6)
        for dtype in (np.float64, np.float32):
            RippleFilter(config, dtype=dtype)


def test_orders_and_frozen_terms_are_checked():
    for orders, message in (
        ([], "orders"),
        ([2, 2], "each order once"),
        ([2, Fraction(4, 2)], "each order once"),
        ([1001], "at most 1000"),
        (list(range(1, 34)), "orders"),
        ([RippleOrder(k, with_load=True) for k in range(1, 18)], "orders"),
    ):
        with pytest.raises((ConfigurationError, InputError), match=message):
            RippleFilterConfig(orders=orders)
    for order in (0, -2, np.nan, "two"):
        with pytest.raises(InputError, match="order"):
            RippleOrder(order)
    with pytest.raises((ConfigurationError, InputError), match="frozen"):
        RippleFilterConfig(orders=[2], frozen=[FrozenTerm(1, cosine_Nm=1, sine_Nm=0)] * 9)
    with pytest.raises((ConfigurationError, InputError), match="frozen"):
        RippleFilterConfig(orders=[2], frozen=[3])
    for bad in (np.nan, np.inf, 2e9):
        with pytest.raises(ConfigurationError, match=r"frozen\[0\] = .* Nm"):
            RippleFilterConfig(orders=[2], frozen=[FrozenTerm(1, cosine_Nm=bad, sine_Nm=0)])
    assert len(RippleFilterConfig(orders=list(range(1, 33))).orders) == 32


def test_configuration_says_what_it_is():
    config = RippleFilterConfig(
        orders=[2, RippleOrder(Fraction(7, 2), with_load=True, keep=True)],
        frozen=[FrozenTerm(Fraction(1, 100), cosine_Nm=0.5, sine_Nm=-0.25)],
    )
    assert "memory_turns=10" in repr(config)
    assert [float(o.order) for o in config.orders] == [2, 3.5]
    assert [o.keep for o in config.orders] == [False, True]
    assert config.frozen[0].sine_Nm == -0.25


def test_wrong_arguments_are_named():
    config = RippleFilterConfig(orders=[2])
    with pytest.raises(InputError, match="RippleFilterConfig"):
        RippleFilter({"orders": [2]})
    with pytest.raises(InputError, match="LearnedRipple"):
        RippleFilter(config, learned=[1, 2])
    with pytest.raises(InputError, match="least_capacity"):
        RippleFilter(config, least_capacity=33)
    ours = RippleFilter(config)
    good = np.zeros(5)
    for arrays, name in (
        ((np.zeros(4), good, good), "time_s"),
        ((good, np.zeros(4), good), "motor_angle_rad"),
        ((good, good, np.zeros((5, 1))), "torque_Nm"),
    ):
        with pytest.raises(InputError, match=name):
            ours.process(*arrays)
    with pytest.raises(InputError, match="expected_torque_Nm"):
        ours.process(good, good, good, expected_torque_Nm=np.zeros(4))


def test_a_copy_goes_its_own_way():
    time, angle, torque, _ = busy_day()
    ours = RippleFilter(RippleFilterConfig(orders=[2, 4]))
    ours.process(time[:3000], angle[:3000], torque[:3000])
    twin = ours.copy()
    before = ours.state()[0].copy()
    there = twin.process(time[3000:], angle[3000:], torque[3000:])
    np.testing.assert_array_equal(ours.state()[0], before)
    here = ours.process(time[3000:], angle[3000:], torque[3000:])
    assert here.ripple_Nm.tobytes() == there.ripple_Nm.tobytes()
