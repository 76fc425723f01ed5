"""From a joint file to the configuration of either filter."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from strainwave import _core
from strainwave.configuration.sections import missing, required
from strainwave.errors import ConfigurationError, InputError
from strainwave.ripple_filter import RippleFilter as RunningRippleFilter

if TYPE_CHECKING:
    from strainwave.joint import Gear, Joint, Misalignment, OscillatorFilter, RippleFilter
    from strainwave.joint.provenance import Section

LARGEST_PART = 2**31 - 1
"""Largest numerator and denominator of an order in the core."""

MOST_FROZEN_TERMS = 8
"""Terms of the misalignment that the core's ripple filter has room for."""

_OTHER_SECTIONS = {
    "rated_torque_Nm": "gear",
    "angle_to_torque_delay_s": "signals",
    "frozen": "misalignment",
    "frozen.order": "misalignment",
}
"""Where the ripple filter's parameters stand that are not in its own section."""


def oscillator_filter_of(joint: Joint) -> _core.OscillatorFilterConfig:
    """Build the oscillator filter's configuration of a joint.

    Parameters
    ----------
    joint : Joint
        A joint with a section ``[ripple_filter]`` of method ``oscillator``, and ``[gear]`` where an
        order is given by it.

    Returns
    -------
    OscillatorFilterConfig
        Orders, variances, protection.

    Raises
    ------
    InputError
        If a section is missing, or the section's method is another one.
    """
    section = _oscillator_section(joint)
    variances = list(section.process_noise_variances_Nm2)
    given = _given(section, "minimum_travel_rad", "minimum_speed_rad_s", "variance_limit_ratio")
    return _core.OscillatorFilterConfig(
        orders=[_order(joint, order) for order in section.orders],
        process_noise_variance_Nm2=variances[0] if len(variances) == 1 else variances,
        measurement_noise_variance_Nm2=section.measurement_noise_variance_Nm2,
        initial_variance_Nm2=section.initial_variance_Nm2,
        sample_period_s=section.sample_period_s,
        rotation_source=_core.RotationSource[section.rotation_source],
        **given,
    )


def ripple_filter_of(joint: Joint) -> _core.RippleFilterConfig:
    """Build the ripple filter's configuration of a joint.

    The terms of ``[misalignment]`` become frozen terms against the motor's angle, with the output
    angle taken to be 0 where the motor angle is 0.

    Parameters
    ----------
    joint : Joint
        A joint with a section ``[ripple_filter]`` of method ``ripple``. Rated torque and what is
        given by the ratio come from ``[gear]``, the delay from ``[signals]``, frozen terms from
        ``[misalignment]``, where these are there.

    Returns
    -------
    RippleFilterConfig
        Orders, memory, noise, delay, frozen terms.

    Raises
    ------
    InputError
        If a section is missing, the section's method is another one, or the core cannot use a
        value.
    """
    section = _ripple_section(joint)
    given = _given(section, "initial_amplitude_Nm", "reference_speed_rad_s", "minimum_speed_rad_s")
    if joint.gear is not None:
        given["rated_torque_Nm"] = joint.gear.rated_torque_Nm
    if joint.signals is not None and joint.signals.angle_to_torque_delay_s is not None:
        given["angle_to_torque_delay_s"] = joint.signals.angle_to_torque_delay_s
    frozen = frozen_terms_of(joint)
    try:
        return _core.RippleFilterConfig(
            orders=_ripple_orders(joint, section),
            memory_turns=section.memory_turns,
            torque_noise_Nm=section.torque_noise_Nm,
            torque_walk_Nm_per_sqrt_s=section.torque_walk_Nm_per_sqrt_s,
            frozen=frozen,
            **given,
        )
    except ConfigurationError as error:
        # Of a list, the parameter has the position too: "frozen[1]".
        name = _OTHER_SECTIONS.get(error.parameter.partition("[")[0])
        if name is None:
            raise
        raise InputError(f"{error} in [{name}], for the ripple filter") from error


def learned_of(joint: Joint) -> _core.LearnedRipple | None:
    """Build what a joint's ripple filter starts with.

    Parameters
    ----------
    joint : Joint
        A joint with a section ``[ripple_filter]`` of method ``ripple``.

    Returns
    -------
    LearnedRipple or None
        Coefficients with standard deviations, None where the section has none.

    Raises
    ------
    InputError
        If the section is missing, or its method is another one.
    """
    section = _ripple_section(joint)
    if section.learned_coefficients_Nm is None or section.learned_standard_deviations_Nm is None:
        return None
    scale_Nm = section.learned_innovation_scale_Nm
    return _core.LearnedRipple(
        orders=_ripple_orders(joint, section),
        coefficients_Nm=list(section.learned_coefficients_Nm),
        standard_deviations_Nm=list(section.learned_standard_deviations_Nm),
        **({} if scale_Nm is None else {"innovation_scale_Nm": scale_Nm}),
    )


def running_ripple_filter(joint: Joint) -> RunningRippleFilter:
    """Start the ripple filter, which checks that what was learned belongs to it.

    Parameters
    ----------
    joint : Joint
        As for `ripple_filter_of`.

    Returns
    -------
    RippleFilter
        With the coefficients of the file.
    """
    return RunningRippleFilter(ripple_filter_of(joint), learned=learned_of(joint))


def _section(joint: Joint) -> OscillatorFilter | RippleFilter:
    if joint.ripple_filter is None:
        raise missing(joint, "ripple_filter")
    return joint.ripple_filter


def _oscillator_section(joint: Joint) -> OscillatorFilter:
    section = _section(joint)
    if section.method != "oscillator":
        raise _another_method(joint, section.method, "oscillator")
    return section


def _ripple_section(joint: Joint) -> RippleFilter:
    section = _section(joint)
    if section.method != "ripple":
        raise _another_method(joint, section.method, "ripple")
    return section


def _another_method(joint: Joint, found: str, expected: str) -> InputError:
    return InputError(
        f'joint "{joint.identity.name}": [ripple_filter] has method = "{found}"; expected method = '
        f'"{expected}" for this filter, so fill the section for it, or use the {found} filter'
    )


def _given(section: Section, *names: str) -> dict[str, float]:
    """Return those of the keys that the section has, so that the others are the core's own."""
    return {name: value for name in names if (value := getattr(section, name)) is not None}


def _order(joint: Joint, order: float | str) -> float | Fraction:
    # Who has no joint file does not wait for the library that checks it.
    from strainwave.joint import order_value  # noqa: PLC0415

    return _core_order(order_value(order, joint.gear))


def _core_order(value: float | Fraction) -> float | Fraction:
    """Return an order for the core: exact where its parts fit.

    A fraction of a ratio may have more digits than the core keeps; its nearest number has not.
    """
    exact = isinstance(value, Fraction) and max(value.as_integer_ratio()) <= LARGEST_PART
    return value if exact else float(value)


def _ripple_orders(joint: Joint, section: RippleFilter) -> list[_core.RippleOrder]:
    return [
        _core.RippleOrder(
            _order(joint, order),
            with_load=order in section.load_orders,
            with_speed=order in section.speed_orders,
            with_direction=order in section.direction_orders,
            keep=order in section.kept_orders,
        )
        for order in section.orders
    ]


def frozen_terms_of(joint: Joint) -> list[_core.FrozenTerm]:
    """Take the misalignment from the output's angle to the motor's.

    Parameters
    ----------
    joint : Joint
        A joint; with ``[gear]`` where it has ``[misalignment]``.

    Returns
    -------
    list of FrozenTerm
        What the ripple filter removes without learning; empty without ``[misalignment]``.

    Raises
    ------
    InputError
        If ``[gear]`` is missing, or there are more terms than the core has room for.
    """
    misalignment = joint.misalignment
    if misalignment is None:
        return []
    if len(misalignment.terms) > MOST_FROZEN_TERMS:
        raise InputError(
            f'joint "{joint.identity.name}": [misalignment] has {len(misalignment.terms)} terms; '
            f"expected at most {MOST_FROZEN_TERMS} for the ripple filter, so leave out the smallest"
        )
    return _against_motor_angle(misalignment, required(joint, "gear", joint.gear))


def _against_motor_angle(misalignment: Misalignment, gear: Gear) -> list[_core.FrozenTerm]:
    """Write a cos(n gamma) + b sin(n gamma) as a sum of cosine and sine of n / R motor angles.

    With gamma = s beta / R - zero, s the output's direction and beta the motor angle:
    cosine = a cos(n zero) - b sin(n zero), sine = s (a sin(n zero) + b cos(n zero)).
    """
    # Within a turn, so that n times it stays exact, and finite.
    zero_rad = math.remainder(misalignment.zero_of_output_angle_rad, math.tau)
    terms = []
    for term in misalignment.terms:
        n = term.cycles_per_output_turn
        cosine, sine = math.cos(n * zero_rad), math.sin(n * zero_rad)
        in_phase_Nm = term.cosine_Nm * cosine - term.sine_Nm * sine
        in_quadrature_Nm = term.cosine_Nm * sine + term.sine_Nm * cosine
        terms.append(
            _core.FrozenTerm(
                _core_order(n / Fraction(gear.ratio)),
                cosine_Nm=in_phase_Nm,
                sine_Nm=gear.output_direction * in_quadrature_Nm,
            )
        )
    return terms
