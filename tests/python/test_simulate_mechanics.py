"""The mechanics against physics: energy, steady state, resonance, hysteresis."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from strainwave.errors import ConfigurationError
from strainwave.simulate import (
    NOTHING,
    CurrentCommand,
    Drive,
    Flexspline,
    Friction,
    Load,
    MeshRipple,
    Motor,
    PiecewiseLinear,
    RippleOrder,
    Sine,
    SpeedCommand,
    constant_speed,
    integrated_motion,
    prescribed_motion,
)
from strainwave.simulate.integration import substeps_needed
from strainwave.simulate.statics import held_back_by_friction, torsion_under

RATIO = 100.0


def drive(
    motor: Motor | None = None,
    flexspline: Flexspline | None = None,
    load: Load | None = None,
    mesh: MeshRipple | None = None,
) -> Drive:
    return Drive(
        motor or Motor(inertia_kg_m2=1e-4),
        RATIO,
        flexspline or Flexspline(1e4),
        load or Load(2.0),
        mesh or MeshRipple(),
    )


def times(duration_s: float, rate_Hz: float = 4000.0) -> np.ndarray:
    return np.arange(int(duration_s * rate_Hz) + 1) / rate_Hz


def energy_J(motion, plant: Drive, mesh_Nm=0.0) -> np.ndarray:
    stiffness = plant.flexspline.stiffness_Nm_per_rad
    stretched = (motion.motor_angle_rad / plant.ratio - motion.output_angle_rad) + (
        mesh_Nm / stiffness
    )
    cubic = plant.flexspline.hardening_Nm_per_rad3
    return (
        plant.motor.inertia_kg_m2 * motion.motor_speed_rad_s**2 / 2
        + plant.load.inertia_kg_m2 * motion.output_speed_rad_s**2 / 2
        + stiffness * stretched**2 / 2
        + cubic * stretched**4 / 4
    )


@pytest.mark.parametrize("orders", [(), (RippleOrder(2.0, 2.0), RippleOrder(4.0, 0.8, 0.7))])
def test_energy_without_friction_is_kept_by_an_undriven_drive(orders):
    plant = drive(flexspline=Flexspline(1e4, hardening_Nm_per_rad3=2e7), mesh=MeshRipple(orders))
    motion = integrated_motion(
        plant, CurrentCommand(NOTHING), NOTHING, times(1.0), start_torsion_rad=3e-3
    )
    ripple = plant.mesh.torque_Nm(
        motion.motor_angle_rad, motion.motor_speed_rad_s, motion.torque_Nm
    )
    energy = energy_J(motion, plant, ripple)
    assert energy[0] > 0.04
    np.testing.assert_allclose(energy, energy[0], rtol=2e-5)


def test_work_of_the_motor_becomes_energy():
    plant = drive()
    current = Sine(1.0, 3.0)
    motion = integrated_motion(plant, CurrentCommand(current), NOTHING, times(1.0))
    power = motion.motor_torque_Nm * motion.motor_speed_rad_s
    work = np.concatenate(([0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(motion.time_s))))
    assert work.max() > 0.04
    np.testing.assert_allclose(energy_J(motion, plant), work, atol=1e-5 * work.max())


def test_energy_only_falls_with_friction_damping_and_hysteresis():
    plant = drive(
        Motor(inertia_kg_m2=1e-4, friction=Friction(coulomb_Nm=0.01)),
        Flexspline(1e4, damping_Nm_s_per_rad=5.0),
    )
    motion = integrated_motion(
        plant, CurrentCommand(NOTHING), NOTHING, times(0.5), start_torsion_rad=3e-3
    )
    energy = energy_J(motion, plant)
    assert np.max(np.diff(energy)) < 1e-9
    assert energy[-1] < 0.2 * energy[0]


def test_natural_frequency_of_the_free_drive_is_the_analytic_one():
    plant = drive()
    motion = integrated_motion(
        plant, CurrentCommand(NOTHING), NOTHING, times(4.0), start_torsion_rad=1e-3
    )
    reflected = plant.motor.inertia_kg_m2 * RATIO**2
    expected_Hz = math.sqrt(1e4 * (1 / 2.0 + 1 / reflected)) / (2 * math.pi)
    crossings = np.flatnonzero((motion.torque_Nm[:-1] > 0) & (motion.torque_Nm[1:] <= 0))
    exact = motion.time_s[crossings] + (
        motion.torque_Nm[crossings]
        / (motion.torque_Nm[crossings] - motion.torque_Nm[crossings + 1])
        * (motion.time_s[1] - motion.time_s[0])
    )
    measured_Hz = (len(exact) - 1) / (exact[-1] - exact[0])
    assert measured_Hz == pytest.approx(expected_Hz, rel=1e-4)


def test_steady_state_current_carries_friction_and_contact_torque():
    friction = Friction(coulomb_Nm=0.02, viscous_Nm_s_per_rad=1e-4)
    plant = drive(
        Motor(inertia_kg_m2=1e-4, friction=friction), Flexspline(1e4, damping_Nm_s_per_rad=20.0)
    )
    contact = PiecewiseLinear((0.0,), (3.0,))
    motion = integrated_motion(
        plant, SpeedCommand(constant_speed(100.0, 0.5), 0.1, 1.0), contact, times(4.0)
    )
    assert motion.motor_speed_rad_s[-1] == pytest.approx(100.0, rel=1e-3)
    assert motion.torque_Nm[-1] == pytest.approx(3.0, rel=1e-3)
    expected = 0.02 + 1e-4 * 100.0 + 3.0 / RATIO
    assert motion.motor_torque_Nm[-1] == pytest.approx(expected, rel=1e-3)


def test_torque_accelerates_the_load_by_newton():
    plant = drive()
    motion = integrated_motion(
        plant, CurrentCommand(PiecewiseLinear((0.0,), (1.0,))), NOTHING, times(1.0)
    )
    total = 1e-4 + 2.0 / RATIO**2
    assert motion.motor_speed_rad_s[-1] == pytest.approx(0.0543 / total, rel=0.03)
    acceleration = np.gradient(motion.output_speed_rad_s, motion.time_s, edge_order=2)
    np.testing.assert_allclose(2.0 * acceleration, motion.torque_Nm, atol=0.02)


def test_current_stays_within_the_motors_torque():
    motion = integrated_motion(
        drive(), CurrentCommand(PiecewiseLinear((0.0,), (50.0,))), NOTHING, times(0.1)
    )
    assert motion.motor_torque_Nm.max() == pytest.approx(0.15, rel=1e-12)


def test_mesh_ripple_drives_the_mechanics_at_its_own_frequency():
    """Above resonance the spring sees the transmission error times W^2 / (W^2 - w_n^2)."""
    mesh = MeshRipple((RippleOrder(2.0, 1.0),))
    plant = drive(flexspline=Flexspline(1e4, damping_Nm_s_per_rad=10.0), mesh=mesh)
    motion = integrated_motion(
        plant, SpeedCommand(constant_speed(156.0, 0.3), 0.02, 0.1, 0.005), NOTHING, times(3.0)
    )
    late = motion.time_s > 1.5
    ripple = (motion.torque_Nm - motion.torque_without_ripple_Nm)[late]
    spectrum = np.abs(np.fft.rfft(ripple * np.hanning(len(ripple))))
    line_rad_s = 2 * math.pi * np.argmax(spectrum) * 4000.0 / len(ripple)
    speed = motion.motor_speed_rad_s[late].mean()
    assert line_rad_s == pytest.approx(2 * speed, abs=2 * math.pi * 4000.0 / len(ripple))
    natural_square = 1e4 * (1 / 2.0 + 1 / (1e-4 * RATIO**2))
    expected = (2 * speed) ** 2 / ((2 * speed) ** 2 - natural_square)
    assert np.sqrt(2) * ripple.std() == pytest.approx(expected, rel=0.03)
    angle = 2 * motion.motor_angle_rad[late]
    window = np.hanning(len(angle)) / np.hanning(len(angle)).mean()
    swing = motion.output_speed_rad_s[late] - motion.output_speed_rad_s[late].mean()
    shaken = 2 * abs(np.mean(window * swing * np.exp(1j * angle)))
    assert shaken == pytest.approx(expected / 2.0 / (2 * speed), rel=0.05)


def test_integrated_and_prescribed_motion_agree_where_the_load_is_stiffly_coupled():
    plant = drive(flexspline=Flexspline(1e5, damping_Nm_s_per_rad=200.0), load=Load(1.0))
    profile = Sine(50.0, 0.5)
    driven = integrated_motion(plant, SpeedCommand(profile, 2.0, 20.0, 0.0037), NOTHING, times(3.0))
    given_ = prescribed_motion(plant, profile, NOTHING, times(3.0))
    late = given_.time_s > 1.0
    np.testing.assert_allclose(driven.torque_Nm[late], given_.torque_Nm[late], atol=0.05)
    assert np.ptp(given_.torque_Nm) == pytest.approx(2 * 50 * math.pi / RATIO, rel=1e-3)


def test_hysteresis_loop_has_the_area_of_its_limit_and_the_right_sense():
    spring = Flexspline(1e4, hysteresis_Nm=1.0, hysteresis_stiffness_Nm_per_rad=1e4)
    cycle = 40.0 * np.sin(np.linspace(0, 4 * np.pi, 4001))
    torsion, z = torsion_under(cycle, spring)
    second = slice(2000, 4001)
    loss_J = float(np.trapezoid(cycle[second], torsion[second]))
    swing = np.ptp(torsion[second])
    # A fully developed loop of height 2 F over the swing, less what each reversal takes to turn.
    assert 0.9 * 2 * 1.0 * swing < loss_J < 2 * 1.0 * swing
    assert np.abs(z).max() <= 1.0
    np.testing.assert_allclose(1e4 * torsion + z, cycle, atol=1e-9)


def test_hysteresis_of_statics_and_of_dynamics_is_the_same():
    spring = Flexspline(
        1e4, hysteresis_Nm=1.0, hysteresis_stiffness_Nm_per_rad=3e3, damping_Nm_s_per_rad=100.0
    )
    plant = drive(Motor(inertia_kg_m2=1.0), spring, Load(0.1))
    contact = Sine(10.0, 0.5)
    motion = integrated_motion(plant, CurrentCommand(NOTHING), contact, times(4.0))
    _, z = torsion_under(motion.torque_Nm, spring)
    np.testing.assert_allclose(motion.hysteresis_Nm[4000:], z[4000:], atol=0.05)


def test_dry_bearing_hides_its_friction_both_ways():
    applied = np.array([0.0, 1.0, 2.0, 3.0, 2.9, 2.0, 0.0, -1.0])
    arrived = held_back_by_friction(applied, 0.5)
    np.testing.assert_allclose(arrived, [0.0, 0.5, 1.5, 2.5, 2.5, 2.5, 0.5, -0.5])


def test_hardening_spring_is_inverted_exactly():
    spring = Flexspline(1e4, hardening_Nm_per_rad3=5e8)
    torque = np.linspace(-60, 60, 41)
    torsion, z = torsion_under(torque, spring)
    np.testing.assert_allclose(1e4 * torsion + 5e8 * torsion**3, torque, atol=1e-9)
    assert not z.any()


def test_friction_has_a_breakaway_above_its_running_torque():
    friction = Friction(0.02, 1e-4, stribeck_Nm=0.01, stribeck_speed_rad_s=3.0)
    speed = np.linspace(0, 100, 5001)
    torque = friction.torque_Nm(speed, np.zeros(len(speed)))
    peak = int(np.argmax(torque[speed < 10]))
    assert 0.5 < speed[peak] < 3.0
    assert torque[peak] > 0.028
    assert torque[-1] == pytest.approx(0.02 + 0.01, rel=1e-6)
    scalar = [friction.scalar_torque_Nm(float(w), 0.0) for w in speed]
    np.testing.assert_allclose(scalar, torque, rtol=1e-12)
    np.testing.assert_allclose(friction.torque_Nm(-speed, 0 * speed), -torque)


@example(
    inertia=1e-5,
    stiffness=100.0,
    damping=34.0,
    hysteresis=0.0,
    coulomb=0.0,
    ripple=3.0,
    current=0.0,
    contact=488.0,
    hardening=3e4,
)
@given(
    inertia=st.floats(1e-5, 1e-2),
    stiffness=st.floats(1e2, 3e4),
    damping=st.floats(0, 50),
    hysteresis=st.just(0.0) | st.floats(1e-6, 5),
    coulomb=st.floats(0, 0.05),
    ripple=st.floats(0, 5),
    current=st.floats(-10, 10),
    contact=st.floats(-1000, 1000),
    hardening=st.floats(0, 1e8),
)
def test_motion_is_finite_for_valid_parameters(
    inertia, stiffness, damping, hysteresis, coulomb, ripple, current, contact, hardening
):
    plant = drive(
        Motor(inertia_kg_m2=inertia, friction=Friction(coulomb)),
        Flexspline(stiffness, hardening, damping, hysteresis),
        mesh=MeshRipple((RippleOrder(2.0, ripple, load_growth=1.0, speed_growth=1.0),)),
    )
    command = CurrentCommand(PiecewiseLinear((0.0,), (current,)))
    motion = integrated_motion(
        plant, command, PiecewiseLinear((0.0, 0.01), (0.0, contact)), times(0.02)
    )
    for quantity in vars(motion).values():
        assert np.all(np.isfinite(quantity))


def test_mechanics_too_fast_for_the_rate_is_refused_in_one_sentence():
    with pytest.raises(ConfigurationError, match=r"substeps = .*: expected at most 400"):
        substeps_needed(drive(flexspline=Flexspline(1e16)), CurrentCommand(NOTHING), 1e-3)


@pytest.mark.parametrize(
    ("build", "parameter"),
    [
        (lambda: Motor(inertia_kg_m2=-1e-4), "inertia_kg_m2"),
        (lambda: Motor(inertia_kg_m2=math.nan), "inertia_kg_m2"),
        (lambda: Motor(torque_constant_Nm_per_A=0.0), "torque_constant_Nm_per_A"),
        (lambda: Motor(torque_limit_Nm=math.inf), "torque_limit_Nm"),
        (lambda: Load(inertia_kg_m2=0.0), "inertia_kg_m2"),
        (lambda: Load(bearing_friction_Nm=-1.0), "bearing_friction_Nm"),
        (lambda: Flexspline(stiffness_Nm_per_rad=0.0), "stiffness_Nm_per_rad"),
        (lambda: Flexspline(hysteresis_Nm=-1.0), "hysteresis_Nm"),
        (lambda: Friction(coulomb_Nm=True), "coulomb_Nm"),
        (lambda: Friction(creep_speed_rad_s=0.0), "creep_speed_rad_s"),
        (lambda: RippleOrder(0.0, 1.0), "order"),
        (lambda: RippleOrder(2.0, -1.0), "amplitude_Nm"),
        (lambda: MeshRipple(rated_torque_Nm=0.0), "rated_torque_Nm"),
        (lambda: SpeedCommand(NOTHING, -1.0), "proportional_A_s_per_rad"),
    ],
)
def test_impossible_part_is_refused_by_name(build, parameter):
    with pytest.raises(ConfigurationError) as caught:
        build()
    assert caught.value.parameter == parameter
    assert "expected" in str(caught.value)
