"""The ripple of a simulated joint, from its mesh: amplitudes and phases that follow load and speed.

Two families. In the first the amplitudes grow linearly with load and speed, which is what the
filter assumes ("right structure"). In the second they do what gears do and no filter here contains:
growth that saturates, a phase that the load's torsion shifts, modulation over the output turn,
drift, a line nobody models, teeth whose waveform is no sine.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

#: Cycles per turn of the wave, and zero-to-peak amplitudes at rest and without load, Nm.
ORDERS: Final = (2, 4, 6)
AMPLITUDES_NM: Final = (1.6, 0.6, 0.08)


@dataclass(frozen=True)
class Ripple:
    """One joint's ripple.

    Attributes
    ----------
    phases_rad : sequence of float
        Phase of each of `ORDERS`.
    load_growth, speed_growth : sequence of float
        Relative growth of each amplitude at rated torque and at full speed.
    saturation : float
        Share of the rated torque at which growth with load saturates; 0 for never.
    magnitude : bool
        Whether growth follows the load's magnitude, so that it has a kink where the torque passes
        zero, and not its sign.
    phase_shift_rad : float
        Shift of the phase at large load, of either sign.
    output_modulation : float
        Relative modulation of the amplitude once per output turn.
    output_phase_rad : float
        Where on the output turn.
    drift : float
        Relative growth from the start to the end of a minute.
    first_order_Nm : float
        Amplitude of a component of order 1.
    sharpness : float
        0 for a sine; above, flanks of the waveform steepen and crests flatten.
    """

    phases_rad: Sequence[float]
    load_growth: Sequence[float]
    speed_growth: Sequence[float]
    saturation: float = 0.0
    magnitude: bool = False
    phase_shift_rad: float = 0.0
    output_modulation: float = 0.0
    output_phase_rad: float = 0.0
    drift: float = 0.0
    first_order_Nm: float = 0.0
    sharpness: float = 0.0


def draw_ripple(random: np.random.Generator, scenario: str) -> Ripple:
    """Draw a joint's ripple.

    Parameters
    ----------
    random : numpy.random.Generator
        Source of randomness.
    scenario : str
        One of `SCENARIOS`.

    Returns
    -------
    Ripple
        The ripple.
    """
    right = Ripple(
        phases_rad=tuple(random.uniform(0.0, 2 * np.pi, 3)),
        load_growth=(random.uniform(0.3, 0.5), random.uniform(0.3, 0.6), 0.0),
        speed_growth=(random.uniform(0.1, 0.2), random.uniform(0.1, 0.3), 0.0),
    )
    output_phase_rad = random.uniform(0.0, 2 * np.pi)
    phase_shift_rad = random.choice((-1.0, 1.0)) * random.uniform(0.1, 0.2)
    mismatch = replace(
        right,
        load_growth=(*right.load_growth[:2], 0.4),
        saturation=0.25,
        phase_shift_rad=phase_shift_rad,
        output_modulation=0.05,
        output_phase_rad=output_phase_rad,
        drift=0.10,
        first_order_Nm=0.04,
    )
    teeth = replace(mismatch, magnitude=True, sharpness=0.8)
    return {RIGHT: right, MISMATCH: mismatch, TEETH: teeth}[scenario]


#: Amplitudes linear in load and speed.
RIGHT: Final = "right structure"
#: Saturation, shifted phase, modulation, drift, order 1: five ways in which gears depart from it.
MISMATCH: Final = "mismatch"
#: The same, growing with the load's magnitude, and with a waveform that is no sine.
TEETH: Final = "mismatch, teeth"
SCENARIOS: Final = (RIGHT, MISMATCH, TEETH)


def ripple_torque_Nm(
    ripple: Ripple,
    *,
    time_s: NDArray[np.float64],
    wave_angle_rad: NDArray[np.float64],
    output_angle_rad: NDArray[np.float64],
    load_share: NDArray[np.float64],
    speed_share: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Compute the ripple in the signal.

    Parameters
    ----------
    ripple : Ripple
        The joint's ripple.
    time_s : numpy.ndarray
        Time, s; for the drift.
    wave_angle_rad : numpy.ndarray
        Angle between wave generator and flexspline, m times the motor angle, rad.
    output_angle_rad : numpy.ndarray
        Angle of the output, rad.
    load_share : numpy.ndarray
        True torque over rated torque.
    speed_share : numpy.ndarray
        Motor speed over full speed.

    Returns
    -------
    numpy.ndarray
        Ripple, shape (samples,), Nm.
    """
    growth = np.abs(load_share) if ripple.magnitude else load_share
    if ripple.saturation > 0:
        growth = ripple.saturation * np.tanh(growth / ripple.saturation)
    shift_rad = ripple.phase_shift_rad * np.tanh(load_share / 0.25)
    common = (1 + ripple.drift * time_s / 60.0) * (
        1 + ripple.output_modulation * np.cos(output_angle_rad + ripple.output_phase_rad)
    )
    torque = ripple.first_order_Nm * np.cos(wave_angle_rad + ripple.output_phase_rad)
    for n, order in enumerate(ORDERS):
        amplitude = (
            AMPLITUDES_NM[n]
            * common
            * (1 + ripple.load_growth[n] * growth + ripple.speed_growth[n] * np.abs(speed_share))
        )
        # Orders shift by the same angle of the wave, hence in proportion to their number.
        turned_rad = order * wave_angle_rad + ripple.phases_rad[n] + shift_rad * order / 2
        torque = torque + amplitude * waveform(turned_rad, ripple.sharpness)
    return torque


def waveform(angle_rad: NDArray[np.float64], sharpness: float) -> NDArray[np.float64]:
    """Shape of one order over its cycle.

    Parameters
    ----------
    angle_rad : numpy.ndarray
        Angle within the cycle, rad.
    sharpness : float
        0 for a sine.

    Returns
    -------
    numpy.ndarray
        A cosine, or one with steeper flanks and flatter crests, of peak 1.
    """
    if sharpness == 0.0:
        return np.cos(angle_rad)
    return np.tanh(sharpness * np.cos(angle_rad)) / np.tanh(sharpness)
