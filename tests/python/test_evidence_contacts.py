"""Contacts added to a recording: what comes through, against theory."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from helpers.log_files import write_parquet
from strainwave.evidence import Contact, Evidence, filter_with_evidence
from strainwave.evidence.contacts import held_with_the_rows
from strainwave.records import Options, parse_mapping
from strainwave.report.recording_words import fidelity_beside, share_text
from strainwave.samples import Samples

RATED_NM = 100.0
RATE_HZ = 1000.0


def joint_log(folder: Path, *, moves: bool = True) -> Path:
    """A simulated joint: 4 s at rest, 26 s of motion, ripple of orders 2 and 4, noise, a load."""
    t_s = np.arange(30_000) / RATE_HZ
    speed = 60.0 * np.clip((t_s - 4.0) / 0.5, 0.0, 1.0) * (1.0 if moves else 0.0)
    q_rad = np.cumsum(speed) / RATE_HZ
    noise_Nm = 0.05 * np.random.default_rng(3).standard_normal(len(t_s))
    tau_Nm = 2.0 * np.cos(2 * q_rad) + np.cos(4 * q_rad) + 10 * np.sin(t_s) + noise_Nm
    return write_parquet(folder / "log.parquet", {"t_s": t_s, "q_rad": q_rad, "tau_Nm": tau_Nm})


def evidence_of(log: Path, method: str) -> Evidence:
    mapping = parse_mapping(["time=t_s,angle=q_rad,torque=tau_Nm"])
    options = Options(mapping, "motor", rated_torque_Nm=RATED_NM)
    return filter_with_evidence(log, None, options, method=method)[1]


def by_name(evidence: Evidence, name: str) -> list[Contact]:
    return [each for each in evidence.contacts if each.name == name]


def test_low_pass_has_the_error_of_its_theory(tmp_path: Path) -> None:
    evidence = evidence_of(joint_log(tmp_path), "low-pass")
    sections = butter(4, 30.0, output="sos", fs=RATE_HZ)
    response = sosfilt(sections, np.ones(400))
    steps = [*by_name(evidence, "step in motion"), *by_name(evidence, "step at rest")]
    assert len(steps) == 4
    for step in steps:
        assert step.height_Nm == 10.0
        assert step.largest_error == pytest.approx(1.0 - response[0], abs=1e-6)
        # 20 ms lie between two rows unless the contact begins on one.
        assert step.error_at_20_ms is not None
        assert any(
            step.error_at_20_ms == pytest.approx(abs(1.0 - response[n]), abs=1e-6)
            for n in (19, 20, 21)
        )
        assert step.is_swallowed
    (sine,) = by_name(evidence, "sine in motion")
    assert sine.frequency_Hz == 2.0
    expected = sosfilt(sections, sine.added_Nm)
    np.testing.assert_allclose(sine.through_Nm, expected, atol=1e-6 * RATED_NM)
    assert [line.order for line in evidence.lines] == [2.0, 4.0, 6.0]
    assert not any(line.is_told for line in evidence.lines)


def test_ripple_filter_passes_and_the_published_one_swallows(tmp_path: Path) -> None:
    log = joint_log(tmp_path)
    good, bad = evidence_of(log, "ripple"), evidence_of(log, "taghirad1999-4")
    assert len(good.contacts) == len(bad.contacts) == 5
    for contact in good.contacts:
        assert 0.0 <= contact.largest_error < 0.05
        assert not contact.is_swallowed
    # Taghirad and Bélanger's tuning forgets within a fraction of a second.
    for contact in by_name(bad, "step in motion"):
        assert contact.is_swallowed
        assert 0.5 < contact.largest_error < 1.5
    # What is removed is what was put in: 2 Nm, 1 Nm and nothing.
    before = [line.before_rms_Nm for line in good.lines]
    assert before[:2] == pytest.approx([2.0, 1.0], rel=0.02)
    assert before[2] < 0.02
    assert good.lines[0].after_rms_Nm < 0.1
    assert (good.rejected_rows, good.repeated_rows, good.orders_not_told) == (0, 0, ())


def test_where_contacts_are_added(tmp_path: Path) -> None:
    evidence = evidence_of(joint_log(tmp_path), "low-pass")
    for contact in evidence.contacts:
        at_rest = contact.name == "step at rest"
        assert contact.ends_s < 4.0 if at_rest else contact.begins_s > 4.0
        assert contact.motor_speed_rad_s == pytest.approx(0.0 if at_rest else 60.0, abs=0.5)
        assert contact.time_s[0] == pytest.approx(-0.02, abs=2 / RATE_HZ)
        assert np.max(np.abs(contact.added_Nm)) == pytest.approx(10.0, rel=1e-3)
    begins_s = [each.begins_s for each in by_name(evidence, "step in motion")]
    assert np.all(np.diff(begins_s) > 5.0)


def test_a_push_that_turns_like_the_ripple_is_marked(tmp_path: Path) -> None:
    t_s = np.arange(40_000) / RATE_HZ
    # From 2 to 16 rad/s: order 2 passes every frequency that a push may have.
    q_rad = 9.0 * t_s - 7.0 / 3.0 * np.cos(3.0 * t_s)
    columns = {"t_s": t_s, "q_rad": q_rad, "tau_Nm": 2.0 * np.cos(2 * q_rad) + np.sin(t_s)}
    evidence = evidence_of(write_parquet(tmp_path / "log.parquet", columns), "ripple")
    (sine,) = by_name(evidence, "sine in motion")
    assert (sine.frequency_Hz, sine.is_near_order) == (2.0, True)
    assert not any(each.is_near_order for each in by_name(evidence, "step in motion"))
    words = fidelity_beside(evidence)
    assert share_text(sine.largest_error) in words
    others = [each.largest_error for each in evidence.contacts if not each.is_near_order]
    assert share_text(max(others)) in words


def test_a_joint_that_never_moves_has_a_contact_at_rest_alone(tmp_path: Path) -> None:
    evidence = evidence_of(joint_log(tmp_path, moves=False), "ripple")
    assert [each.name for each in evidence.contacts] == ["step at rest"]
    assert evidence.contacts[0].largest_error < 1e-9
    assert (evidence.lines, evidence.spectrum, evidence.speed_map) == ((), None, None)


def test_rows_that_repeat_the_row_before_repeat_the_contact() -> None:
    angle_rad = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 2.0])
    torque_Nm = np.array([5.0, 5.0, 5.0, 5.0, 6.0, 6.0])
    samples = Samples(np.arange(6.0), angle_rad, torque_Nm, np.zeros(6))
    added_Nm = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    np.testing.assert_array_equal(held_with_the_rows(samples, added_Nm), [0, 0, 2, 2, 4, 5])
