"""Strain of the flexspline's diaphragm where the gauges are bonded.

Torque: a tube's shear stress T / (2 pi r^2 h) over the shear modulus.  Wave: the elliptic wave
generator bends the open rim, and the diaphragm sees normal and shear strains with two and four
(2 i) waves around, which turn with the wave and shift and grow with the load, because the teeth
engage elsewhere under load.  Torque enters the flexspline where teeth engage, so its own strain is
not even around either.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.simulate.checks import require_length, require_number
from strainwave.simulate.trajectories import FloatArray


def tube_shear_per_Nm(radius_m: float, thickness_m: float, shear_modulus_Pa: float) -> float:
    """Return the shear strain per torque of a thin tube, 1 / (2 pi r^2 h G).

    Parameters
    ----------
    radius_m : float
        Distance from the axis, m.
    thickness_m : float
        Thickness, m.
    shear_modulus_Pa : float
        Shear modulus, Pa.

    Returns
    -------
    float
        Engineering shear strain per Nm.
    """
    return 1.0 / (2 * math.pi * radius_m**2 * thickness_m * shear_modulus_Pa)


@dataclass(frozen=True)
class WaveHarmonic:
    """Harmonic i of the wave strain: 2 i cycles per turn of the wave over the flexspline.

    Shear strain: (shear_strain (1 + load_growth |w| + speed_growth |speed| / reference speed) +
    torque_share x strain of the torque) sin(2 i (m beta + position) + phase + load_phase w), where
    w is the torsion of the flexspline relative to that at rated torque.  Normal strains follow in
    quadrature, as the derivative of a bent ring's displacement does.

    Parameters
    ----------
    shear_strain : float
        Engineering shear strain, amplitude without load, at least 0.
    radial_strain, circumferential_strain : float
        Normal strains, amplitudes.  Their mean is the epsilon_w of Taghirad & Belanger 1999,
        eq. (1), which a rosette cancels; their difference enters through an orientation error.
    phase_rad : float
        Phase common to all gauges, sine form.
    load_growth, speed_growth : float
        Relative growth at rated torque and at the reference speed, above -1.
    load_phase_rad : float
        Shift at rated torque; it changes sign with the torque.
    torque_share : float
        By which share of itself the strain of the torque is uneven around the flexspline in this
        harmonic, 0 to 1.
    """

    shear_strain: float
    radial_strain: float = 0.0
    circumferential_strain: float = 0.0
    phase_rad: float = 0.0
    load_growth: float = 0.0
    speed_growth: float = 0.0
    load_phase_rad: float = 0.0
    torque_share: float = 0.0

    def __post_init__(self) -> None:
        require_number("shear_strain", self.shear_strain, "", minimum=0.0)
        require_number("radial_strain", self.radial_strain, "")
        require_number("circumferential_strain", self.circumferential_strain, "")
        require_number("phase_rad", self.phase_rad, "rad")
        require_number("load_growth", self.load_growth, "", above=-1.0)
        require_number("speed_growth", self.speed_growth, "", above=-1.0)
        require_number("load_phase_rad", self.load_phase_rad, "rad")
        require_number("torque_share", self.torque_share, "", minimum=0.0, maximum=1.0)


@dataclass(frozen=True)
class GaugePlacement:
    """One rosette: where it is bonded and what the flexspline is like there.

    Parameters
    ----------
    position_rad : float
        Angle around the flexspline.  It counts against the wave-generator angle: gauge j of M
        equally spaced ones stands at pi (j-1)/M and leads by 2 i pi (j-1)/M in harmonic i.
    radius_m : float
        Distance from the axis, above 0; a radial placement error changes it.
    orientation_error_rad : float
        Turn of the pad out of its +-45 degrees.
    gauge_factor : float
        Gauge factor, above 0.
    wave_scale : tuple of float
        Amplitude of each harmonic at this gauge relative to the field's, torque_share included;
        empty: all 1.
    wave_phase_error_rad : tuple of float
        psi_ij of Godler 2000, eq. (6), for each harmonic, where a paper gives the phases
        themselves and not the placement that makes them; empty: all 0.
    """

    position_rad: float
    radius_m: float = 0.015
    orientation_error_rad: float = 0.0
    gauge_factor: float = 2.0
    wave_scale: tuple[float, ...] = ()
    wave_phase_error_rad: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        require_number("position_rad", self.position_rad, "rad")
        require_number("radius_m", self.radius_m, "m", above=0.0)
        require_number(
            "orientation_error_rad",
            self.orientation_error_rad,
            "rad",
            minimum=-math.pi / 4,
            maximum=math.pi / 4,
        )
        require_number("gauge_factor", self.gauge_factor, "", above=0.0)
        for scale in self.wave_scale:
            require_number("wave_scale", scale, "", minimum=0.0)
        for phase in self.wave_phase_error_rad:
            require_number("wave_phase_error_rad", phase, "rad")


@dataclass(frozen=True)
class StrainField:
    """The diaphragm and its strains.

    Parameters
    ----------
    thickness_m : float
        Thickness h of the diaphragm, above 0.
    shear_modulus_Pa : float
        Shear modulus G of the flexspline's steel, above 0.
    rated_torque_Nm : float
        Torque to which growth with load refers, above 0.
    reference_speed_rad_s : float
        Motor speed to which growth with speed refers, above 0.
    harmonics : tuple of WaveHarmonic
        Wave strain, harmonics i = 1, 2, ...
    bypassed_hysteresis : float
        Share of the flexspline's hysteresis torque that passes by the gauges, at least 0: it is
        friction between clamped surfaces and not strain.
    """

    thickness_m: float
    shear_modulus_Pa: float = 79e9
    rated_torque_Nm: float = 40.0
    reference_speed_rad_s: float = 100.0
    harmonics: tuple[WaveHarmonic, ...] = ()
    bypassed_hysteresis: float = 0.0

    def __post_init__(self) -> None:
        require_number("thickness_m", self.thickness_m, "m", above=0.0)
        require_number("shear_modulus_Pa", self.shear_modulus_Pa, "Pa", above=0.0)
        require_number("rated_torque_Nm", self.rated_torque_Nm, "Nm", above=0.0)
        require_number("reference_speed_rad_s", self.reference_speed_rad_s, "rad/s", above=0.0)
        require_number("bypassed_hysteresis", self.bypassed_hysteresis, "", minimum=0.0)

    def shear_per_Nm(self, radius_m: float) -> float:
        """Return the shear strain per torque at a distance from the axis.

        Parameters
        ----------
        radius_m : float
            Distance from the axis, m.

        Returns
        -------
        float
            Engineering shear strain per Nm.
        """
        return tube_shear_per_Nm(radius_m, self.thickness_m, self.shear_modulus_Pa)

    def check_gauge(self, gauge: GaugePlacement) -> None:
        """Refuse a gauge whose lists do not fit the field's harmonics.

        Parameters
        ----------
        gauge : GaugePlacement
            The gauge.
        """
        for name in ("wave_scale", "wave_phase_error_rad"):
            given = getattr(gauge, name)
            if given:
                require_length(name, given, len(self.harmonics), "one a harmonic of the field")


@dataclass(frozen=True)
class FieldInputs:
    """What the strain depends on; every array has the shape (n,).

    Parameters
    ----------
    wave_angle_rad : ndarray
        Angle of the wave over the flexspline, m times the motor angle.
    motor_speed_rad_s : ndarray
        Motor speed.
    strained_torque_Nm : ndarray
        Torque that strains the diaphragm.
    windup : ndarray
        Torsion of the flexspline relative to that at rated torque, signed.
    """

    wave_angle_rad: FloatArray
    motor_speed_rad_s: FloatArray
    strained_torque_Nm: FloatArray
    windup: FloatArray


@dataclass(frozen=True)
class Strain:
    """Surface strain at one gauge; every array has the shape (n,).

    Parameters
    ----------
    torsional : ndarray
        Shear strain of the torque, its mean around the flexspline.
    wave_shear : ndarray
        Shear strain that turns with the wave, the unevenness of the torque's included.
    radial, circumferential : ndarray
        Normal strains of the wave.
    """

    torsional: FloatArray
    wave_shear: FloatArray
    radial: FloatArray
    circumferential: FloatArray


def strain_at(field: StrainField, gauge: GaugePlacement, inputs: FieldInputs) -> Strain:
    """Return the surface strain under one gauge.

    Parameters
    ----------
    field : StrainField
        The diaphragm.
    gauge : GaugePlacement
        The gauge.
    inputs : FieldInputs
        Wave angle, speed, torque and windup.

    Returns
    -------
    Strain
        Strains in polar directions.
    """
    torsional = field.shear_per_Nm(gauge.radius_m) * inputs.strained_torque_Nm
    speed = np.abs(inputs.motor_speed_rad_s) / field.reference_speed_rad_s
    shear = np.zeros(len(speed))
    radial = np.zeros(len(speed))
    circumferential = np.zeros(len(speed))
    for i, harmonic in enumerate(field.harmonics):
        scale = gauge.wave_scale[i] if gauge.wave_scale else 1.0
        error = gauge.wave_phase_error_rad[i] if gauge.wave_phase_error_rad else 0.0
        angle = (
            2 * (i + 1) * (inputs.wave_angle_rad + gauge.position_rad)
            + (harmonic.phase_rad + error)
            + harmonic.load_phase_rad * inputs.windup
        )
        grown = 1 + harmonic.load_growth * np.abs(inputs.windup) + harmonic.speed_growth * speed
        size: NDArray[np.float64] = scale * grown
        uneven = scale * harmonic.torque_share * torsional
        shear = shear + (harmonic.shear_strain * size + uneven) * np.sin(angle)
        radial = radial + harmonic.radial_strain * size * np.cos(angle)
        circumferential = circumferential + harmonic.circumferential_strain * size * np.cos(angle)
    return Strain(np.asarray(torsional), shear, radial, circumferential)
