"""Fills the sections of a joint file from what was identified."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from strainwave.identify.torque_or_artefact import UNDECIDABLE
from strainwave.joint import build_section
from strainwave.joint.ripple_filter import RippleFilter
from strainwave.records.mapping import is_gauge_key

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from strainwave.identify.recording import Ripple
    from strainwave.identify.torque_or_artefact import TorqueOrArtefact
    from strainwave.joint import JointFile, Provenance
    from strainwave.joint.provenance import Section
    from strainwave.records.columns import FoundColumn
    from strainwave.records.identified_log import Gearing
    from strainwave.records.layout import Layout
    from strainwave.records.survey import Survey

_SOURCE = "what was identified"


def fill_joint(
    joint_file: JointFile,
    layout: Layout,
    survey: Survey,
    columns: Mapping[str, Any],
    gearing: Gearing,
    ripple: Ripple,
    judged: TorqueOrArtefact,
    provenance: Provenance,
) -> tuple[str, ...]:
    """Fill ``[gear]``, ``[signals]`` and ``[ripple_filter]``, each where enough is known.

    Parameters
    ----------
    joint_file : JointFile
        Changed in place.
    layout : Layout
        How the recording was read.
    survey : Survey
        What it holds.
    columns : mapping
        Columns by their key in ``[signals]``, from `columns_of`.
    gearing : Gearing
        Ratio and factor m.
    ripple : Ripple
        Orders, delay, noise, memory, terms.
    judged : TorqueOrArtefact
        Which orders are torque.
    provenance : Provenance
        Of all three.

    Returns
    -------
    tuple of str
        The sections that were filled.
    """
    sections: dict[str, Section] = {}
    joint = joint_file.joint
    has_gear = gearing.ratio is not None and layout.rated_torque_Nm is not None
    if has_gear:
        values = {} if joint.gear is None else joint.gear.model_dump(exclude_none=True)
        sections["gear"] = build_section("gear", _gear(values, layout, gearing), _SOURCE)
    values = {} if joint.signals is None else joint.signals.model_dump(exclude_none=True)
    signals = _signals(values, layout, survey, columns, ripple)
    sections["signals"] = build_section("signals", signals, _SOURCE)
    if ripple.settings is not None:
        old = joint.ripple_filter
        kept = old.kept_orders if isinstance(old, RippleFilter) else ()
        section = _ripple_filter(ripple, judged, gearing, kept, has_gear=has_gear)
        sections["ripple_filter"] = build_section("ripple_filter", section, _SOURCE)
    # A filter that is there names its orders by the gear: the new one takes its place at last.
    if "ripple_filter" in sections and joint.ripple_filter is not None:
        joint_file.remove_section("ripple_filter", provenance)
    for name, section_model in sections.items():
        joint_file.set_section(name, section_model, provenance)
    return tuple(sections)


def columns_of(
    layout: Layout, found: Mapping[str, FoundColumn], names: Sequence[str] | None
) -> dict[str, Any]:
    """Write the columns of a recording as ``[signals]`` names them.

    Parameters
    ----------
    layout : Layout
        How the recording is read.
    found : mapping
        Its columns, by key of the mapping.
    names : sequence of str or None
        Names of all columns.

    Returns
    -------
    dict
        Columns by their key in ``[signals]``.
    """
    keys = {
        "time": "time",
        "angle": f"{layout.angle_side}_angle",
        "speed": f"{layout.angle_side}_speed",
        "torque": "torque",
        "expected-torque": "expected_torque",
        "temperature": "temperature",
    }
    columns: dict[str, Any] = {}
    for key, column in found.items():
        # A name that is not unique, or no text for a file, gives way to the column's number.
        name: str | int = column.index + 1
        if names is not None and list(names).count(names[column.index]) == 1:
            text = names[column.index]
            name = text if text.isprintable() and 0 < len(text) <= 500 else name
        described = {"column": name, "unit": layout.columns[key].unit, "sign": column.sign}
        if is_gauge_key(key):
            columns.setdefault("gauges", []).append(described)
        else:
            columns[keys[key]] = described
    return columns


def _gear(old: dict[str, Any], layout: Layout, gearing: Gearing) -> dict[str, Any]:
    assert gearing.ratio is not None
    values = {key: value for key, value in old.items() if key != "provenance"}
    configuration = "fixed_flexspline" if gearing.factor == 1 else "fixed_circular_spline"
    ratio = float(gearing.ratio)
    changed = values.get("ratio") != ratio or values.get("configuration") != configuration
    if changed:
        # Teeth, sense and m of another gear say nothing of this one.
        for key in (
            "flexspline_teeth",
            "circular_spline_teeth",
            "output_direction",
            "identified_factor_m",
            "ratio_standard_uncertainty",
        ):
            values.pop(key, None)
    values |= {
        "configuration": configuration,
        "ratio": ratio,
        "rated_torque_Nm": layout.rated_torque_Nm,
    }
    if gearing.output_direction:
        values["output_direction"] = gearing.output_direction
    if gearing.ratio_standard_uncertainty is not None:
        values["ratio_standard_uncertainty"] = gearing.ratio_standard_uncertainty
    return values


def _signals(
    old: dict[str, Any],
    layout: Layout,
    survey: Survey,
    columns: Mapping[str, Any],
    ripple: Ripple,
) -> dict[str, Any]:
    values = {key: value for key, value in old.items() if key != "provenance"}
    values |= {**columns, "sampling_rate_Hz": survey.timing.rate_Hz}
    if any(f"{layout.angle_side}_{kind}" in values for kind in ("angle", "speed")):
        values["angle_side"] = layout.angle_side
    if ripple.delay is not None:
        values["angle_to_torque_delay_s"] = ripple.delay.delay_s
    return values


def _ripple_filter(
    ripple: Ripple,
    judged: TorqueOrArtefact,
    gearing: Gearing,
    once_kept: Sequence[float | str],
    *,
    has_gear: bool,
) -> dict[str, Any]:
    assert ripple.settings is not None
    config = ripple.settings.config
    by_gear = has_gear and gearing.factor != 1
    names: list[float | str] = [
        f"{round(each.order)}m" if by_gear else each.order * float(gearing.factor)
        for each in ripple.present
    ]
    pairs = list(zip(names, config.orders, strict=True))
    verdicts = [judged.of(each.order).decision for each in ripple.present]
    # What this recording does not decide, an earlier one may have.
    kept = [
        name
        for name, decision in zip(names, verdicts, strict=True)
        if decision == "keep" or (decision == UNDECIDABLE and name in once_kept)
    ]
    values: dict[str, Any] = {
        "method": "ripple",
        "orders": names,
        "load_orders": [name for name, order in pairs if order.with_load],
        "speed_orders": [name for name, order in pairs if order.with_speed],
        "direction_orders": [name for name, order in pairs if order.with_direction],
        "kept_orders": kept,
        "memory_turns": config.memory_turns,
        "torque_noise_Nm": config.torque_noise_Nm,
        "torque_walk_Nm_per_sqrt_s": config.torque_walk_Nm_per_sqrt_s,
        "initial_amplitude_Nm": config.initial_amplitude_Nm,
    }
    if ripple.settings.terms.speed:
        values["reference_speed_rad_s"] = config.reference_speed_rad_s
    return values
