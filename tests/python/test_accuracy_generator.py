"""The accuracy bench's generator: independent of the package, repeatable, and what it says it is."""

import ast
from pathlib import Path

import numpy as np
import pytest

from benchmarks.accuracy import joint as joints
from benchmarks.accuracy import motion as motions
from benchmarks.accuracy.basis import basis_residual_percent
from benchmarks.accuracy.load import chirp, contact_torque_Nm, pulse
from benchmarks.accuracy.ripple import (
    AMPLITUDES_NM,
    MISMATCH,
    ORDERS,
    RIGHT,
    SCENARIOS,
    TEETH,
    draw_ripple,
    ripple_torque_Nm,
    waveform,
)
from benchmarks.accuracy.sampling import converted_Nm, counted_rad, step_Nm

FOLDER = Path(joints.__file__).parent
#: Standard library, numpy, scipy, and nothing else.
ALLOWED = {"__future__", "collections", "dataclasses", "typing", "numpy", "scipy"}


def modules_of(start: str) -> dict[str, set[str]]:
    """Imports of a module of the bench and, transitively, of those of the bench it imports."""
    found: dict[str, set[str]] = {}
    waiting = [start]
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        tree = ast.parse((FOLDER / f"{name}.py").read_text(encoding="utf-8"))
        imported = set()
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                imported |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0
                imported.add(node.module or "")
        found[name] = imported
        waiting += [
            module.removeprefix("benchmarks.accuracy.")
            for module in imported
            if module.startswith("benchmarks.accuracy.")
        ]
    return found


@pytest.mark.parametrize("start", ["joint", "basis"])
def test_the_generator_imports_nothing_of_the_package(start):
    found = modules_of(start)
    assert {"motion", "load", "ripple", "sampling"} <= set(found)
    for name, imported in found.items():
        for module in imported:
            own = module.startswith("benchmarks.accuracy.")
            assert own or module.split(".")[0] in ALLOWED, f"{name} imports {module}"


def test_runs_are_repeatable_and_joints_differ():
    run, again = (joints.simulate(joints.make_joint(MISMATCH, 3)) for _ in range(2))
    np.testing.assert_array_equal(run.measured_torque_Nm, again.measured_torque_Nm)
    np.testing.assert_array_equal(run.motor_angle_rad, again.motor_angle_rad)
    other = joints.simulate(joints.make_joint(MISMATCH, 4))
    assert np.std(other.true_torque_Nm - run.true_torque_Nm) > 1.0
    assert np.std(other.ripple_Nm - run.ripple_Nm) > 0.5


def test_speed_is_the_slope_of_the_angle_and_acceleration_that_of_the_speed():
    motion = motions.move(motions.full_plan(), 0.3)
    assert motion.angle_rad[0] == 0.3
    middle = slice(1, -1)
    for integral, slope, largest in (
        (motion.angle_rad, motion.speed_rad_s, 2e-3),
        (motion.speed_rad_s, motion.acceleration_rad_s2, 2.0),
    ):
        by_difference = np.gradient(integral, motion.time_s)
        assert np.max(np.abs(by_difference - slope)[middle]) < largest


def test_phases_cover_what_they_say():
    motion = motions.move(motions.full_plan())
    assert len(motion.time_s) == 60_000
    speed = {name: motion.speed_rad_s[motion.phase == name] for name in motions.PHASES}
    full = motions.FULL_SPEED_RAD_S
    np.testing.assert_allclose(speed["steady"], full)
    np.testing.assert_allclose(speed["contact"], full)
    assert speed["acceleration"].min() < 45
    assert speed["acceleration"].max() > 200
    assert speed["reversal"].min() == pytest.approx(-full)
    assert np.sum(np.diff(np.sign(speed["reversal"])) != 0) >= 4
    assert np.all(speed["standstill"] == 0)
    assert 3 < np.max(np.abs(speed["crawl"])) < 5
    assert speed["crawl"].min() < -2
    assert speed["restart"][0] == 0
    assert speed["restart"][-1] == pytest.approx(full)


def test_contacts_come_in_contact_and_at_standstill_alone():
    joint = joints.make_joint(RIGHT, 1)
    motion = motions.move(motions.full_plan(joint.speed_scale))
    contact = contact_torque_Nm(joint.load, motion)
    touched = {str(phase) for phase in np.unique(motion.phase[contact != 0])}
    assert touched == {"contact", "standstill"}
    assert np.max(contact) == pytest.approx(joint.load.contact_Nm, rel=1e-6)
    assert np.all(contact_torque_Nm(joint.load, motions.move(motions.constant_plan(5.0))) == 0)


def test_a_pulse_has_its_height_and_a_chirp_its_frequencies():
    time_s = np.arange(0.0, 10.0, 1e-3)
    shape = pulse(time_s, 2.0, 4.0)
    assert np.all(shape[(time_s > 2.01) & (time_s < 4.0)] == 1)
    assert np.sum(shape) * 1e-3 == pytest.approx(2.0, abs=1e-3)
    swept = chirp(time_s, 1.0, 9.0, 20.0)
    crossings = time_s[1:][np.diff(np.sign(swept)) != 0]
    late = crossings[(crossings > 8.0) & (crossings < 8.8)]
    # From 18.06 to 20 Hz in the last 0.8 s before the fade: two crossings a period.
    assert 0.5 / np.mean(np.diff(late)) == pytest.approx(0.5 + 19.5 * (8.4 - 1.0) / 8.0, rel=0.01)
    assert np.all(swept[(time_s < 1.0) | (time_s > 9.0)] == 0)


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_what_is_not_torque_or_ripple_is_noise_of_a_thousandth(scenario):
    run = joints.simulate(joints.make_joint(scenario, 1))
    noise = run.measured_torque_Nm - run.true_torque_Nm - run.ripple_Nm
    expected = np.hypot(joints.NOISE_NM, step_Nm(joints.FULL_SCALE_NM) / np.sqrt(12))
    assert np.std(noise) == pytest.approx(expected, rel=0.02)
    assert abs(np.mean(noise)) < 5 * expected / np.sqrt(len(noise))
    # White: neighbours have nothing in common.
    assert abs(np.corrcoef(noise[1:], noise[:-1])[0, 1]) < 5 / np.sqrt(len(noise))


def test_converter_and_encoder_have_their_steps():
    step = step_Nm(40.0)
    assert step == pytest.approx(200 / 65536)
    codes = converted_Nm(np.linspace(-10, 10, 1001), 40.0) / step
    np.testing.assert_allclose(codes, np.rint(codes), atol=1e-9)
    assert converted_Nm(np.array([1e3]), 40.0)[0] == pytest.approx(100 - step)
    angle = np.linspace(-30, 30, 20_001)
    error = counted_rad(angle) - angle
    half_count = np.pi / 4096
    assert 0.99 * half_count < np.max(np.abs(error)) <= half_count * (1 + 1e-9)
    assert abs(np.mean(error)) < 0.02 * half_count


def amplitudes_Nm(ripple, load_share, speed_share):
    wave = np.linspace(0, 20 * np.pi, 8192, endpoint=False)
    values = ripple_torque_Nm(
        ripple,
        time_s=np.zeros(len(wave)),
        wave_angle_rad=wave,
        output_angle_rad=np.full(len(wave), np.pi / 2 - ripple.output_phase_rad),
        load_share=np.full(len(wave), load_share),
        speed_share=np.full(len(wave), speed_share),
    )
    spectrum = 2 * np.abs(np.fft.rfft(values)) / len(wave)
    return spectrum[[10 * order for order in (1, *ORDERS, 10)]]


def test_ripple_has_the_stated_amplitudes_and_grows_with_load_and_speed():
    ripple = draw_ripple(np.random.default_rng(5), RIGHT)
    at_rest = amplitudes_Nm(ripple, 0.0, 0.0)
    np.testing.assert_allclose(at_rest[1:4], AMPLITUDES_NM, rtol=1e-9)
    assert np.all(at_rest[[0, 4]] < 1e-9)
    loaded = amplitudes_Nm(ripple, 0.5, 0.0)[1:4] / AMPLITUDES_NM
    np.testing.assert_allclose(loaded, 1 + 0.5 * np.array(ripple.load_growth), rtol=1e-9)
    fast = amplitudes_Nm(ripple, 0.0, -1.0)[1:4] / AMPLITUDES_NM
    np.testing.assert_allclose(fast, 1 + np.array(ripple.speed_growth), rtol=1e-9)


def test_mismatch_saturates_shifts_and_has_an_order_nobody_models():
    ripple = draw_ripple(np.random.default_rng(5), MISMATCH)
    assert amplitudes_Nm(ripple, 0.0, 0.0)[0] == pytest.approx(ripple.first_order_Nm)
    growth = [amplitudes_Nm(ripple, share, 0.0)[1] / AMPLITUDES_NM[0] - 1 for share in (0.25, 0.5)]
    expected = [0.25 * np.tanh(share / 0.25) * ripple.load_growth[0] for share in (0.25, 0.5)]
    np.testing.assert_allclose(growth, expected, rtol=1e-9)
    assert 0.1 <= abs(ripple.phase_shift_rad) <= 0.2
    assert ripple.output_modulation == 0.05
    assert ripple.drift == 0.10


def test_teeth_are_no_sines():
    ripple = draw_ripple(np.random.default_rng(5), TEETH)
    found = amplitudes_Nm(ripple, 0.0, 0.0)
    assert 0.003 < found[4] < 0.05  # order 10, which no filter of orders 2, 4 and 6 has
    # Growth follows the load's magnitude.
    np.testing.assert_allclose(
        amplitudes_Nm(ripple, 0.3, 0.0)[1:], amplitudes_Nm(ripple, -0.3, 0.0)[1:], rtol=0.02
    )
    assert np.max(np.abs(waveform(np.linspace(0, 7, 1001), 0.8))) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("scenario", [MISMATCH, TEETH])
@pytest.mark.parametrize("seed", [1, 2, 3, 4, 100])
def test_the_filters_basis_does_not_contain_mismatched_ripple(scenario, seed):
    assert 0.05 <= basis_residual_percent(joints.simulate(joints.make_joint(scenario, seed))) < 0.4


def test_the_filters_basis_contains_the_right_structure_but_for_the_loads_lag():
    assert 0 < basis_residual_percent(joints.simulate(joints.make_joint(RIGHT, 1))) < 0.03


def test_torque_added_behind_the_gear_leaves_the_ripple_as_it_was():
    joint = joints.make_joint(RIGHT, 2)
    plan = motions.constant_plan(1.0)
    added = np.full(5000, 3.0)
    without = joints.simulate(joint, plan)
    behind = joints.simulate(joint, plan, added, ripple_sees_added=False)
    through = joints.simulate(joint, plan, added)
    np.testing.assert_array_equal(behind.ripple_Nm, without.ripple_Nm)
    np.testing.assert_allclose(behind.true_torque_Nm - without.true_torque_Nm, 3.0)
    assert np.std(through.ripple_Nm - without.ripple_Nm) > 0.01
