"""What the complete image has to show: it learns, outlives resets, and is caught."""

import re
from pathlib import Path

import emulator

boards = ("mps2-an386", "mps2-an500", "mps2-an505")
_learned_at_each_start = ["nothing", "restored", "restored", "refused"]
_bites_at_each_start = [0, 0, 1, 1]
# Ripple of 1.6 and 0.6 Nm and misalignment of 0.36 Nm have a mean square of 1.53 Nm^2, the noise of
# the gauges' sum one of 3e-5 Nm^2.
_raw_uNm2 = 1_500_000
_noise_uNm2 = 33
_fault = "fault: the joint's constants are corrupt"
_exit_corrupt_joint = 71


class MismatchError(AssertionError):
    """The image did something else than it should."""


def _expect(true: bool, what: str) -> None:
    if not true:
        raise MismatchError(what)


def _starts(text: str) -> list[tuple[dict[str, str], list[dict[str, int]]]]:
    starts: list[tuple[dict[str, str], list[dict[str, int]]]] = []
    for line in text.splitlines():
        fields = dict(re.findall(r"(\w+)=(.*?)(?= \w+=|$)", line))
        if "start" in fields:
            starts.append((fields, []))
        else:
            starts[-1][1].append({key: int(value) for key, value in fields.items()})
    return starts


def check(image: Path) -> str:
    """Run the image through its four starts; say in one line what it showed."""
    text = emulator.run(image)
    starts = _starts(text)
    heads = [head for head, _ in starts]
    _expect(_fault not in text, f"no fault of the joint:\n{text}")
    _expect([int(head["start"]) for head in heads] == [1, 2, 3, 4], f"four starts:\n{text}")
    learned = [head["learned"] for head in heads]
    _expect(learned == _learned_at_each_start, f"found at the starts: {learned}")
    bites = [int(head["watchdog_bites"]) for head in heads]
    _expect(bites == _bites_at_each_start, f"the watchdog's bites at the starts: {bites}")
    first, restored, again, refused = (rows for _, rows in starts)
    settled_uNm2 = first[-1]["mean_square_uNm2"]
    _expect(
        _noise_uNm2 / 2 < settled_uNm2 < 2 * _noise_uNm2, f"error once learned: {settled_uNm2} uNm2"
    )
    _expect(
        all(row["status"] == 0 and row["intact"] == 1 for row in first), "a run without a fault"
    )
    cold_uNm2, warm_uNm2 = first[0]["mean_square_uNm2"], restored[0]["mean_square_uNm2"]
    _expect(10 * warm_uNm2 < cold_uNm2 < _raw_uNm2 / 20, f"{cold_uNm2=} {warm_uNm2=}")
    _expect(restored == again, "the same coefficients restored twice, the same torque")
    _expect(refused == first[: len(refused)], "without its block as at the very first start")
    return (
        f"mean square error after 0.25 s: {cold_uNm2 * 1e-6:.2g} Nm2 cold, "
        f"{warm_uNm2 * 1e-6:.2g} Nm2 restored; a dead interrupt and a spoilt block were caught"
    )


def check_spoilt(image: Path) -> None:
    """Run an image with a spoilt joint: one start that says so, no reset, no torque."""
    text = emulator.run(image, exit_code=_exit_corrupt_joint)
    _expect(text.count(_fault + "\n") == 1, f"{image.name} says once what is wrong:\n{text}")
    ((head, rows),) = _starts(text.replace(_fault + "\n", ""))
    _expect(head["start"] == "1" and head["watchdog_bites"] == "0", f"{image.name}: {head}")
    _expect([row["samples"] for row in rows] == [2000, 4000], f"{image.name} lives on:\n{text}")
    for row in rows:
        _expect(row["intact"] == 0, f"{image.name} calls its joint intact")
        _expect(row["torque_mNm"] == row["measured_mNm"] == 0, f"{image.name}: torque in {row}")
