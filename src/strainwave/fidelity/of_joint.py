"""From a joint file, or a setting, to the method that is measured."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Final

from strainwave.errors import InputError
from strainwave.fidelity.subject import Subject
from strainwave.methods.orders import RIPPLE_METHODS, removed_orders
from strainwave.methods.registry import METHOD_NAMES, Setting, build_method

if TYPE_CHECKING:
    from strainwave.joint import Joint

#: Where the joint file says nothing.
ASSUMED_PERIOD_S: Final = 1e-3
ASSUMED_RATED_TORQUE_NM: Final = 100.0
#: Noise of one sample where the tuning names none, of the rated torque.
ASSUMED_NOISE: Final = 1e-3
#: Orders of the ripple for a method that follows none, times the gear's factor m.
ASSUMED_ORDERS: Final = (2, 4, 6)


def subject_of_joint(joint: Joint, method: str | None = None) -> Subject:
    """Take the method, and what it is measured with, from a joint file.

    Parameters
    ----------
    joint : Joint
        What is known of the joint.
    method : str, optional
        Name of the method; that of ``[ripple_filter]`` without.

    Returns
    -------
    Subject
        The method under test. What was learned on the joint is left out: the synthetic ripple is
        another one.

    Raises
    ------
    InputError
        If there is no such method, or the joint file does not say what it needs.
    """
    name = method or _method_of(joint)
    assumptions = []
    sample_period_s, said = _sample_period_s(joint, name)
    assumptions += said
    if joint.gear is None:
        rated_Nm, ratio, wave = ASSUMED_RATED_TORQUE_NM, None, Fraction(1)
        assumptions.append(
            f"there is no section [gear]: a rated torque of {rated_Nm:g} Nm and a factor m of 1 are "
            "assumed"
        )
    else:
        rated_Nm = joint.gear.rated_torque_Nm
        ratio, wave = Fraction(joint.gear.ratio), joint.gear.exact_factor_m
    if name in RIPPLE_METHODS and (
        joint.ripple_filter is None or joint.ripple_filter.method != "ripple"
    ):
        assumptions.append(
            'there is no section [ripple_filter] of method "ripple": the standard orders, noise and '
            "memory are assumed, which a recording may change"
        )
    setting = Setting(sample_period_s, ratio, rated_Nm, joint, wave)
    return subject_of_setting(name, setting, tuple(assumptions))


def subject_of_setting(name: str, setting: Setting, assumptions: tuple[str, ...] = ()) -> Subject:
    """Take the method from what it is built from for a recording.

    Parameters
    ----------
    name : str
        Name of the method.
    setting : Setting
        What it is built from; an excerpt is not looked at.
    assumptions : tuple of str
        What was taken to be so.

    Returns
    -------
    Subject
        The method under test.

    Raises
    ------
    InputError
        If the method cannot be built.
    """
    bare = replace(setting, excerpt=None, joint=_without_what_was_learned(setting.joint))
    # Built once here, so that what it cannot be built from is said first.
    built: Any = build_method(name, bare)
    settings = getattr(built, "settings", None)
    noise_Nm, memory_turns = ASSUMED_NOISE * bare.rated_torque_Nm, 0.0
    if settings is not None:
        noise_Nm = settings.config.torque_noise_Nm
        memory_turns = settings.config.memory_turns
    removed = removed_orders(name, bare)
    assumed = tuple(float(order * bare.wave_factor) for order in ASSUMED_ORDERS)
    return Subject(
        name=name,
        build=lambda: build_method(name, bare),
        sample_period_s=bare.sample_period_s,
        rated_torque_Nm=bare.rated_torque_Nm,
        noise_Nm=noise_Nm,
        removed_orders=removed,
        ripple_orders=removed or assumed,
        memory_turns=memory_turns,
        assumptions=assumptions,
    )


def _method_of(joint: Joint) -> str:
    if joint.ripple_filter is None:
        raise InputError(
            f'joint "{joint.identity.name}": there is no section [ripple_filter] that says which '
            f"tuning is meant: expected one, or a method by its name ({', '.join(METHOD_NAMES)}); "
            "add the section, or give --method"
        )
    return joint.ripple_filter.method


def _sample_period_s(joint: Joint, name: str) -> tuple[float, list[str]]:
    section = joint.ripple_filter
    if joint.signals is not None and joint.signals.sampling_rate_Hz is not None:
        return 1.0 / joint.signals.sampling_rate_Hz, []
    if section is not None and section.method == "oscillator" and name == "oscillator":
        return section.sample_period_s, []
    return ASSUMED_PERIOD_S, [
        f"there is no sampling_rate_Hz in [signals]: a sample period of {1e3 * ASSUMED_PERIOD_S:g} "
        "ms is assumed"
    ]


def _without_what_was_learned(joint: Joint | None) -> Joint | None:
    section = None if joint is None else joint.ripple_filter
    if joint is None or section is None or section.method != "ripple":
        return joint
    nothing = dict.fromkeys(
        (
            "learned_coefficients_Nm",
            "learned_standard_deviations_Nm",
            "learned_innovation_scale_Nm",
        )
    )
    return joint.model_copy(update={"ripple_filter": section.model_copy(update=nothing)})
