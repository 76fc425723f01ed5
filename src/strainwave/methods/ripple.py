"""The ripple filter as a method for recordings: what it is told, chooses and starts with."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave import _core
from strainwave.configuration import frozen_terms_of, learned_of, ripple_filter_of
from strainwave.identify.ripple_settings import RippleSettings, Terms, choose_ripple_settings
from strainwave.methods.interface import Cleaned, nothing
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
#: Memories that are run backwards to know the ripple of the first row.
LEARNING_MEMORIES: Final = 5.0
#: Delays and leads that the core compensates, s.
LONGEST_DELAY_S: Final = 0.05
LONGEST_LEAD_S: Final = 0.005


def ripple_settings(setting: Setting) -> RippleSettings:
    """Choose the ripple filter's configuration.

    That which the setting brings along; else that of the joint file's ``[ripple_filter]`` of method ``"ripple"``, where there is one; else orders
    2, 4 and 6 of the wave, with memory and terms chosen by likelihood on an excerpt of the recording;
    else the standard memory and constant terms. The joint file's ``[misalignment]`` is removed frozen
    in each case.

    Parameters
    ----------
    setting : Setting
        Full scale, factor m, excerpt, joint file.

    Returns
    -------
    RippleSettings
        The configuration, and what was chosen.
    """
    if setting.ripple_settings is not None:
        return setting.ripple_settings
    joint = _joint_with_section(setting)
    if joint is not None:
        config = ripple_filter_of(joint)
        terms = Terms(
            any(order.with_load for order in config.orders),
            any(order.with_speed for order in config.orders),
            any(order.with_direction for order in config.orders),
        )
        return RippleSettings(config, terms, is_chosen=False)
    rated = setting.rated_torque_Nm
    orders = [order * setting.wave_factor for order in STANDARD_ORDERS]
    given: dict[str, Any] = {
        "torque_noise_Nm": STANDARD_NOISE * rated,
        "torque_walk_Nm_per_sqrt_s": STANDARD_WALK_PER_SQRT_S * rated,
        "initial_amplitude_Nm": STANDARD_INITIAL_AMPLITUDE * rated,
        "rated_torque_Nm": rated,
        "frozen": [] if setting.joint is None else frozen_terms_of(setting.joint),
    }
    if setting.excerpt is None:
        config = _core.RippleFilterConfig(
            orders=orders, memory_turns=STANDARD_MEMORY_TURNS, **given
        )
        return RippleSettings(config, Terms(), is_chosen=False)
    return choose_ripple_settings(
        setting.excerpt, orders, orders[:MODULATED_ORDERS], STANDARD_MEMORY_TURNS, given
    )


class Ripple:
    """The ripple filter, strainwave's default: no delay, torque at full bandwidth.

    Parameters
    ----------
    setting : Setting
        See `ripple_settings`. Where there is an excerpt, the first row is filtered with what
        `learned_at_the_start` says; coefficients kept in the joint file are started with.
    """

    def __init__(self, setting: Setting) -> None:
        joint = _joint_with_section(setting)
        self._settings = ripple_settings(setting)
        learned = None if joint is None else learned_of(joint)
        if learned is None and setting.excerpt is not None:
            learned = learned_at_the_start(setting.excerpt, self._settings.config)
        self._learned_before = learned
        self._filter = RippleFilter(self._settings.config, learned=learned)

    @property
    def settings(self) -> RippleSettings:
        """The configuration, and how it was chosen."""
        return self._settings

    @property
    def filter(self) -> RippleFilter:
        """The filter with its state: configuration, learned coefficients, counters."""
        return self._filter

    @property
    def learned_before(self) -> _core.LearnedRipple | None:
        """What the filter started with; None where it started with nothing."""
        return self._learned_before

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


def learned_at_the_start(
    excerpt: Samples, config: _core.RippleFilterConfig
) -> _core.LearnedRipple | None:
    """Learn a recording's ripple as it is at the first row, by running the filter backwards.

    A recording need not begin with rows from which the filter still has to learn.

    Parameters
    ----------
    excerpt : Samples
        The first rows.
    config : RippleFilterConfig
        The configuration that the recording will be filtered with.

    Returns
    -------
    LearnedRipple or None
        Coefficients with their standard deviations; None where a delay cannot be turned round,
        because it would be too long a lead, or where the motor does not move.
    """
    if not -LONGEST_LEAD_S <= -config.angle_to_torque_delay_s <= LONGEST_DELAY_S:
        return None
    turned = np.concatenate([[0.0], np.nancumsum(np.abs(np.diff(excerpt.motor_angle_rad)))])
    learning_rad = 2 * np.pi * LEARNING_MEMORIES * config.memory_turns
    rows = int(np.searchsorted(turned, learning_rad)) + 1
    backwards = slice(min(rows, len(turned)) - 1, None, -1)
    backward_filter = RippleFilter(
        _core.RippleFilterConfig(
            orders=config.orders,
            memory_turns=config.memory_turns,
            torque_noise_Nm=config.torque_noise_Nm,
            torque_walk_Nm_per_sqrt_s=config.torque_walk_Nm_per_sqrt_s,
            initial_amplitude_Nm=config.initial_amplitude_Nm,
            rated_torque_Nm=config.rated_torque_Nm,
            reference_speed_rad_s=config.reference_speed_rad_s,
            angle_to_torque_delay_s=-config.angle_to_torque_delay_s,
            minimum_speed_rad_s=config.minimum_speed_rad_s,
            frozen=config.frozen,
        )
    )
    result = backward_filter.process(
        -excerpt.time_s[backwards],
        excerpt.motor_angle_rad[backwards],
        excerpt.torque_Nm[backwards],
        expected_torque_Nm=excerpt.expected_torque_Nm[backwards],
    )
    at_rest = np.uint32(_core.StatusFlag.at_rest.value)
    moved = np.any((result.innovation_variance_Nm2 > 0) & ((result.status & at_rest) == 0))
    return _turned_round(backward_filter.learned()) if moved else None


def _turned_round(learned: _core.LearnedRipple) -> _core.LearnedRipple:
    """Backwards in time every motion has the other direction: so have the pairs that follow it."""
    signs: list[float] = []
    for order in learned.orders:
        pairs = 1 + order.with_load + order.with_speed
        signs += [1.0] * (2 * pairs) + [-1.0] * (2 * order.with_direction)
    return _core.LearnedRipple(
        orders=learned.orders,
        coefficients_Nm=np.array(signs) * learned.coefficients_Nm,
        standard_deviations_Nm=learned.standard_deviations_Nm,
        innovation_scale_Nm=learned.innovation_scale_Nm,
    )


def _joint_with_section(setting: Setting) -> Joint | None:
    """Return the joint, if its ``[ripple_filter]`` is that of this method."""
    joint = setting.joint
    section = None if joint is None else joint.ripple_filter
    return joint if section is not None and section.method == "ripple" else None
