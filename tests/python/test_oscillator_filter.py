"""The published ripple filter against filterpy's textbook form, and what it must do on its own."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from hypothesis import given
from hypothesis import strategies as st

import strainwave
from strainwave import (
    ConfigurationError,
    InputError,
    OscillatorFilter,
    OscillatorFilterConfig,
    RotationSource,
    StatusFlag,
    oscillator_preset,
)

Ts = 1e-3
MOTIONS = {
    "reversals": lambda t: 150.0 * np.sin(2.0 * t),
    "ramp with a stop": lambda t: np.clip(60.0 * (t - 1.5), 0.0, 90.0),
    "crawl": lambda t: 0.05 + 0.0 * t,
}
ORDER_LISTS = {
    "4 states": [2, 4],
    "6 states": [2, 4, Fraction(1, 100)],
    "odd": [1, 2, 7, Fraction(2, 241)],
    "12 states": [2, 4, 6, 8, Fraction(102, 25), Fraction(1, 161)],
}


def recording(motion, samples, seed=3):
    """Speed, torque and expected torque of a run that has every kind of torque in it."""
    rng = np.random.default_rng(seed)
    t = np.arange(samples) * Ts
    speed = MOTIONS[motion](t)
    angle = np.concatenate([[0.0], np.cumsum(speed[:-1] * Ts)])
    torque = (
        1.6 * np.sin(2 * angle + 0.4)
        + 0.6 * np.cos(4 * angle)
        + 5.0 * np.sin(angle / 100)
        + 10.0 * (t > 1.0)
        + 0.04 * rng.standard_normal(samples)
    )
    return speed, torque, 3.0 * np.gradient(speed, Ts) / 100


def dense_run(orders, q, r, p0, speed, y):
    """Eq. (9) to (14) by filterpy: update with y(k), then predict with Phi(k)."""
    n = 2 * len(orders)
    kf = KalmanFilter(dim_x=n, dim_z=1)
    kf.x = np.zeros((n, 1))
    kf.P = p0 * np.eye(n)
    kf.Q = np.diag(np.repeat(np.broadcast_to(q, len(orders)), 2))
    kf.R = np.array([[r]])
    kf.H = np.tile([1.0, 0.0], len(orders))[None, :]
    ripple = np.empty(len(y))
    for k, (omega, value) in enumerate(zip(speed, y, strict=True)):
        ripple[k] = (kf.H @ kf.x).item()
        kf.update(value)
        phi = np.zeros((n, n))
        for i, order in enumerate(orders):
            c, s = np.cos(float(order) * omega * Ts), np.sin(float(order) * omega * Ts)
            phi[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [[c, s], [-s, c]]
        kf.predict(F=phi)
    return ripple, kf.x[:, 0].copy(), kf.P.copy()


def unprotected(orders, q=1e3, r=1.0, p0=1e3):
    return OscillatorFilterConfig(
        orders=orders,
        process_noise_variance_Nm2=q,
        measurement_noise_variance_Nm2=r,
        initial_variance_Nm2=p0,
        minimum_travel_rad=0.0,
        minimum_speed_rad_s=0.0,
        variance_limit_ratio=0,
    )


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("orders", ORDER_LISTS.values(), ids=ORDER_LISTS)
def test_double_is_the_textbook_form_to_1e_12(motion, orders):
    speed, torque, expected = recording(motion, 4000)
    dense, x, P = dense_run(orders, 1e3, 1.0, 1e3, speed, torque - expected)
    ours = OscillatorFilter(unprotected(orders))
    result = ours.process(torque, motor_speed_rad_s=speed, expected_torque_Nm=expected)
    scale = np.abs(dense).max()
    assert np.abs(result.ripple_Nm - dense).max() < 1e-12 * scale
    np.testing.assert_array_equal(result.torque_Nm, torque - result.ripple_Nm)
    states, covariance = ours.predicted_state()
    # Where hardly anything turns, P is known to its largest element alone.
    assert np.abs(states - x).max() < 1e-11 * max(scale, np.abs(x).max())
    assert np.abs(covariance - P).max() < 1e-9 * np.abs(P).max()
    np.testing.assert_array_equal(covariance, covariance.T)


@pytest.mark.parametrize("motion", ["reversals", "ramp with a stop"])
@pytest.mark.parametrize("orders", ORDER_LISTS.values(), ids=ORDER_LISTS)
def test_float_is_the_textbook_form_to_1e_5(motion, orders):
    speed, torque, expected = (a.astype(np.float32) for a in recording(motion, 4000))
    wide = [a.astype(np.float64) for a in (speed, torque, expected)]
    dense, _, _ = dense_run(orders, 1e3, 1.0, 1e3, wide[0], wide[1] - wide[2])
    result = OscillatorFilter(unprotected(orders), dtype=np.float32).process(
        torque, motor_speed_rad_s=speed, expected_torque_Nm=expected
    )
    assert result.ripple_Nm.dtype == np.float32
    worst = np.abs(result.ripple_Nm - dense).max() / np.abs(dense).max()
    assert 1e-9 < worst < 1e-5


def test_an_order_has_its_own_process_noise():
    speed, torque, _ = recording("reversals", 3000)
    orders, q = [2, 4, 7], [1e-4, 1e-2, 1e-6]
    dense, _, P = dense_run(orders, q, 0.3, 2.0, speed, torque)
    ours = OscillatorFilter(unprotected(orders, q, 0.3, 2.0))
    assert np.abs(ours.process(torque, motor_speed_rad_s=speed).ripple_Nm - dense).max() < 1e-11
    assert np.abs(ours.predicted_state()[1] - P).max() < 1e-12 * np.abs(P).max()


def test_presets_are_the_paper():
    six = oscillator_preset("taghirad1999", ratio=120.5)
    assert [Fraction(o.numerator, o.denominator) for o in six.orders] == [2, 4, Fraction(2, 241)]
    four = oscillator_preset("taghirad1999-4")
    assert [float(o) for o in four.orders] == [2, 4]
    for config in (six, four):
        assert config.process_noise_variance_Nm2 == [1e3] * len(config.orders)
        assert config.measurement_noise_variance_Nm2 == 1
        assert config.initial_variance_Nm2 == 1e3
        assert config.sample_period_s == 1e-3
        assert config.rotation_source == RotationSource.speed
        assert config.minimum_travel_rad == config.variance_limit_ratio == 0
    x, P = OscillatorFilter(six).predicted_state()
    np.testing.assert_array_equal(x, np.zeros(6))
    np.testing.assert_array_equal(P, 1e3 * np.eye(6))


def test_preset_deletes_torque_that_was_not_expected():
    """The paper's tuning shows 10 Nm of contact as next to nothing after 20 ms."""
    samples = 3000
    speed = np.full(samples, 50.0)
    torque = np.where(np.arange(samples) >= 2000, 10.0, 0.0)
    out = OscillatorFilter(oscillator_preset("taghirad1999-4")).process(
        torque, motor_speed_rad_s=speed
    )
    assert abs(out.torque_Nm[2020]) < 1.0
    assert out.torque_Nm[2000] == pytest.approx(10.0, abs=1e-6)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_capacity_does_not_change_a_bit(dtype):
    speed, torque, _ = (a.astype(dtype) for a in recording("reversals", 3000))
    config = OscillatorFilterConfig(orders=[2, 4, Fraction(1, 100)])
    results = []
    for least, capacity in ((1, 3), (4, 8), (9, 32)):
        ours = OscillatorFilter(config, dtype=dtype, least_capacity=least)
        assert ours.capacity == capacity
        results.append(ours.process(torque, motor_speed_rad_s=speed).ripple_Nm)
    for other in results[1:]:
        np.testing.assert_array_equal(other, results[0])


@pytest.mark.parametrize("source", [RotationSource.speed, RotationSource.angle])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_chunks_equal_one_call_to_the_last_bit(source, dtype):
    speed, torque, expected = (a.astype(dtype) for a in recording("ramp with a stop", 3000))
    angle = np.cumsum(speed.astype(np.float64)) * Ts
    torque[[100, 999, 1000, 2500]] = np.nan
    arrays = {"motor_speed_rad_s": speed, "motor_angle_rad": angle, "expected_torque_Nm": expected}
    config = OscillatorFilterConfig(orders=[2, 4], rotation_source=source)
    whole = OscillatorFilter(config, dtype=dtype)
    one = whole.process(torque, **arrays)
    pieces = OscillatorFilter(config, dtype=dtype)
    parts = [
        pieces.process(torque[a:b], **{name: array[a:b] for name, array in arrays.items()})
        for a, b in itertools.pairwise([0, 1, 1, 17, 1000, 1001, 2999, 3000])
    ]
    for name in ("torque_Nm", "ripple_Nm", "status"):
        joined = np.concatenate([getattr(part, name) for part in parts])
        assert joined.tobytes() == getattr(one, name).tobytes()
    assert pieces.counters == whole.counters


def test_angle_and_speed_sources_agree():
    t = np.arange(5001) * Ts
    angle = 500.0 + 30.0 * np.cos(3.0 * t)
    speed = np.diff(angle) / Ts  # speed[k] carries sample k to k + 1
    torque = 3.0 * np.sin(2 * angle) + np.cos(4 * angle)
    result = {}
    for source in (RotationSource.speed, RotationSource.angle):
        config = OscillatorFilterConfig(
            orders=[2, 4, Fraction(1, 100)], rotation_source=source, minimum_travel_rad=0
        )
        result[source] = OscillatorFilter(config).process(
            torque[:-1], motor_speed_rad_s=speed, motor_angle_rad=angle[:-1]
        )
    difference = result[RotationSource.speed].ripple_Nm - result[RotationSource.angle].ripple_Nm
    # A phase is rounded to 1.5e-9 rad; a speed that is one sample late would show 0.1 Nm.
    assert np.abs(difference).max() < 1e-5


@given(
    st.lists(
        st.tuples(
            st.integers(0, 1999),
            st.sampled_from(["torque_Nm", "motor_speed_rad_s", "expected_torque_Nm"]),
            st.sampled_from([np.nan, np.inf, -np.inf, 1e30, -1e30, 5e-324, 1e-40]),
        ),
        min_size=1,
        max_size=40,
    ),
    st.sampled_from([np.float32, np.float64]),
)
def test_wild_numbers_are_survived(faults, dtype):
    n = 8000
    speed = np.full(n, 150.0)
    torque = 2.0 * np.cos(2 * 150.0 * Ts * np.arange(n))
    arrays = {
        "torque_Nm": torque.astype(dtype),
        "motor_speed_rad_s": speed.astype(dtype),
        "expected_torque_Nm": np.zeros(n, dtype),
    }
    config = OscillatorFilterConfig(orders=[2, 4], process_noise_variance_Nm2=1e-4)
    clean = OscillatorFilter(config, dtype=dtype).process(**arrays)
    with np.errstate(over="ignore"):
        for at, name, value in faults:
            arrays[name][at] = value
    ours = OscillatorFilter(config, dtype=dtype)
    result = ours.process(**arrays)
    assert np.isfinite(result.torque_Nm).all()
    assert np.isfinite(result.ripple_Nm).all()
    # Everything beyond 1e15 is refused; 4000 samples later nothing is left of it.
    assert np.abs(result.ripple_Nm[6000:] - clean.ripple_Nm[6000:]).max() < 2e-3
    flagged = (result.status & 0xFFF) != 0
    beyond = {at for at, _, value in faults if not abs(value) < 1e15}
    overwritten = {at for at, _, value in faults if abs(value) < 1e15}
    assert set(np.flatnonzero(flagged)) <= beyond
    assert beyond - overwritten <= set(np.flatnonzero(flagged))
    assert ours.counters["faults"] == flagged.sum()
    assert ours.counters["samples"] == n


def test_rejected_samples_hold_the_torque_and_are_named():
    speed, torque, _ = recording("reversals", 2000)
    torque[500:503] = [np.nan, np.inf, -np.inf]
    ours = OscillatorFilter(OscillatorFilterConfig(orders=[2, 4]))
    result = ours.process(torque, motor_speed_rad_s=speed)
    assert (result.status[500:503] & StatusFlag.torque_not_finite.value).all()
    np.testing.assert_array_equal(result.torque_Nm[500:503], result.torque_Nm[499])
    assert ours.counters["torque_not_finite"] == 3


def test_static_load_is_not_learned_while_the_encoder_dithers():
    """An encoder between two counts is at rest, however long it dithers."""
    n = 60_000
    rng = np.random.default_rng(1)
    angle = 2 * np.pi / 4096 * rng.integers(0, 2, n)
    config = OscillatorFilterConfig(orders=[2, 4], rotation_source=RotationSource.angle)
    result = OscillatorFilter(config).process(np.full(n, 10.0), motor_angle_rad=angle)
    assert result.torque_Nm[-1] == pytest.approx(10.0, abs=1.0)


def test_static_load_is_not_learned_from_a_tachometers_noise():
    """0.2 rad/s rms of noise travels 1 mrad in 25 samples, and goes nowhere."""
    n = 600_000
    speed = np.random.default_rng(2).normal(0.0, 0.2, n)
    config = OscillatorFilterConfig(orders=[2, 4])
    result = OscillatorFilter(config).process(np.full(n, 10.0), motor_speed_rad_s=speed)
    assert result.torque_Nm[-1] == pytest.approx(10.0, abs=1e-9)


def test_largest_variance_of_the_published_filter_at_full_speed():
    """About a thousand times the process noise: far below the default's limit of 1e5."""
    published = OscillatorFilter(oscillator_preset("taghirad1999", 100))
    published.process(np.zeros(20_000), motor_speed_rad_s=np.full(20_000, 156.0))
    _, covariance = published.predicted_state()
    assert 300 < np.linalg.eigvalsh(covariance).max() / 1e3 < 3000
    assert OscillatorFilterConfig(orders=[2]).variance_limit_ratio == 1e5


def test_copy_and_reset():
    speed, torque, _ = recording("reversals", 1000)
    ours = OscillatorFilter(OscillatorFilterConfig(orders=[2, 4]))
    first = ours.process(torque, motor_speed_rad_s=speed)
    twin = ours.copy()
    again = ours.process(torque, motor_speed_rad_s=speed)
    twin_again = twin.process(torque, motor_speed_rad_s=speed)
    np.testing.assert_array_equal(again.ripple_Nm, twin_again.ripple_Nm)
    ours.reset()
    np.testing.assert_array_equal(
        ours.process(torque, motor_speed_rad_s=speed).ripple_Nm, first.ripple_Nm
    )
    assert ours.counters["samples"] == 1000


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"measurement_noise_variance_Nm2": -1.0}, "measurement_noise_variance_Nm2 = -1.0 Nm^2"),
        ({"measurement_noise_variance_Nm2": 0.0}, "measurement_noise_variance_Nm2 = 0.0"),
        ({"process_noise_variance_Nm2": float("nan")}, "process_noise_variance_Nm2[0] = nan"),
        ({"process_noise_variance_Nm2": [1.0, -1.0]}, "process_noise_variance_Nm2[1] = -1.0"),
        ({"process_noise_variance_Nm2": [1.0]}, "process_noise_variance_Nm2 has 1 elements"),
        ({"initial_variance_Nm2": float("inf")}, "initial_variance_Nm2 = inf"),
        ({"sample_period_s": 0.0}, "sample_period_s = 0.0 s"),
        ({"minimum_travel_rad": 2.0}, "minimum_travel_rad = 2.0 rad"),
        ({"variance_limit_ratio": 5.0}, "variance_limit_ratio = 5.0"),
        ({"orders": []}, "orders has 0 elements"),
        ({"orders": list(range(1, 34))}, "orders has 33 elements"),
        ({"orders": [2, 0]}, "orders = 0"),
        ({"orders": [2, -1]}, "orders = -1"),
        ({"orders": [2, float("nan")]}, "orders = nan"),
        ({"orders": [2, 2]}, "orders[1] = 2.0"),
    ],
)
def test_wrong_configuration_gives_one_clear_sentence(change, words):
    arguments = {"orders": [2, 4]} | change
    with pytest.raises(InputError) as caught:
        OscillatorFilterConfig(**arguments)
    message = str(caught.value)
    assert message.startswith(words)
    assert "expected" in message
    assert "\n" not in message


def test_unknown_preset_and_impossible_ratio():
    with pytest.raises(InputError, match=r"preset = 'taghirad' is unknown: expected one of"):
        oscillator_preset("taghirad")
    for ratio in (0, -100, float("nan"), float("inf")):
        with pytest.raises(ConfigurationError, match="ratio = "):
            oscillator_preset("taghirad1999", ratio=ratio)


@pytest.mark.parametrize("ratio", [0.5, 0.25])
def test_preset_refuses_a_ratio_whose_order_is_there_already(ratio):
    with pytest.raises(ConfigurationError):
        oscillator_preset("taghirad1999", ratio=ratio)


@pytest.mark.parametrize(
    "change",
    [
        {"measurement_noise_variance_Nm2": 1e-50},
        {"initial_variance_Nm2": 1e-50},
        {"sample_period_s": 1e-50},
        {"process_noise_variance_Nm2": 1e39},
    ],
)
def test_what_float_cannot_hold_is_refused_for_float(change):
    arguments = {"orders": [2, 4]} | change
    with pytest.raises(ConfigurationError):
        OscillatorFilter(OscillatorFilterConfig(**arguments), dtype=np.float32)


def test_missing_and_unequal_arrays():
    ours = OscillatorFilter(OscillatorFilterConfig(orders=[2]))
    with pytest.raises(InputError, match="motor_speed_rad_s is missing"):
        ours.process(np.zeros(3))
    with pytest.raises(InputError, match="motor_speed_rad_s has 2 elements: expected 3"):
        ours.process(np.zeros(3), motor_speed_rad_s=np.zeros(2))
    with pytest.raises(InputError, match="expected_torque_Nm has 4 elements: expected 3"):
        ours.process(np.zeros(3), motor_speed_rad_s=np.zeros(3), expected_torque_Nm=np.zeros(4))
    assert ours.counters["samples"] == 0
    assert strainwave.OscillatorFilter is OscillatorFilter
