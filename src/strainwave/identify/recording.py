"""What a recording says of orders, delay, noise, memory and terms, once its motor angle is known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave import _core
from strainwave.identify.delay import Delay, find_delay, speed_changes
from strainwave.identify.likelihood import innovations
from strainwave.identify.moving_rows import moving_rows
from strainwave.identify.noise import Noise, innovation_noise, rest_noise
from strainwave.identify.orders import find_orders
from strainwave.identify.output_cycles import OutputCycles, find_output_cycles
from strainwave.identify.ripple_settings import RippleSettings, choose_ripple_settings

if TYPE_CHECKING:
    from fractions import Fraction

    from strainwave.identify.orders import FoundOrder
    from strainwave.samples import Samples

#: Orders that are looked for, cycles per turn of the wave.
CANDIDATES: Final = tuple(range(1, 13))
#: The first so many of those that are there may have load and speed terms.
MODULATED_ORDERS: Final = 2
#: Below so many motor turns nothing is said of ripple.
LEAST_TURNS: Final = 3.0
STANDARD_MEMORY_TURNS: Final = 10.0
#: Noise, random walk and initial amplitude before anything is known, of the rated torque; the
#: result hardly depends on the walk (docs/design/ripple-filter.md).
STANDARD_NOISE: Final = 1e-3
WALK_PER_SQRT_S: Final = 1e-3 * 1000.0**0.5
INITIAL_AMPLITUDE: Final = 0.05
#: A delay that is known to no better than this many rows is not known.
LARGEST_DELAY_UNCERTAINTY_ROWS: Final = 1.0


@dataclass(frozen=True)
class Ripple:
    """What was found.

    Attributes
    ----------
    orders : tuple of FoundOrder
        Every candidate that could be measured, present or not.
    delay : Delay or None
        None where the recording does not tell.
    noise : Noise
        Noise of one sample, and where it comes from.
    settings : RippleSettings or None
        The filter; None where no order is there.
    output_cycles : tuple of OutputCycles
        Torque that repeats with the output's angle; empty where the recording is too short.
    motor_turns : float
        Travel of the motor.
    cannot_tell : tuple of str
        Sentences on what the recording does not tell, and what is used in its place.
    """

    orders: tuple[FoundOrder, ...]
    delay: Delay | None
    noise: Noise
    settings: RippleSettings | None
    output_cycles: tuple[OutputCycles, ...]
    motor_turns: float
    cannot_tell: tuple[str, ...]

    @property
    def noise_Nm(self) -> float:
        """Standard deviation of the noise of one sample, Nm."""
        return self.noise.noise_Nm

    @property
    def present(self) -> tuple[FoundOrder, ...]:
        """Orders that are there."""
        return tuple(order for order in self.orders if order.is_present)


def identify_ripple(
    excerpt: Samples,
    factor: Fraction,
    ratio: Fraction | None,
    rated_torque_Nm: float,
    *,
    may_have_load: bool,
) -> Ripple:
    """Find out all that the motor's angle and the torque say.

    Parameters
    ----------
    excerpt : Samples
        Rows of the recording.
    factor : fractions.Fraction
        Turns of the wave per motor turn, m.
    ratio : fractions.Fraction or None
        Motor turns per output turn.
    rated_torque_Nm : float
        Full scale, Nm.
    may_have_load : bool
        Whether load terms can be used.

    Returns
    -------
    Ripple
        What was found.
    """
    rows = moving_rows(excerpt.time_s, excerpt.motor_angle_rad, excerpt.torque_Nm)
    turns = float(np.sum(np.abs(np.diff(rows.angle_rad)))) / (2 * np.pi)
    says: list[str] = []
    at_rest = rest_noise(excerpt)
    standard_noise_Nm = STANDARD_NOISE * rated_torque_Nm
    given: dict[str, Any] = {
        "torque_noise_Nm": standard_noise_Nm if at_rest is None else at_rest.noise_Nm,
        "torque_walk_Nm_per_sqrt_s": WALK_PER_SQRT_S * rated_torque_Nm,
        "initial_amplitude_Nm": INITIAL_AMPLITUDE * rated_torque_Nm,
        "rated_torque_Nm": rated_torque_Nm,
    }
    wave = float(factor)
    orders: list[FoundOrder] = []
    if turns >= LEAST_TURNS:
        orders = find_orders(rows, CANDIDATES, wave)
    delay = None
    if any(order.is_present for order in orders):
        lines = [wave * order.order for order in orders if order.is_present]
        delay = find_delay(excerpt, rows, lines, given)
        why_not = _why_no_delay(delay, excerpt, changes=speed_changes(rows))
        if delay is None or why_not:
            delay = None
            says.append(why_not)
        else:
            orders = find_orders(rows, CANDIDATES, wave, delay.delay_s)
            given["angle_to_torque_delay_s"] = delay.delay_s
    elif turns < LEAST_TURNS:
        says.append(
            f"the motor makes {turns:.2g} turns, fewer than {LEAST_TURNS:g}: orders, delay and "
            "memory cannot be told and are left at their defaults; record a longer motion"
        )
    else:
        says.append(
            "no order stands out of the torque's noise: orders, delay and memory are left at their "
            "defaults; check torque column, angle side and ratio, or record a longer motion"
        )
    present = [order for order in orders if order.is_present]
    noise = at_rest or _noise_in_motion(excerpt, [wave * order.order for order in present], given)
    says += _on_the_noise(noise)
    given["torque_noise_Nm"] = noise.noise_Nm
    settings = None
    if present:
        # The strongest first: they may have further terms.
        ranked = sorted(present, key=lambda each: -each.amplitude_Nm)
        modulated = [wave * each.order for each in ranked[:MODULATED_ORDERS]]
        settings = choose_ripple_settings(
            excerpt,
            [wave * each.order for each in present],
            modulated,
            STANDARD_MEMORY_TURNS,
            given,
            may_have_load=may_have_load,
        )
        if not settings.is_chosen:
            says.append(
                f"the motor makes {turns:.3g} turns in {len(rows)} usable rows, too few to choose a "
                f"memory: it is left at {STANDARD_MEMORY_TURNS:g} turns, without terms in load, speed or direction; record a longer motion"
            )
    cycles = () if ratio is None else find_output_cycles(rows, ratio)
    return Ripple(tuple(orders), delay, noise, settings, cycles, turns, tuple(says))


def _why_no_delay(delay: Delay | None, excerpt: Samples, *, changes: bool) -> str:
    """Say why the delay is left at 0; nothing where it is not."""
    if not changes:
        return (
            "the motor's speed hardly changes: the delay between angle and torque cannot be told "
            "from the ripple's phase and is left at 0; record a motion at two speeds or more"
        )
    if delay is None:
        return (
            "the delay between angle and torque does not show in this recording: it is left at 0; "
            "record a faster motion at several speeds"
        )
    steps_s = np.diff(excerpt.time_s)
    largest_s = LARGEST_DELAY_UNCERTAINTY_ROWS * float(np.median(steps_s[steps_s > 0.0]))
    doubt = delay.doubt
    if not doubt and delay.standard_uncertainty_s > largest_s:
        doubt = f"it is known to no better than {1e3 * delay.standard_uncertainty_s:.2g} ms"
    if not doubt:
        return ""
    return (
        f"the ripple fits a delay between angle and torque of {1e3 * delay.delay_s:.3g} ms best, but "
        f"{doubt}: it is not trusted, and the delay is left at 0; record a longer and faster motion "
        "at several speeds, in both directions"
    )


def _noise_in_motion(excerpt: Samples, orders: list[float], given: dict[str, Any]) -> Noise:
    """Take the noise from the filter's innovations, or else leave it as it is given."""
    if orders:
        config = _core.RippleFilterConfig(
            orders=orders, memory_turns=STANDARD_MEMORY_TURNS, **given
        )
        found = innovation_noise(innovations(excerpt, config).innovation_Nm)
        if found is not None:
            return found
    return Noise(float(given["torque_noise_Nm"]), None, "standard")


def _on_the_noise(noise: Noise) -> list[str]:
    why = "the motor is never at rest for long enough, or the torque does not change there: the "
    advice = "; record two seconds at rest as well"
    if noise.source == "innovations":
        return [
            f"{why}noise of {noise.noise_Nm:.3g} Nm is that of the filter's innovations, an upper "
            f"bound{advice}"
        ]
    if noise.source == "standard":
        return [
            f"{why}noise is left at {STANDARD_NOISE:.1%} of the rated torque, "
            f"{noise.noise_Nm:.3g} Nm{advice}"
        ]
    return []
