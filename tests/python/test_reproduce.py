"""Both papers' numbers from the simulated stations, and the page that shows them."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from strainwave.report.demo import STEPS, DemoReport, write_demo
from strainwave.reproduce import godler2000, godler2000_comparison, taghirad1999
from strainwave.reproduce.comparison import Comparison, within
from strainwave.reproduce.overview import overview
from strainwave.reproduce.tuning import FOUR_STATES, FOUR_STATES_SLOW, SIX_STATES, tuning_study


@pytest.fixture(scope="module")
def taghirad() -> taghirad1999.Taghirad1999:
    return taghirad1999.run()


@pytest.fixture(scope="module")
def godler() -> godler2000.Godler2000:
    return godler2000.run()


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> DemoReport:
    return write_demo(tmp_path_factory.mktemp("demo"))


def test_every_published_number_is_within_its_band(
    taghirad: taghirad1999.Taghirad1999, godler: godler2000.Godler2000
) -> None:
    entries = [
        entry
        for group in (
            *taghirad1999.comparisons(taghirad).values(),
            *godler2000_comparison.comparisons(godler).values(),
        )
        for entry in group
    ]
    assert len(entries) >= 25
    missed = [entry for entry in entries if not entry.reproduced]
    assert missed == []


def test_peaks_lie_at_the_meshs_orders(taghirad: taghirad1999.Taghirad1999) -> None:
    # Circular spline fixed, R = 100: 2 (R+1)/R and 4 (R+1)/R times the speed of that interval.
    spectrum = taghirad.spectrum
    for order, peak in zip((2.02, 4.04), spectrum.peaks_rad_s, strict=True):
        assert peak == pytest.approx(order * spectrum.speed_rad_s, rel=0.005)


def test_no_sample_of_the_clean_stations_is_rejected(
    taghirad: taghirad1999.Taghirad1999,
) -> None:
    assert [each.rejected for each in (*taghirad.ripple, *taghirad.misalignment)] == [0] * 4


def test_published_filter_removes_ripple_where_the_torque_is_expected(
    taghirad: taghirad1999.Taghirad1999,
) -> None:
    for experiment in taghirad.ripple:
        assert experiment.ripple_rms_Nm() > 1.0
        assert 0.01 < experiment.left_rms_Nm() < 0.2
        assert 0.01 < experiment.error_rms_Nm() < 0.25
    for experiment in taghirad.misalignment:
        # 10 Nm peak to peak of misalignment is 3.5 Nm rms.
        assert 3.0 < experiment.raw_error_rms_Nm() < 4.5
        assert 0.01 < experiment.error_rms_Nm() < 0.25


def test_gains_of_run_and_paper_agree(godler: godler2000.Godler2000) -> None:
    assert godler.compensation.from_run.gains == pytest.approx(
        godler.compensation.from_paper.gains, abs=5e-4
    )


def test_three_vectors_close_and_two_do_not(godler: godler2000.Godler2000) -> None:
    closed = np.sum([[v.sine, v.cosine] for v in godler.vectors_three], axis=0)
    assert closed == pytest.approx([0.0, 0.0], abs=1e-9)
    opened = np.hypot(*np.sum([[v.sine, v.cosine] for v in godler.vectors_two], axis=0))
    # Two nearly opposite vectors of angle error 1.5 degrees.
    assert 0.02 < opened < 0.04


def test_null_space_starts_at_the_minimum_number_of_gauges(godler: godler2000.Godler2000) -> None:
    assert [(c.gauges, c.harmonics, c.solutions) for c in godler.gauge_counts] == [
        (2, 1, 0),
        (3, 1, 1),
        (4, 2, 0),
        (5, 2, 1),
        (6, 3, 0),
        (7, 3, 1),
    ]


def test_tuning_study_says_what_the_theory_says() -> None:
    study = tuning_study()
    at_1_Hz = {
        name: float(
            np.interp(
                1.0,
                study.by_name(name).pass_through.frequency_Hz,
                study.by_name(name).pass_through.gain_dB,
            )
        )
        for name in (FOUR_STATES, SIX_STATES, FOUR_STATES_SLOW)
    }
    assert at_1_Hz[FOUR_STATES] == pytest.approx(-5.5, abs=0.1)
    assert at_1_Hz[SIX_STATES] == pytest.approx(-37.0, abs=0.6)
    assert at_1_Hz[FOUR_STATES_SLOW] == pytest.approx(-17.0, abs=0.2)


def test_overview_keeps_the_contact_and_removes_the_ripple() -> None:
    result = overview()
    assert -45 < result.ripple_dB < -20
    assert abs(result.contact_error_percent) < 3


def test_comparison_can_be_missed_on_both_sides() -> None:
    def compare(ours: float) -> Comparison:
        return within("T", "x", "2", ours, unit="%", expected=2.0, tolerance=0.1)

    assert [compare(x).reproduced for x in (1.79, 1.81, 2.19, 2.21)] == [False, True, True, False]
    assert not compare(float("nan")).reproduced


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.images: list[dict[str, str | None]] = []
        self.anchors: set[str] = set()
        self.links: set[str] = set()
        self.outside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        if tag == "img":
            self.images.append(values)
        if values.get("id"):
            self.anchors.add(str(values["id"]))
        if tag == "a":
            self.links.add(str(values.get("href")))
        for name in ("src", "href"):
            target = values.get(name) or ""
            if target and not target.startswith(("data:", "#")):
                self.outside.append(target)


def test_report_is_self_contained_and_complete(demo: DemoReport) -> None:
    text = demo.page.read_text(encoding="utf-8")
    page = _Page()
    page.feed(text)
    assert page.outside == []
    assert {link.removeprefix("#") for link in page.links} <= page.anchors
    assert len(page.images) == 13
    assert all(image.get("alt") for image in page.images)
    for words in ("Table I", "figure 7", "Figure 8", "Figure 9", "Figure 10", "Figure 11"):
        assert words in text
    for words in ("Figure 3", "Figure 6", "Figures 4, 7 and 11", "2N + 1", "swallows true torque"):
        assert words in text
    assert text.count("Simulated") >= 10
    assert not re.search(r"\bnan\b", re.sub(r"data:[^\"]*", "", text))


def test_same_command_gives_the_same_page(demo: DemoReport, tmp_path: Path) -> None:
    steps: list[str] = []
    again = write_demo(tmp_path, on_step=steps.append)
    assert again.page.read_bytes() == demo.page.read_bytes()
    assert again.picture.read_bytes() == demo.picture.read_bytes()
    assert tuple(steps) == STEPS


def test_comparisons_are_plain_values(demo: DemoReport) -> None:
    text = json.dumps([entry.as_dict() for entry in demo.comparisons], allow_nan=False)
    assert "sensor gain" in text
