"""The default filter's kin: as it is without a joint file, and its smoother for logs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from benchmarks.accuracy.methods.interface import Method, Removal
from benchmarks.accuracy.methods.ours import OURS, config_of
from benchmarks.accuracy.methods.packaged import run_packaged
from strainwave import _core

if TYPE_CHECKING:
    from benchmarks.accuracy.methods.interface import Log, Setting


def remove_untouched(log: Log, setting: Setting) -> Removal:
    """Run `--method ripple` as it is where no joint file says more.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Rated torque.

    Returns
    -------
    Removal
        Torque and ripple.
    """
    return run_packaged("ripple", log, setting)


def smooth(log: Log, setting: Setting, **tuning: Any) -> Removal:
    """Run the same model forwards and backwards over the whole log.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Orders, noise, rated torque.
    **tuning
        As for the filter.

    Returns
    -------
    Removal
        Torque and ripple.
    """
    smoother = _core.RippleSmoother(config_of(setting, **tuning))
    torque, ripple, _ = smoother.process(
        log.time_s,
        log.wave_angle_rad,
        log.torque_Nm,
        log.expected_torque_Nm,
        len(log.time_s),
    )
    return Removal(torque, ripple)


OURS_UNTOUCHED = Method(
    "ours, no joint file", remove_untouched, remark="memory and terms chosen on the log itself"
)
OURS_SMOOTHER = Method("ours, smoother", smooth, OURS.grid, "offline: it sees the future")
