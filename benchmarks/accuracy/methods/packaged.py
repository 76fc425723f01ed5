"""Methods that the package offers by name, run over a whole log."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import strainwave.methods.registry as registered
from benchmarks.accuracy.methods.interface import Removal
from strainwave.methods.interface import joined
from strainwave.samples import Samples

if TYPE_CHECKING:
    from benchmarks.accuracy.methods.interface import Log, Setting


def run_packaged(name: str, log: Log, setting: Setting) -> Removal:
    """Run one of the package's methods as `strainwave filter --method` does.

    Parameters
    ----------
    name : str
        One of `strainwave.methods.registry.METHOD_NAMES`.
    log : Log
        The recording.
    setting : Setting
        Sample period, ratio, rated torque.

    Returns
    -------
    Removal
        Torque and ripple.
    """
    method = registered.build_method(
        name,
        registered.Setting(
            setting.sample_period_s,
            Fraction(setting.ratio),
            setting.rated_torque_Nm,
            joint=None,
            excerpt=Samples(log.time_s, log.wave_angle_rad, log.torque_Nm, log.expected_torque_Nm),
        ),
    )
    samples = Samples(log.time_s, log.wave_angle_rad, log.torque_Nm, log.expected_torque_Nm)
    cleaned = joined([method.process(samples), method.finish()])
    return Removal(cleaned.torque_Nm, cleaned.ripple_Nm)
