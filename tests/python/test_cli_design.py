"""`strainwave design layout`: what it prints, draws and refuses, and few against many gauges."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from helpers.log_files import command
from strainwave.design.case import LayoutCase
from strainwave.design.comparison import CAREFUL, CARELESS, Care, compare_gauge_counts
from strainwave.design.layout import study_layout
from strainwave.design.placement import Tolerances, Wave
from strainwave.errors import InputError
from strainwave.report.figures_layout import layout_figure
from strainwave.report.style import svg

LAYOUT = ("design", "layout", "--gauges", "3", "--harmonics", "1")
SCATTER = ("--position-tolerance-deg", "10", "--trials", "20000")
Call = Any


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def test_json_has_the_keys_of_the_reference(call: Call) -> None:
    ended = call(*LAYOUT, *SCATTER, "--json")
    assert (ended.code, ended.err) == (0, "")
    result = ended.result
    for name in ("residual_FS", "noise_factor"):
        assert list(result[name]) == ["5", "50", "95"]
    assert (result["gauges"], result["harmonics"], result["trials"]) == (3, 1, 20_000)
    assert (result["limit_FS"], result["seed"]) == (0.5, 1)
    assert result["negative_gain_share"] == pytest.approx(0.05, abs=0.012)
    assert result["noise_factor"]["95"] == pytest.approx(1.5, abs=0.03)
    assert 0 < result["yield"] < 0.2
    assert 0 < result["yield_standard_error"] < 0.01
    assert result["lost_gauge"] is None
    assert result["comparison"] is None
    assert result["quantise"] is None
    assert set(result["parts_FS"]) == {"above_N", "up_to_N_solved", "up_to_N"}
    assert len(result["sensitivities"]) == 6
    assert result["warnings"] == []
    reference = Path(__file__).parents[2] / "docs/reference/design-layout-command.md"
    documented = reference.read_text(encoding="utf-8")
    for name in result:
        assert f"`{name}`" in documented, name


def test_the_command_studies_what_it_was_told(call: Call) -> None:
    ended = call(
        "design", "layout", "--gauges", "5", "--harmonics", "2",
        "--position-tolerance-deg", "3", "--amplitude-tolerance", "0.1",
        "--phase-tolerance-deg", "4", "--gauge-factor-tolerance", "0.02",
        "--radial-tolerance-mm", "0.3", "--angular-tolerance-deg", "2",
        "--radius-mm", "30", "--wave-FS", "40,3,0.2", "--normal-strain-ratio", "0.5",
        "--wave-radius-exponent", "0", "--measurement-error-FS", "0.02", "--most-noise", "5",
        "--lost-gauge", "--limit-FS", "0.7", "--trials", "3e3", "--seed", "9", "--json",
    )  # fmt: skip
    case = LayoutCase(
        5,
        2,
        Tolerances(3.0, 0.1, 4.0, 0.02, 0.3, 2.0),
        Wave((40.0, 3.0, 0.2), 0.5, 0.0),
        radius_mm=30.0,
        measurement_error_FS=0.02,
        most_noise=5.0,
        lost_gauge=True,
    )
    study = study_layout(case, 0.7, 3000, 9)
    result = ended.result
    assert list(result["residual_FS"].values()) == list(study.tuned.residual_FS.values())
    assert result["yield"] == study.tuned.met_limit
    assert study.lost_tuned is not None
    assert result["lost_gauge"]["yield"] == study.lost_tuned.met_limit
    assert result["untuned"]["yield"] == study.untuned.met_limit
    assert result["wave_FS"] == [40.0, 3.0, 0.2]


def test_the_yield_is_printed_first_and_what_was_refused(call: Call) -> None:
    ended = call(*LAYOUT, "--position-tolerance-deg", "22.5", "--trials", "2000")
    assert (ended.code, ended.err) == (0, "")
    first = ended.out.splitlines()[0]
    assert first.startswith("3 gauges, 1 harmonic(s) cancelled: 2000 layouts, yield ")
    words = " ".join(ended.out.split())
    assert re.search(r"Refused: 1[0-9]\.\d\d% of the layouts", words)
    assert "they count as failed" in words
    assert "Godler et al. 2000" in words
    for error in ("radial", "circumferential", "angular"):
        assert error in words


def test_quantised_gains_leave_more(call: Call) -> None:
    exact = call(*LAYOUT, *SCATTER, "--json").result
    coarse = call(*LAYOUT, *SCATTER, "--quantise", "e24", "--json").result
    assert coarse["quantise"] == "E24"
    assert coarse["parts_FS"]["up_to_N"]["50"] > 20 * exact["parts_FS"]["up_to_N"]["50"]
    assert coarse["parts_FS"]["up_to_N_solved"] == exact["parts_FS"]["up_to_N_solved"]


def test_the_comparison_is_printed_and_drawn(call: Call, tmp_path: Path) -> None:
    out = tmp_path / "layout.svg"
    ended = call(*LAYOUT, "--trials", "500", "--compare", "--out", out)
    assert (ended.code, ended.err) == (0, "")
    assert "3 careless gauges or 8 careful ones?" in ended.out
    assert f"figure: {out}" in ended.out
    assert ET.parse(out).getroot().tag.endswith("svg")
    result = call(*LAYOUT, "--trials", "500", "--compare", "--json").result["comparison"]
    assert result["question"] == "3 careless gauges or 8 careful ones?"
    assert len(result["answers"]) == 4
    for name in ("careless", "careful"):
        assert [each["gauges"] for each in result[name]["layouts"]] == list(range(2, 10))


@pytest.mark.parametrize(("ending", "start"), [("pdf", b"%PDF"), ("png", b"\x89PNG")])
def test_the_figure_is_of_the_kind_that_its_name_says(
    call: Call, tmp_path: Path, ending: str, start: bytes
) -> None:
    out = tmp_path / f"layout.{ending}"
    assert call(*LAYOUT, "--trials", "100", "--out", out).code == 0
    assert out.read_bytes().startswith(start)


def test_more_care_more_gauges_and_tuning_help() -> None:
    found = compare_gauge_counts(LayoutCase(3, 2), 0.5, trials=2000)
    for few, many in zip(found.careless_studies, found.careful_studies, strict=True):
        for name in ("tuned", "untuned"):
            careless, careful = getattr(few, name), getattr(many, name)
            assert careful.residual_FS[95] < careless.residual_FS[95]
            assert careful.met_limit >= careless.met_limit
        assert few.tuned.residual_FS[95] < few.untuned.residual_FS[95]
    for studies in (found.careless_studies, found.careful_studies):
        # From three gauges on; two leave the second harmonic, which looks like torque to them.
        untuned = [study.untuned.residual_FS[95] for study in studies][1:]
        assert untuned == sorted(untuned, reverse=True)
        assert [study.case.harmonics for study in studies] == [1, 1, 1, 2, 2, 2, 2, 2]


def test_the_answer_has_the_numbers_of_the_studies() -> None:
    found = compare_gauge_counts(LayoutCase(4, 2), 0.5, many=6, trials=2000)
    few = found.careless_studies[2]
    many = found.careful_studies[4]
    assert found.question == "4 careless gauges or 6 careful ones?"
    untuned, tuned, mixed, replacement = found.answers
    left = (few.untuned.residual_FS[95], many.untuned.residual_FS[95])
    assert untuned == (
        f"Equal gains: {left[0]:.2g} against {left[1]:.2g} %FS, 6 careful leave "
        f"{left[0] / left[1]:.2g} times less"
    )
    assert f"{few.tuned.residual_FS[95]:.2g} against {many.tuned.residual_FS[95]:.2g}" in tuned
    assert f"{few.tuned.residual_FS[95]:.2g} against {left[1]:.2g}" in mixed
    enough = int(replacement.split()[0])
    by_count = {study.case.gauges: study.tuned.residual_FS[95] for study in found.careless_studies}
    assert by_count[enough] <= left[1] < by_count[enough - 1]


def test_the_answer_can_turn_round() -> None:
    # Gauges of the same care: fewer can be no better, and are about as good as as many.
    same = compare_gauge_counts(
        LayoutCase(8, 1), 0.5, careless=CAREFUL, careful=CAREFUL, trials=500
    )
    assert "about the same" in same.answers[0]
    turned = compare_gauge_counts(
        LayoutCase(8, 1), 0.5, careless=CAREFUL, careful=CARELESS, many=3, trials=500
    )
    assert "8 careless leave" in turned.answers[0]
    assert turned.verdict == "8 careless, tuned or not"
    assert same.verdict == "either, tuned or not"
    hopeless = compare_gauge_counts(
        LayoutCase(3, 1), 0.5, careless=Care(40.0, 0.5), careful=Care(0.01, 0.0001), trials=500
    )
    assert hopeless.answers[3].startswith("No number of careless ones")


def test_the_figure_is_the_same_for_the_same_data() -> None:
    found = compare_gauge_counts(LayoutCase(3, 1), 0.5, trials=300)
    first, again = (svg(layout_figure(found)) for _ in range(2))
    assert first == again
    figure = layout_figure(found)
    upper, lower = figure.axes
    assert figure.get_suptitle() == "3 careless gauges or 8 careful ones? 8 careful, tuned or not"
    texts = [text.get_text() for text in lower.texts]
    for studies in (found.careless_studies, found.careful_studies):
        share = studies[-1].tuned.met_limit
        if 0.005 < share < 0.995:
            assert f"{100 * share:.0f} %" in texts
    assert upper.get_title(loc="left") == found.answers[0]
    assert found.answers[1] in lower.get_title(loc="left")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--gauges", "10", "--harmonics", "1"), "gauges = 10: expected a whole number from 2"),
        (("--gauges", "3.5", "--harmonics", "1"), "--gauges 3.5: expected a whole number"),
        (("--gauges", "inf", "--harmonics", "1"), "--gauges inf: expected a whole number"),
        (("--gauges", "three", "--harmonics", "1"), "--gauges three: expected a whole number"),
        (("--gauges", "3"), "--harmonics"),
        ((*LAYOUT[2:], "--position-tolerance-deg", "-1"), "position_tolerance_deg = -1.0 deg"),
        ((*LAYOUT[2:], "--amplitude-tolerance", "15"), "amplitude_tolerance = 15.0"),
        ((*LAYOUT[2:], "--gauge-factor-tolerance", "nan"), "gauge_factor_tolerance = nan"),
        ((*LAYOUT[2:], "--trials", "0"), "trials = 0: expected a whole number from 1"),
        ((*LAYOUT[2:], "--limit-FS", "0"), "limit_FS = 0.0 %FS"),
        ((*LAYOUT[2:], "--wave-FS", "1;2"), "wave_FS = '1;2': expected amplitudes in %FS"),
        ((*LAYOUT[2:], "--wave-FS", ""), "wave_FS = ''"),
        ((*LAYOUT[2:], "--quantise", "E48"), "--quantise E48: expected potentiometer:256, "),
        ((*LAYOUT[2:], "--careless", "5"), "careless = '5': expected a position tolerance"),
        ((*LAYOUT[2:], "--careful", "0.5,-1"), "careful: amplitude tolerance = -1.0"),
        ((*LAYOUT[2:], "--compare", "--careful-gauges", "12"), "careful_gauges = 12"),
        ((*LAYOUT[2:], "--most-noise", "0"), "most_noise = 0.0: expected at least 1"),
        ((*LAYOUT[2:], "--seed", "-1"), "seed = -1"),
        (
            (*LAYOUT[2:], "--out", "figure.gif"),
            "--out figure.gif: the name ends in '.gif'; expected .svg or .pdf or .png",
        ),
        (
            (*LAYOUT[2:], "--out", "nowhere/f.svg"),
            "nowhere/f.svg: it cannot be written (no such file or directory)",
        ),
    ],
)
def test_bad_input_is_one_sentence(
    call: Call, arguments: tuple[str, ...], words: str, tmp_path: Path
) -> None:
    ended = call("design", "layout", *arguments)
    assert (ended.code, ended.out) == (2, "")
    assert words in ended.err
    assert "Traceback" not in ended.err
    assert ended.err.startswith("strainwave: ")
    assert not list(tmp_path.iterdir())


def test_care_that_cannot_be() -> None:
    with pytest.raises(InputError, match="a position tolerance in degrees"):
        Care.of_text("careless", "5,0.1,2")
