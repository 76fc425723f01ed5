"""From how a gauge is bonded to what it sees of torque and of the wave.

Taghirad & Belanger 1999, section III, names radial, circumferential and angular placement errors.
Through the tube's shear strain, T / (2 pi r^2 h G), and the rosette's strain transformation
(`rosette_strain` of the core) they become a torque sensitivity t_j and, of harmonic i, a phasor with
the amplitude a_ij and the phase error psi_ij of Godler et al. 2000, eq. (6). Here that is written
for many layouts at once; tests hold it to the core and to the simulated strain field.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.fluctuation import equally_spaced_positions_rad
from strainwave.design.checks import number_within
from strainwave.errors import ConfigurationError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
    ComplexArray = NDArray[np.complex128]

#: Godler et al. 2000: +-2 %FS are left of three gauges with equal gains, which their amplitudes and
#: phases make of 18.9 %FS in the sum of three: 56.7 %FS of what one gauge makes of rated torque.
WAVE_OF_ONE_GAUGE_FS: Final = 3 * 18.9
#: The second harmonic is a twentieth of the first (section II-B); further ones are not published.
EACH_FOLLOWING_HARMONIC: Final = 1 / 20
MOST_HARMONICS: Final = 8


@dataclass(frozen=True)
class Wave:
    """The wave as one ideally placed gauge sees it.

    Parameters
    ----------
    amplitudes_FS : tuple of float
        Amplitude of harmonics 1, 2, ..., zero to peak, in % of the same gauge's signal at rated
        torque.
    normal_strain_ratio : float
        Amplitude of radial minus circumferential strain over that of the shear strain: what an
        angular placement error lets in. 1 as in the simulated station of Taghirad 1999.
    radius_exponent : float
        The wave's strain grows with this power of the radius. No paper says; 1 is a wave that
        grows evenly from the hub, 0 that of the simulated stations.

    Raises
    ------
    InputError
        If a value cannot be used.
    """

    amplitudes_FS: tuple[float, ...] = tuple(
        WAVE_OF_ONE_GAUGE_FS * EACH_FOLLOWING_HARMONIC**i for i in range(5)
    )
    normal_strain_ratio: float = 1.0
    radius_exponent: float = 1.0

    def __post_init__(self) -> None:
        if not 1 <= len(self.amplitudes_FS) <= MOST_HARMONICS:
            raise ConfigurationError(
                "wave_FS", self.amplitudes_FS, "%FS", f"1 to {MOST_HARMONICS} amplitudes"
            )
        for amplitude in self.amplitudes_FS:
            number_within("wave_FS", amplitude, "%FS", 0.0, 1e4)
        if self.amplitudes_FS[0] == 0:
            raise ConfigurationError("wave_FS", 0.0, "%FS", "a first harmonic above 0")
        number_within("normal_strain_ratio", self.normal_strain_ratio, "", -10.0, 10.0)
        number_within("wave_radius_exponent", self.radius_exponent, "", -4.0, 4.0)


@dataclass(frozen=True)
class Tolerances:
    """Standard deviations of normally distributed errors; each gauge has its own.

    Parameters
    ----------
    position_deg : float
        Circumferential: position around the flexspline, mechanical; harmonic i sees 2 i times it.
    amplitude : float
        Relative, of each harmonic for itself: inaccuracy of flexspline and wave generator.
    phase_deg : float
        Electrical, of each harmonic for itself: what does not follow the placement.
    gauge_factor : float
        Relative; of torque and wave alike.
    radial_mm : float
        Radial: distance from the axis.
    angular_deg : float
        Angular: turn of the pad out of its +-45 degrees.

    Raises
    ------
    InputError
        If a value is no number or outside its range.
    """

    position_deg: float = 0.0
    amplitude: float = 0.0
    phase_deg: float = 0.0
    gauge_factor: float = 0.0
    radial_mm: float = 0.0
    angular_deg: float = 0.0

    def __post_init__(self) -> None:
        ranges = {
            "position_deg": ("position_tolerance_deg", "deg", 90.0),
            "amplitude": ("amplitude_tolerance", "", 1.0),
            "phase_deg": ("phase_tolerance_deg", "deg", 180.0),
            "gauge_factor": ("gauge_factor_tolerance", "", 0.2),
            "radial_mm": ("radial_tolerance_mm", "mm", 100.0),
            "angular_deg": ("angular_tolerance_deg", "deg", 15.0),
        }
        for field, (name, unit, highest) in ranges.items():
            number_within(name, getattr(self, field), unit, 0.0, highest)

    def as_dict(self) -> dict[str, float]:
        """Return the tolerances by name.

        Returns
        -------
        dict
            Plain numbers.
        """
        return asdict(self)


@dataclass(frozen=True)
class GaugeErrors:
    """Errors of the gauges of many layouts; every array has the shape (layouts, gauges).

    Parameters
    ----------
    position_rad : numpy.ndarray
        Around the flexspline, mechanical.
    radius : numpy.ndarray
        Relative to the nominal radius, above -1.
    orientation_rad : numpy.ndarray
        Turn of the pad.
    gauge_factor : numpy.ndarray
        Relative.
    amplitude, phase_rad : numpy.ndarray
        Of each harmonic for itself, shape (layouts, harmonics, gauges).
    """

    position_rad: FloatArray
    radius: FloatArray
    orientation_rad: FloatArray
    gauge_factor: FloatArray
    amplitude: FloatArray
    phase_rad: FloatArray

    @classmethod
    def none(cls, layouts: int, harmonics: int, gauges: int) -> GaugeErrors:
        """Return ideal gauges.

        Parameters
        ----------
        layouts, harmonics, gauges : int
            How many.

        Returns
        -------
        GaugeErrors
            Zeros; the arrays can be written to.
        """
        each = (layouts, harmonics, gauges)
        shapes = {"amplitude": each, "phase_rad": each}
        return cls(
            **{
                field.name: np.zeros(shapes.get(field.name, (layouts, gauges)))
                for field in fields(cls)
            }
        )


def draw_errors(
    generator: np.random.Generator,
    tolerances: Tolerances,
    radius_mm: float,
    shape: tuple[int, int, int],
) -> GaugeErrors:
    """Draw the errors of many layouts.

    Parameters
    ----------
    generator : numpy.random.Generator
        Where chance comes from.
    tolerances : Tolerances
        Standard deviations.
    radius_mm : float
        Nominal distance of the gauges from the axis.
    shape : tuple of int
        Layouts, harmonics, gauges.

    Returns
    -------
    GaugeErrors
        Independent normal errors; radii end at a tenth of the nominal one.
    """
    layouts, harmonics, gauges = shape

    def drawn(deviation: float, size: tuple[int, ...]) -> FloatArray:
        return generator.normal(0.0, deviation, size) if deviation else np.zeros(size)

    plain = (layouts, gauges)
    return GaugeErrors(
        position_rad=drawn(np.deg2rad(tolerances.position_deg), plain),
        radius=np.maximum(drawn(tolerances.radial_mm / radius_mm, plain), -0.9),
        orientation_rad=drawn(np.deg2rad(tolerances.angular_deg), plain),
        gauge_factor=drawn(tolerances.gauge_factor, plain),
        amplitude=drawn(tolerances.amplitude, (layouts, harmonics, gauges)),
        phase_rad=drawn(np.deg2rad(tolerances.phase_deg), (layouts, harmonics, gauges)),
    )


def gauge_signals(wave: Wave, errors: GaugeErrors) -> tuple[FloatArray, ComplexArray]:
    """Torque sensitivity and wave of every gauge, M equally spaced ones with errors.

    Parameters
    ----------
    wave : Wave
        The wave.
    errors : GaugeErrors
        How the gauges are bonded.

    Returns
    -------
    torque : numpy.ndarray
        t_j relative to an ideal gauge's, shape (layouts, gauges).
    phasors : numpy.ndarray
        a_ij exp(j (2 i position_j + psi_ij)), %FS of an ideal gauge, shape (layouts, harmonics,
        gauges); the real part multiplies sin(2 i m beta), the imaginary part cos(2 i m beta).
    """
    # Strain transformation of a rosette turned by alpha: cos(2 alpha) of the shear strain, and
    # sin(2 alpha) of radial minus circumferential strain, which the wave has in quadrature.
    cosine, sine = np.cos(2 * errors.orientation_rad), np.sin(2 * errors.orientation_rad)
    factor = 1 + errors.gauge_factor
    radius = 1 + errors.radius
    torque = factor * cosine / radius**2
    let_in = factor * radius**wave.radius_exponent * (cosine - 1j * wave.normal_strain_ratio * sine)
    gauges = errors.position_rad.shape[1]
    turn = np.exp(2j * (equally_spaced_positions_rad(gauges) + errors.position_rad))
    phasors = np.empty(errors.amplitude.shape, dtype=np.complex128)
    power = let_in
    for i, amplitude in enumerate(wave.amplitudes_FS):
        power = power * turn
        phasors[:, i] = amplitude * (1 + errors.amplitude[:, i]) * power
    if np.any(errors.phase_rad):
        phasors *= np.exp(1j * errors.phase_rad)
    return torque, phasors
