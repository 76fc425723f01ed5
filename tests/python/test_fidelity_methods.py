"""What is measured of a method against what theory says of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg, signal

from helpers.fidelity_joints import (
    GEAR,
    PERIOD_S,
    of_method,
    of_sections,
    oscillator,
    ripple,
    signals,
)
from strainwave import InputError
from strainwave.fidelity import (
    PASSES,
    SWALLOWS,
    Assessment,
    Subject,
    assess,
    delay_limit_s,
)
from strainwave.fidelity.contacts import contact_at_rest, contact_in_motion
from strainwave.fidelity.tones import speed_response
from strainwave.methods.interface import Cleaned, Method, nothing
from strainwave.samples import Samples

SPEED_RAD_S = 156.0


class Late:
    """Hands out a share of the torque some samples late."""

    def __init__(self, samples: int = 0, gain: float = 1.0) -> None:
        self._samples = samples
        self._gain = gain

    def process(self, samples: Samples, /) -> Cleaned:
        torque = self._gain * samples.torque_Nm
        late = np.concatenate([np.zeros(self._samples), torque])[: len(torque)]
        return Cleaned(late, samples.torque_Nm - late, np.zeros(len(late), np.uint32))

    def finish(self) -> Cleaned:
        return nothing()


def late(samples: int = 0, gain: float = 1.0) -> Subject:
    def build() -> Method:
        return Late(samples, gain)

    return Subject("late", build, PERIOD_S, 80.0, 0.08, (), (2.0, 4.0))


def test_a_method_that_does_nothing_is_untouched() -> None:
    found = assess(late())
    assert found.verdict == PASSES
    assert found.reasons == ()
    for response in found.responses:
        assert response.gain == pytest.approx(1.0, abs=1e-9)
        assert response.delay_s == pytest.approx(0.0, abs=1e-9)
        assert not response.is_within_notch.any()
        assert list(response.attenuation_dB.values()) == pytest.approx([0.0, 0.0], abs=1e-9)
    assert [each.motor_speed_rad_s for each in found.contacts] == [20.0, 50.0, 156.0, 0.0]
    assert found.step_error_largest == pytest.approx(0.0, abs=1e-9)
    assert found.responses[0].frequency_Hz[0] == 1.0
    assert found.responses[0].frequency_Hz[-1] == pytest.approx(400.0, rel=1e-3)


@pytest.mark.parametrize(
    ("subject", "words"),
    [
        (late(2), "comes 2 ms late (limit there: 1 ms)"),
        (late(0, 0.94), "hands out 94.0% of a torque"),
        (late(0, 1.06), "hands out 106.0% of a torque"),
    ],
)
def test_what_is_late_or_too_small_is_said(subject: Subject, words: str) -> None:
    found = assess(subject)
    assert found.verdict == SWALLOWS
    (reason,) = found.reasons
    assert words in reason


@pytest.mark.parametrize("subject", [late(1), late(0, 0.96), late(0, 1.04)])
def test_within_the_limits_it_passes(subject: Subject) -> None:
    assert assess(replace(subject, sample_period_s=0.9e-3)).verdict == PASSES


def test_low_pass_is_that_of_theory() -> None:
    response = speed_response(of_method("low-pass"), SPEED_RAD_S)
    warped = np.tan(np.pi * response.frequency_Hz * PERIOD_S) / np.tan(np.pi * 30.0 * PERIOD_S)
    gain = 1 / np.sqrt(1 + warped**8)
    seen = gain > 0.02
    assert response.gain[seen] == pytest.approx(gain[seen], rel=5e-3)
    sections = signal.butter(4, 30.0, output="sos", fs=1 / PERIOD_S)
    transfer = signal.sos2tf(sections)
    _, samples = signal.group_delay(transfer, w=response.frequency_Hz[seen], fs=1 / PERIOD_S)
    assert response.delay_s[seen] == pytest.approx(samples * PERIOD_S, rel=5e-3)
    line_Hz = np.array([2.0, 4.0]) * SPEED_RAD_S / (2 * np.pi)
    warped = np.tan(np.pi * line_Hz * PERIOD_S) / np.tan(np.pi * 30.0 * PERIOD_S)
    expected_dB = 10 * np.log10(1 + warped**8)
    found_dB = list(response.attenuation_dB.values())
    assert found_dB[:2] == pytest.approx(expected_dB, abs=0.5)


def test_a_contact_through_the_low_pass_is_its_step_response() -> None:
    sections = signal.butter(4, 30.0, output="sos", fs=1 / PERIOD_S)
    step = signal.sosfilt(sections, np.ones(201))
    for contact in (
        contact_at_rest(of_method("low-pass")),
        contact_in_motion(of_method("low-pass"), 50.0),
    ):
        assert contact.response[contact.time_s >= 0] == pytest.approx(step, abs=1e-6)
        assert contact.error_at_20_ms == pytest.approx(abs(step[20] - 1), abs=1e-6)
        assert contact.largest_error == pytest.approx(1 - step[0], abs=1e-6)


@pytest.mark.parametrize("speed_rad_s", [20.0, 50.0, 156.0])
def test_notch_is_that_of_theory(speed_rad_s: float) -> None:
    response = speed_response(of_method("notch"), speed_rad_s)
    transfer = np.ones(len(response.frequency_Hz), dtype=np.complex128)
    for order in (2, 4):
        centre_Hz = order * speed_rad_s / (2 * np.pi)
        notch = signal.iirnotch(centre_Hz, centre_Hz / 1.0, fs=1 / PERIOD_S)
        transfer *= signal.freqz(*notch, response.frequency_Hz, fs=1 / PERIOD_S)[1]
    outside = ~response.is_within_notch
    # A curve's mean a little below and above a frequency is not the curve: 0.125 Hz either way.
    assert response.gain[outside] == pytest.approx(np.abs(transfer)[outside], abs=4e-3)
    # 0.3 order, and the distance of the tones, to either side.
    line_Hz = np.array([[2.0], [4.0]]) * speed_rad_s / (2 * np.pi)
    away_Hz = np.abs(response.frequency_Hz - line_Hz).min(axis=0)
    half_Hz = 0.3 * speed_rad_s / (2 * np.pi)
    assert np.all(response.is_within_notch[away_Hz < half_Hz])
    assert not np.any(response.is_within_notch[away_Hz > half_Hz + 0.126])


@pytest.mark.parametrize(
    ("method", "orders"), [("taghirad1999-4", [2, 4]), ("taghirad1999", [2, 4, 0.01])]
)
def test_published_tuning_is_that_of_its_riccati_equation(method: str, orders: list[float]) -> None:
    response = speed_response(of_method(method), SPEED_RAD_S)
    turns = [order * SPEED_RAD_S * PERIOD_S for order in orders]
    transition = linalg.block_diag(
        *([[np.cos(t), np.sin(t)], [-np.sin(t), np.cos(t)]] for t in turns)
    )
    output = np.tile([1.0, 0.0], len(orders))[np.newaxis]
    noise = 1e3 * np.eye(2 * len(orders))
    covariance = linalg.solve_discrete_are(transition.T, output.T, noise, np.eye(1))
    gain = transition @ covariance @ output.T / (1 + output @ covariance @ output.T)
    system = signal.StateSpace(transition - gain @ output, gain, -output, [[1.0]], dt=PERIOD_S)

    def theory(frequency_Hz: np.ndarray) -> np.ndarray:
        return np.asarray(signal.dfreqresp(system, 2 * np.pi * frequency_Hz * PERIOD_S)[1])

    judged = response.is_judged
    frequency_Hz = response.frequency_Hz[judged]
    below, above = theory(frequency_Hz - 0.125), theory(frequency_Hz + 0.125)
    mean = 0.5 * (np.abs(below) + np.abs(above))
    assert response.gain[judged] == pytest.approx(mean, rel=1e-3)
    seen = np.minimum(np.abs(below), np.abs(above)) > 0.012
    delay_s = -np.angle(above / below) / (2 * np.pi * 0.25)
    assert response.delay_s[judged][seen] == pytest.approx(delay_s[seen], rel=1e-2, abs=1e-5)


def test_the_ripple_filter_delays_slow_torque_as_its_design_says() -> None:
    # docs/design/ripple-filter.md: about 1 / (pi n w k^2) for each order.
    subject = replace(of_method("ripple"), noise_Nm=1e-4)
    response = speed_response(subject, 20.0)
    expected_s = sum(1 / (np.pi * 10 * 20.0 * order**2) for order in (2, 4, 6))
    assert response.delay_s[0] == pytest.approx(expected_s, rel=0.15)
    assert response.gain[0] == pytest.approx(1.0, abs=1e-3)


def test_the_limit_of_delay_is_that_of_a_notch_and_a_millisecond() -> None:
    subject = of_method("taghirad1999-4")
    response = speed_response(subject, 20.0, is_wide=False)
    a_rad_s = 20.0 / (2 * np.pi * 1.5)
    away_rad_s = 2 * np.pi * response.frequency_Hz - 20.0 * np.array([[2.0], [4.0]])
    expected_s = 1e-3 + (a_rad_s / (a_rad_s**2 + away_rad_s**2)).sum(axis=0)
    assert delay_limit_s(subject, response) == pytest.approx(expected_s, rel=1e-9)
    slow = replace(subject, removed_orders=(0.01,))
    # A line once per output turn is no excuse for delaying everything.
    assert 1e-3 < delay_limit_s(slow, response)[0] < 1.3e-3
    assert np.all(speed_response(slow, SPEED_RAD_S, is_wide=False).is_judged)


def test_what_was_learned_on_the_joint_makes_no_difference() -> None:
    learned = (
        "learned_coefficients_Nm = [3.0, 1.0, -1.0, 0.5]\n"
        "learned_standard_deviations_Nm = [0.01, 0.01, 0.01, 0.01]\n"
    )
    kept = assess(of_sections(GEAR, signals(1000), ripple(10, learned)))
    assert kept.as_dict() == assess(of_sections(GEAR, signals(1000), ripple(10))).as_dict()


def test_kept_orders_count_as_no_notch() -> None:
    subject = of_sections(GEAR, signals(1000), ripple(10, 'kept_orders = ["4m"]\n'))
    assert subject.removed_orders == (2.0,)


def test_lines_that_cannot_be_told_apart_have_no_figure() -> None:
    found = assess(of_sections(GEAR, oscillator(1e-6, '[2, "201/100", "1/R"]')))
    slow, *_, fast = found.responses
    assert slow.attenuation_dB[0.01] is None
    assert slow.attenuation_dB[2.01] is None
    assert fast.attenuation_dB[0.01] is not None
    assert found.as_dict()["speeds"][0]["attenuation"][0] == {"order": 0.01, "attenuation_dB": None}


def test_assumptions_are_said() -> None:
    bare = of_sections(oscillator(1e-6), method="ripple")
    assert bare.sample_period_s == 1e-3
    assert bare.rated_torque_Nm == 100.0
    for words in ("sample period of 1 ms", "rated torque of 100 Nm", "standard orders"):
        assert any(words in each for each in bare.assumptions)
    told = of_sections(GEAR, signals(500), ripple(10))
    assert (told.sample_period_s, told.rated_torque_Nm, told.noise_Nm) == (2e-3, 80.0, 0.08)
    assert told.assumptions == ()
    tuned = of_sections(GEAR, oscillator(1e-6, period_s=4e-3))
    assert tuned.sample_period_s == 4e-3
    assert tuned.assumptions == ()


def test_an_aliased_line_is_where_sampling_shows_it() -> None:
    subject = replace(of_method("taghirad1999-4"), sample_period_s=0.02)
    # Order 2 at 156 rad/s is at 49.66 Hz, that is 0.34 Hz at 50 Hz.
    response = speed_response(replace(late(), sample_period_s=0.02, removed_orders=(2.0,)), 156.0)
    assert response.is_within_notch[response.frequency_Hz < 7.7].all()
    assert not response.is_within_notch[response.frequency_Hz > 7.95].any()
    assert subject.removed_orders == (2.0, 4.0)


@pytest.mark.parametrize(
    ("rate_Hz", "words"), [(2.0, "expected at least 5 Hz"), (1e8, "give a lower sampling_rate_Hz")]
)
def test_a_rate_that_tells_nothing_is_refused(rate_Hz: float, words: str) -> None:
    with pytest.raises(InputError, match=words):
        assess(of_sections(GEAR, signals(rate_Hz), ripple(10)))


def test_a_method_that_gives_nonsense_is_refused() -> None:
    with pytest.raises(InputError, match="method late gave 0 finite torques"):
        assess(late(0, np.nan))


def worst_is_of_its_curve(found: Assessment) -> None:
    values = found.as_dict()
    errors, delays = [], []
    for speed in values["speeds"]:
        for n, frequency_Hz in enumerate(speed["frequency_Hz"]):
            if 1.0 <= frequency_Hz <= 20.0 and not speed["is_within_notch"][n]:
                errors.append(abs(speed["gain"][n] - 1))
                delays.append(abs(speed["delay_s"][n] or 0.0))
    assert values["gain_error_worst"] == max(errors)
    assert values["delay_s_worst"] == max(delays)


@pytest.mark.parametrize("method", ["ripple", "taghirad1999-4"])
def test_worst_figures_are_of_the_judged_frequencies(method: str) -> None:
    worst_is_of_its_curve(assess(of_method(method)))
