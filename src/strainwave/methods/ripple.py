"""The ripple filter and the ripple smoother as methods for recordings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave import _core
from strainwave.configuration import learned_of, ripple_filter_of
from strainwave.identify.ripple_settings import RippleSettings, choose_ripple_settings
from strainwave.methods.interface import Cleaned, joined, nothing
from strainwave.ripple_filter import RippleFilter
from strainwave.samples import Samples

if TYPE_CHECKING:
    from strainwave.joint import Joint
    from strainwave.methods.setting import Setting

#: Orders where no joint file names them: the gear's two teeth regions and their harmonics.
STANDARD_ORDERS: Final = (2, 4, 6)
#: The first so many of them may have load and speed terms.
MODULATED_ORDERS: Final = 2
#: Memory where no joint file gives one and no recording tells, motor turns.
STANDARD_MEMORY_TURNS: Final = 10.0
#: Noise, random walk and initial amplitude where no joint file gives them, of the rated torque. The
#: walk is that of the noise's own size from one millisecond to the next: the result hardly depends
#: on it (docs/design/ripple-filter.md).
STANDARD_NOISE: Final = 1e-3
STANDARD_WALK_PER_SQRT_S: Final = 1e-3 * 1000.0**0.5
STANDARD_INITIAL_AMPLITUDE: Final = 0.05


def ripple_settings(setting: Setting) -> RippleSettings:
    """Choose the ripple filter's configuration.

    That of the joint file's ``[ripple_filter]`` of method ``"ripple"``, where there is one; else orders
    2, 4 and 6 of the wave, with memory and terms chosen by likelihood on an excerpt of the recording;
    else the standard memory and constant terms.

    Parameters
    ----------
    setting : Setting
        Full scale, factor m, excerpt, joint file.

    Returns
    -------
    RippleSettings
        The configuration, and what was chosen.
    """
    joint = _joint_with_section(setting)
    if joint is not None:
        config = ripple_filter_of(joint)
        return RippleSettings(
            config,
            any(order.with_load for order in config.orders),
            any(order.with_speed for order in config.orders),
            is_chosen=False,
        )
    rated = setting.rated_torque_Nm
    orders = [order * setting.wave_factor for order in STANDARD_ORDERS]
    given: dict[str, Any] = {
        "torque_noise_Nm": STANDARD_NOISE * rated,
        "torque_walk_Nm_per_sqrt_s": STANDARD_WALK_PER_SQRT_S * rated,
        "initial_amplitude_Nm": STANDARD_INITIAL_AMPLITUDE * rated,
        "rated_torque_Nm": rated,
    }
    if setting.excerpt is None:
        config = _core.RippleFilterConfig(
            orders=orders, memory_turns=STANDARD_MEMORY_TURNS, **given
        )
        return RippleSettings(config, load_terms=False, speed_terms=False, is_chosen=False)
    return choose_ripple_settings(
        setting.excerpt, orders, orders[:MODULATED_ORDERS], STANDARD_MEMORY_TURNS, given
    )


class Ripple:
    """The ripple filter, strainwave's default: no delay, torque at full bandwidth.

    Parameters
    ----------
    setting : Setting
        See `ripple_settings`; coefficients kept in the joint file are started with.
    """

    def __init__(self, setting: Setting) -> None:
        joint = _joint_with_section(setting)
        self._settings = ripple_settings(setting)
        self._filter = RippleFilter(
            self._settings.config, learned=None if joint is None else learned_of(joint)
        )

    @property
    def settings(self) -> RippleSettings:
        """The configuration, and how it was chosen."""
        return self._settings

    @property
    def filter(self) -> RippleFilter:
        """The filter with its state: configuration, learned coefficients, counters."""
        return self._filter

    def process(self, samples: Samples, /) -> Cleaned:
        """Remove the ripple from the next rows.

        Parameters
        ----------
        samples : Samples
            The rows that follow those of the last call.

        Returns
        -------
        Cleaned
            One row for each.
        """
        result = self._filter.process(
            samples.time_s,
            samples.motor_angle_rad,
            samples.torque_Nm,
            expected_torque_Nm=samples.expected_torque_Nm,
        )
        return Cleaned(result.torque_Nm, result.ripple_Nm, result.status)

    def finish(self) -> Cleaned:
        """Hand out nothing: no rows are held back.

        Returns
        -------
        Cleaned
            No rows.
        """
        return nothing()


class Smoother:
    """The ripple filter's model forwards and backwards: for logs, not for control.

    A block of rows is handed out once `looks_ahead` further rows are there. Blocks are counted from
    the first row, so that it makes no difference how a log is cut.

    Parameters
    ----------
    setting : Setting
        See `ripple_settings`.
    block_rows : int
        Rows handed out together.
    looks_ahead_rows : int
        Rows looked at beyond a block; some memories of the filter should fit into them.
    """

    def __init__(
        self, setting: Setting, *, block_rows: int = 50_000, looks_ahead_rows: int = 25_000
    ) -> None:
        self._settings = ripple_settings(setting)
        self._smoother = _core.RippleSmoother(self._settings.config)
        self._block_rows = block_rows
        self._looks_ahead_rows = looks_ahead_rows
        self._pending = Samples(np.empty(0), np.empty(0), np.empty(0), np.empty(0))

    @property
    def settings(self) -> RippleSettings:
        """The configuration, and how it was chosen."""
        return self._settings

    def process(self, samples: Samples, /) -> Cleaned:
        """Take the next rows.

        Parameters
        ----------
        samples : Samples
            The rows that follow those of the last call.

        Returns
        -------
        Cleaned
            The blocks that are ready.
        """
        self._pending = _appended(self._pending, samples)
        window = self._block_rows + self._looks_ahead_rows
        parts = []
        start = 0
        while len(self._pending) - start >= window:
            parts.append(self._smoothed(start, start + window, self._block_rows))
            start += self._block_rows
        self._pending = _cut(self._pending, start, len(self._pending))
        return joined(parts)

    def finish(self) -> Cleaned:
        """Hand out the rest.

        Returns
        -------
        Cleaned
            The rows that were held back.
        """
        count = len(self._pending)
        parts = []
        start = 0
        while count - start > 0:
            end = min(start + self._block_rows + self._looks_ahead_rows, count)
            # The last rows go out together: there is nothing ahead of them.
            finished = self._block_rows if end < count else end - start
            parts.append(self._smoothed(start, end, finished))
            start += finished
        self._pending = _cut(self._pending, count, count)
        return joined(parts)

    def _smoothed(self, start: int, end: int, finished_rows: int) -> Cleaned:
        rows = _cut(self._pending, start, end)
        return Cleaned(
            *self._smoother.process(
                rows.time_s,
                rows.motor_angle_rad,
                rows.torque_Nm,
                rows.expected_torque_Nm,
                finished_rows,
            )
        )


def _joint_with_section(setting: Setting) -> Joint | None:
    """Return the joint, if its ``[ripple_filter]`` is that of this method."""
    joint = setting.joint
    section = None if joint is None else joint.ripple_filter
    return joint if section is not None and section.method == "ripple" else None


def _cut(samples: Samples, start: int, end: int) -> Samples:
    return Samples(
        np.ascontiguousarray(samples.time_s[start:end]),
        np.ascontiguousarray(samples.motor_angle_rad[start:end]),
        np.ascontiguousarray(samples.torque_Nm[start:end]),
        np.ascontiguousarray(samples.expected_torque_Nm[start:end]),
    )


def _appended(first: Samples, second: Samples) -> Samples:
    return Samples(
        np.concatenate([first.time_s, second.time_s]),
        np.concatenate([first.motor_angle_rad, second.motor_angle_rad]),
        np.concatenate([first.torque_Nm, second.torque_Nm]),
        np.concatenate([first.expected_torque_Nm, second.expected_torque_Nm]),
    )
