"""What the published tuning Q = 1e3 I, R = 1 does to true torque, measured.

The filter's output is what is measured minus what was predicted, so that torque which the expected
torque does not contain passes only as far as the filter fails to predict it. With the published
ratio of 1e3 between process and measurement noise it predicts nearly everything.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from strainwave._core import OscillatorFilterConfig
from strainwave.fidelity import PassThrough, RemovesRipple, StepResponse, contact_step, pass_through
from strainwave.filter import OscillatorFilter, oscillator_preset
from strainwave.reproduce import published
from strainwave.simulate.presets.taghirad1999 import taghirad1999

if TYPE_CHECKING:
    from numpy.typing import NDArray

FULL_SPEED_RAD_S = published.MOTOR_SPEED_RAD_S
SLOW_SPEED_RAD_S = 50.0
CONTACT_TORQUE_NM = 10.0
SMALL_CONFIG = OscillatorFilterConfig(orders=[2, 4])
#: Time constant of the small tuning, T_s / sqrt(Q/(2R)): the inverse of its notches' half width.
SETTLING_S = SMALL_CONFIG.sample_period_s / float(
    np.sqrt(
        SMALL_CONFIG.process_noise_variance_Nm2[0]
        / (2 * SMALL_CONFIG.measurement_noise_variance_Nm2)
    )
)


@dataclass(frozen=True)
class TuningResponse:
    """Fidelity of one tuning at one speed.

    Attributes
    ----------
    name : str
        Name of the tuning, for a legend.
    pass_through : PassThrough
        Gain and delay of true torque against frequency.
    contact : StepResponse
        Answer to a contact torque.
    """

    name: str
    pass_through: PassThrough
    contact: StepResponse


@dataclass(frozen=True)
class TuningStudy:
    """The published tuning beside a small one.

    Attributes
    ----------
    responses : tuple of TuningResponse
        Four and six states as published at full speed, four states at a slow speed, and four
        states with Q/R = 1e-5.
    """

    responses: tuple[TuningResponse, ...]

    def by_name(self, name: str) -> TuningResponse:
        """Response of a name.

        Parameters
        ----------
        name : str
            Name of the tuning.

        Returns
        -------
        TuningResponse
            That response.
        """
        return next(response for response in self.responses if response.name == name)


def removes_ripple(config: Callable[[], OscillatorFilterConfig]) -> RemovesRipple:
    """Make a filter of a configuration as `strainwave.fidelity` runs it.

    Parameters
    ----------
    config : callable
        Gives the configuration.

    Returns
    -------
    RemovesRipple
        Runs a fresh filter at every call.
    """

    def run(
        torque_Nm: NDArray[np.float64], motor_speed_rad_s: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        result = OscillatorFilter(config()).process(torque_Nm, motor_speed_rad_s=motor_speed_rad_s)
        return np.asarray(result.torque_Nm, dtype=np.float64)

    return run


FOUR_STATES = f"published, 4 states, {FULL_SPEED_RAD_S:g} rad/s"
SIX_STATES = f"published, 6 states, {FULL_SPEED_RAD_S:g} rad/s"
FOUR_STATES_SLOW = f"published, 4 states, {SLOW_SPEED_RAD_S:g} rad/s"
SMALL_TUNING = f"Q/R = 1e-5, 4 states, {FULL_SPEED_RAD_S:g} rad/s"


def tuning_study() -> TuningStudy:
    """Measure the published tunings, and a small one, on pure true torque.

    Returns
    -------
    TuningStudy
        Responses from 0.2 to 120 Hz and to a contact of 10 Nm.
    """
    cases = (
        (FOUR_STATES, lambda: oscillator_preset("taghirad1999-4"), FULL_SPEED_RAD_S),
        (
            SIX_STATES,
            lambda: oscillator_preset("taghirad1999", taghirad1999().gear.ratio),
            FULL_SPEED_RAD_S,
        ),
        (FOUR_STATES_SLOW, lambda: oscillator_preset("taghirad1999-4"), SLOW_SPEED_RAD_S),
        (SMALL_TUNING, lambda: SMALL_CONFIG, FULL_SPEED_RAD_S),
    )
    # Dense about orders 2 and 4 of both speeds, where gain and delay change within a hertz.
    near_a_notch = np.linspace(-2.5, 2.5, 31)
    lines_Hz = [order * speed / (2 * np.pi) for order in (2, 4) for _, _, speed in cases]
    frequencies_Hz = np.unique(
        np.concatenate(
            [
                np.geomspace(0.2, 30.0, 50),
                np.linspace(30.0, 120.0, 46),
                [1.0, 5.0],
                *(line_Hz + near_a_notch for line_Hz in lines_Hz),
            ]
        )
    )
    responses = []
    for name, config, speed in cases:
        filter_under_test = removes_ripple(config)
        responses.append(
            TuningResponse(
                name,
                pass_through(filter_under_test, frequencies_Hz, motor_speed_rad_s=speed),
                contact_step(
                    filter_under_test,
                    contact_torque_Nm=CONTACT_TORQUE_NM,
                    motor_speed_rad_s=speed,
                ),
            )
        )
    return TuningStudy(tuple(responses))
