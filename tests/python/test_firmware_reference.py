"""The firmware's documentation against what was measured, and the tools that measure."""

import json
import re
from pathlib import Path

import pytest

_root = Path(__file__).parents[2]
_columns = (
    "instructions",
    "dearest_sound_instructions",
    "worst_instructions",
    "cycles_estimated",
    "code_bytes",
    "state_bytes",
    "stack_bytes",
)


@pytest.fixture(autouse=True)
def _firmware_tools(monkeypatch):
    monkeypatch.syspath_prepend(str(_root / "firmware"))


def _results():
    from budgets import subjects  # noqa: PLC0415

    recorded = json.loads((_root / "firmware/results.json").read_text())
    return {subject: recorded[subject] for subject in subjects}


def test_the_table_holds_the_results():
    text = (_root / "docs/reference/firmware.md").read_text()
    table = text.split("<!-- table of firmware/results.json -->")[1].split("\n\n")[0]
    rows = re.findall(r"^\| `(\w+)` \| (.+) \|$", table, re.MULTILINE)
    shown = {name: [float(cell) for cell in cells.split("|")] for name, cells in rows}
    # The table shows as many digits as %g does.
    measured = {
        name: [float(f"{figures[column]:g}") for column in _columns]
        for name, figures in _results().items()
    }
    assert shown == measured


def test_every_subject_is_on_record_with_its_figures():
    names = (
        "published_4",
        "published_6",
        "default_3_orders",
        "default_3_orders_load_speed",
        "chain_4_gauges",
    )
    results = _results()
    assert tuple(results) == names
    assert all(set(_columns) <= results[name].keys() for name in names)


def test_the_default_filter_fits_a_kilobyte():
    assert 100 < _results()["default_3_orders"]["state_bytes"] <= 1024


@pytest.mark.parametrize(
    ("instruction", "branched", "cycles"),
    [
        ("vfma.f32\ts0, s1, s2", False, 3),
        ("vmul.f32\ts0, s1, s2", False, 1),
        ("vdiv.f32\ts0, s1, s2", False, 14),
        ("vldr\ts0, [r0, #4]", False, 2),
        ("vpush\t{d8-d15}", False, 17),
        ("vldmia\tr0!, {s14}", False, 2),
        ("ldmia.w\tr3, {r0, r1, r2, r3}", False, 5),
        ("pop\t{r4, r5, pc}", True, 7),
        ("ldrd\tr0, r1, [r2]", False, 3),
        ("strne.w\tr2, [ip]", False, 2),
        ("udiv\tr0, r1, r2", False, 12),
        ("mls\tr0, r1, r2, r3", False, 2),
        ("bne.w\t374 <sample_path+0x334>", True, 4),
        ("bne.w\t374 <sample_path+0x334>", False, 1),
        ("adds\tr0, #1", False, 1),
    ],
)
def test_cycles_of_an_instruction(instruction, branched, cycles):
    from cycles import cycles_of  # noqa: PLC0415

    assert cycles_of(instruction, branched) == cycles


def test_what_has_become_dearer_is_named():
    from budgets import grown  # noqa: PLC0415

    before = {"a": {"instructions": 100.0}, "b": {"instructions": 100.0}}
    after = {"a": {"instructions": 102.0}, "b": {"instructions": 103.0}}
    assert grown(before, after) == ["b: instructions was 100 and is 103"]
    assert grown(before, {"a": {"instructions": 50.0}}) == []
