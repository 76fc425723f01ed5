"""The default filter: the core's, `strainwave.RippleFilter`."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, Final

import numpy as np

import strainwave
from benchmarks.accuracy.methods.interface import Method, Removal

if TYPE_CHECKING:
    from benchmarks.accuracy.methods.interface import Log, Setting


def config_of(
    setting: Setting,
    *,
    memory_turns: float,
    torque_walk_over_noise: float,
    load_terms: bool = True,
    output_turn: bool = False,
) -> strainwave.RippleFilterConfig:
    """Configure the default filter for a joint.

    Parameters
    ----------
    setting : Setting
        Orders, noise, rated torque.
    memory_turns : float
        Memory, motor turns.
    torque_walk_over_noise : float
        Growth of the torque's variance in a millisecond over the variance of the noise, q_T/R.
    load_terms : bool
        Whether terms that follow the load are used.
    output_turn : bool
        Whether the modulated orders have a pair of side orders, one cycle per output turn either
        side: an amplitude or phase that changes over the output turn.

    Returns
    -------
    RippleFilterConfig
        The configuration.
    """
    # The angle is that of the wave already, so orders need no factor.
    orders = [
        strainwave.RippleOrder(
            order,
            with_load=load_terms and order in setting.modulated_orders,
            with_speed=order in setting.modulated_orders,
        )
        for order in setting.orders
    ]
    if output_turn:
        # The angle is the wave's: an output turn is m R of its turns, R + 1.
        beside = Fraction(1, round(setting.ratio) + 1)
        orders += [
            strainwave.RippleOrder(order + side * beside)
            for order in setting.modulated_orders
            for side in (-1, 1)
        ]
    return strainwave.RippleFilterConfig(
        orders=orders,
        memory_turns=memory_turns,
        torque_noise_Nm=setting.torque_noise_Nm,
        torque_walk_Nm_per_sqrt_s=setting.torque_noise_Nm
        * float(np.sqrt(1e3 * torque_walk_over_noise)),
        # Five percent of full scale, the package's standard.
        initial_amplitude_Nm=0.05 * setting.rated_torque_Nm,
        rated_torque_Nm=setting.rated_torque_Nm,
    )


def remove(log: Log, setting: Setting, **tuning: Any) -> Removal:
    """Run the default filter.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Orders, noise, rated torque.
    **tuning
        As for `config_of`.

    Returns
    -------
    Removal
        Torque and ripple.
    """
    result = strainwave.RippleFilter(config_of(setting, **tuning)).process(
        log.time_s, log.wave_angle_rad, log.torque_Nm, expected_torque_Nm=log.expected_torque_Nm
    )
    return Removal(np.asarray(result.torque_Nm), np.asarray(result.ripple_Nm))


def _memories(*memories_turns: float) -> tuple[dict[str, Any], ...]:
    # One parameter: memory. The torque's walk is that of the package's standard, R per millisecond,
    # the middle one of those that three robots chose; the result hardly depends on it.
    return tuple(
        {"memory_turns": memory, "torque_walk_over_noise": 1.0} for memory in memories_turns
    )


#: One tuning for every simulated joint and every figure of the table. With the output turn in the
#: model nothing is left that changes within an output turn, so that the memory can be longer than
#: one: the shortest that delays true torque by less than 0.02 ms (see "ours by memory").
OURS = Method(
    "ours",
    remove,
    ({"memory_turns": 200.0, "torque_walk_over_noise": 1.0, "output_turn": True},),
    "load, speed and output-turn terms for orders 2 and 4; one tuning for all simulated joints",
)
#: The same without knowledge of the output turn, to show what memory trades.
BY_MEMORY: Final = (*_memories(5.0, 10.0, 20.0, 40.0, 80.0), *OURS.grid)

#: Keeps both limits without knowledge of the output turn, for paths that have no room for it; its
#: warm-up is short enough for half an hour to be cut into chunks.
IN_LANES: Final = BY_MEMORY[1]

#: The Med7's strongest and its gentle tuning, each the same for all joints. Its ripple changes
#: within some turns and the recording is a third of an output turn long: memories are short.
KUKA_STRONG_TURNS: Final = 1.2
KUKA_GENTLE_TURNS: Final = 3.0
KUKA_GRID: Final = _memories(20.0, 10.0, 5.0, 4.0, 3.0, 2.0, 1.5, 1.2, 1.0)
