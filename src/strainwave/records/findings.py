"""What a person should know of a recording, in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from strainwave.records.moving import LARGEST_MOTOR_SPEED_RAD_S, MOVING_RAD_S

if TYPE_CHECKING:
    from collections.abc import Iterator

    from strainwave.records.layout import Layout
    from strainwave.records.survey import Survey

REPEATED_SHARE: Final = 0.02
"""From this share of the rows in motion on, repeated samples are worth a sentence."""
SMALLEST_SCALE: Final = 0.15
LARGEST_SCALE: Final = 5.0
"""The largest torque should lie between these shares of the rated torque."""
JITTER: Final = 1.5
"""One row in a hundred comes later than so many median intervals."""


_UNLOADED: Final = (
    "was the joint without load? Otherwise check the gauges' unit, their order and the gain"
)


def warnings_of(layout: Layout, survey: Survey, rated_torque_Nm: float) -> tuple[str, ...]:
    """Put into sentences what is unusual, but no reason to stop.

    Parameters
    ----------
    layout : Layout
        How the recording is read.
    survey : Survey
        What it holds.
    rated_torque_Nm : float
        Full scale, Nm.

    Returns
    -------
    tuple of str
        Sentences, without an end mark.
    """
    return (
        *layout.remarks,
        *_timing(layout, survey),
        *_angle(survey),
        *_missing(survey),
        *_torque(layout, survey, rated_torque_Nm),
    )


def _timing(layout: Layout, survey: Survey) -> Iterator[str]:
    if "time" not in layout.columns:
        return
    timing = survey.timing
    if timing.out_of_order_rows:
        yield (
            f"time goes back or stands still at {_rows(timing.out_of_order_rows)} (first: row "
            f"{timing.first_out_of_order_row}); these rows are rejected and flagged "
            "sample_out_of_order"
        )
    if timing.gaps:
        assert timing.largest_interval_s is not None
        count = "1 gap" if timing.gaps == 1 else f"{timing.gaps} gaps"
        yield (
            f"there {'is' if timing.gaps == 1 else 'are'} {count} in time, the longest "
            f"{timing.largest_interval_s:.4g} s (first: before row {timing.first_gap_row}); the "
            "angle is taken as it stands after each"
        )
    median_s, early_s = timing.median_interval_s, timing.interval_1st_percentile_s
    late_s, shortest_s = timing.interval_99th_percentile_s, timing.smallest_interval_s
    if median_s is None or late_s is None or early_s is None or shortest_s is None:
        return
    if late_s > JITTER * median_s or early_s < median_s / JITTER:
        assert timing.largest_interval_s is not None
        yield (
            f"the time stamps jitter: rows are {1e3 * shortest_s:.4g} to "
            f"{1e3 * timing.largest_interval_s:.4g} ms apart, 98 % of them {1e3 * early_s:.4g} to "
            f"{1e3 * late_s:.4g} ms, at a median of {1e3 * median_s:.4g} ms; they are used as they "
            "are"
        )


def _angle(survey: Survey) -> Iterator[str]:
    if survey.angle_is_wrapped:
        assert survey.angle_lowest_rad is not None
        assert survey.angle_highest_rad is not None
        yield (
            "the angle goes back to its start after every turn (it stays between "
            f"{survey.angle_lowest_rad:.4g} and {survey.angle_highest_rad:.4g} rad); it was "
            "unwrapped"
        )
    if survey.moving.moving_rows == 0:
        yield (
            f"the motor is never faster than {MOVING_RAD_S:g} rad/s; ripple is learned in motion, so "
            "check the units of angle and time if it did move"
        )
    largest_rad_s = survey.moving.largest_speed_rad_s
    if largest_rad_s is not None and largest_rad_s > LARGEST_MOTOR_SPEED_RAD_S:
        yield (
            f"the motor would turn at {largest_rad_s:.4g} rad/s at its fastest, which none does: the "
            "angle jumps, as where values are lost or a counter of several turns overflows"
        )
    if survey.share_repeated >= REPEATED_SHARE:
        yield (
            f"{survey.share_repeated:.1%} of the rows in motion "
            f"({survey.moving.repeated_rows} of {survey.moving.moving_rows}) only repeat the angle "
            "and the torque of the row before: the signals change less often than rows are written"
        )


def _missing(survey: Survey) -> Iterator[str]:
    for key, count in survey.missing_by_key.items():
        if count:
            yield (
                f"{_rows(count)} of {survey.rows} {'has' if count == 1 else 'have'} no {key}; "
                f"{'it is' if count == 1 else 'they are'} rejected and flagged"
            )


def _torque(layout: Layout, survey: Survey, rated_torque_Nm: float) -> Iterator[str]:
    largest_Nm = survey.largest_torque_Nm
    if largest_Nm == 0.0:
        yield "the torque is 0 throughout; check whether the right column is mapped"
    if layout.rated_torque_source == "estimated":
        yield (
            f"the rated torque is not given; {rated_torque_Nm:g} Nm is taken as an estimate, the "
            f"largest torque of the recording ({largest_Nm:.4g} Nm) rounded up; give it with "
            "--rated-torque"
        )
    elif 0.0 < largest_Nm < SMALLEST_SCALE * rated_torque_Nm:
        yield (
            f"the largest torque is {largest_Nm:.4g} Nm, {largest_Nm / rated_torque_Nm:.2g} of the "
            f"rated torque of {rated_torque_Nm:g} Nm; "
            + ("is the column in volts?" if layout.chain is None else _UNLOADED)
        )
    elif largest_Nm > LARGEST_SCALE * rated_torque_Nm:
        yield (
            f"the largest torque is {largest_Nm:.4g} Nm, {largest_Nm / rated_torque_Nm:.3g} times "
            f"the rated torque of {rated_torque_Nm:g} Nm; is the column in mNm or in counts?"
        )


def _rows(count: int) -> str:
    return "1 row" if count == 1 else f"{count} rows"
