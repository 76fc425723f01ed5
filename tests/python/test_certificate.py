"""What a certificate says: the joint file's numbers, judged against stated limits."""

import json
import math
import re
import sys
import tomllib
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from helpers.certified import SESSION, certificate_of, session_of, write_certificate
from helpers.elbow import TEXT
from strainwave.certificate.judging import judgements
from strainwave.certificate.sealing import read_block
from strainwave.certificate.session import read_session, session_template
from strainwave.errors import InputError
from strainwave.joint import canonical_hash, parse_joint
from strainwave.records.checks import check_output
from strainwave.report.certificate import certificate_figures, certificate_page, judged_text
from strainwave.report.certificate_pdf import certificate_images, certificate_pdf
from strainwave.report.figure_file import write_figure


class Cells(HTMLParser):
    """Collects the text of the cells that name a key of the joint file."""

    def __init__(self) -> None:
        super().__init__()
        self.values: dict[str, str] = {}
        self._key: str | None = None

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "td":
            self._key = dict(attrs).get("data-key")

    def handle_data(self, data: str) -> None:
        if self._key is not None:
            self.values[self._key] = self.values.get(self._key, "") + data


def value_at(values: Any, key: str) -> Any:
    for name, position in re.findall(r"([A-Za-z_]\w*)(?:\[(\d+)\])?", key):
        values = values[name]
        if position:
            values = values[int(position) - 1]
    return values


def numbers_of(values: Any) -> list[float]:
    """Every number of a parsed TOML table; lists of numbers in their order."""
    if isinstance(values, dict):
        return [n for key, item in values.items() if key != "provenance" for n in numbers_of(item)]
    if isinstance(values, list):
        return [number for item in values for number in numbers_of(item)]
    return [values] if isinstance(values, int | float) else []


def test_numbers_of_the_page_are_those_of_the_joint_file(tmp_path: Path) -> None:
    cells = Cells()
    cells.feed(write_certificate(tmp_path).read_text("utf-8"))
    written = tomllib.loads(TEXT)
    compared = 0
    for key, text in cells.values.items():
        numbers = [float(part) for part in text.split(", ")]
        try:
            expected = value_at(written, key)
        except KeyError:
            continue  # a default that the file leaves out
        assert numbers == (expected if isinstance(expected, list) else [expected]), key
        compared += len(numbers)
    # Nothing is left out, but for the columns of recordings and one text among the orders.
    told = sum(
        len(numbers_of(table))
        for name, table in written.items()
        if name not in ("joint", "signals")
    )
    orders = len(numbers_of(written["ripple_filter"]["orders"]))
    assert compared == told - 1 - orders  # without schema_version and the orders, which hold a text


def test_the_block_holds_hashes_inputs_and_results(tmp_path: Path) -> None:
    block = read_block(write_certificate(tmp_path))
    joint = parse_joint(TEXT).joint
    assert block["joint"]["sha256"] == canonical_hash(joint)
    assert joint.torque_calibration is not None
    assert joint.torque_calibration.provenance is not None
    assert {
        "role": "[torque_calibration]",
        "name": "arm-and-weight.csv",
        "sha256": joint.torque_calibration.provenance.input_sha256,
    } in block["inputs"]
    gain = next(r for r in block["results"] if r["key"] == "torque_calibration.gain_Nm_per_V")
    assert (gain["values"], gain["standard_uncertainties"], gain["unit"]) == (
        [6.6],
        [0.047],
        "Nm/V",
    )
    assert block["software"] == {"name": "strainwave", "version": "0.2.0"}
    assert block["session"]["operator"] == "A. Example"


def test_verdicts_against_limits(tmp_path: Path) -> None:
    block = certificate_of(tmp_path).block
    found = {each["quantity"]: each for each in block["judgements"]}
    assert {name: each["verdict"] for name, each in found.items()} == {
        "linearity_error_percent_of_rated_torque": "pass",
        "hysteresis_percent_of_rated_torque": "fail",
        "consistency": "pass",
        "zero_drift_percent_of_rated_torque_per_K": "pass",
    }
    assert block["verdict"] == "fail"
    # 0.3 mV/K times 6.6 Nm/V of 100 Nm.
    drift = found["zero_drift_percent_of_rated_torque_per_K"]["value"]
    assert drift == pytest.approx(0.0003 * 6.6, rel=1e-12)
    # GUM E.4.3: a standard deviation of eight is known to 1 / sqrt(14) of itself.
    expanded = found["consistency"]["expanded_uncertainty"]
    assert expanded == pytest.approx(2 * 0.02 / math.sqrt(14), rel=1e-12)


@pytest.mark.parametrize(
    ("limit", "rule", "verdict"),
    [
        (0.02, "simple", "pass"),
        (0.0199, "simple", "fail"),
        (0.03, "guarded", "fail"),
        (0.0308, "guarded", "pass"),
    ],
)
def test_the_rule_of_decision(tmp_path: Path, limit: float, rule: str, verdict: str) -> None:
    text = SESSION.replace("consistency = 0.03", f"consistency = {limit}")
    session = session_of(tmp_path, f'decision_rule = "{rule}"\n{text}')
    judged = {each.quantity: each for each in judgements(parse_joint(TEXT).joint, session, None)}
    assert judged["consistency"].verdict == verdict
    linear = judged["linearity_error_percent_of_rated_torque"].verdict
    assert linear == ("pass" if rule == "simple" else "not decided")


def test_what_is_not_known_does_not_pass(tmp_path: Path) -> None:
    start, end = TEXT.index("[temperature]"), len(TEXT)
    text = TEXT[:start]
    assert end > start
    session = SESSION.replace("percent_of_rated_torque = 0.4", "percent_of_rated_torque = 4")
    block = certificate_of(tmp_path, text, session).block
    assert block["judgements"][-1]["verdict"] == "not known"
    assert "value" not in block["judgements"][-1]
    assert block["verdict"] == "incomplete"
    page = write_certificate(tmp_path, text, session).read_text("utf-8")
    assert "INCOMPLETE" in page
    no_limits = session[: session.index("[limits]")] + "[limits]\n"
    assert certificate_of(tmp_path, text, no_limits).block["verdict"] == "no limits stated"


def test_an_instrument_out_of_its_own_calibration_fails(tmp_path: Path) -> None:
    session = SESSION.replace("2027-04-30", "2026-11-19").replace("torque = 0.4", "torque = 4")
    block = certificate_of(tmp_path, session=session).block
    assert [each["verdict"] for each in block["checks"]] == ["fail"]
    assert block["verdict"] == "fail"
    page = write_certificate(tmp_path, session=session).read_text("utf-8")
    assert "calibrated until 2026-11-19, before 2026-11-20" in page


def test_failing_values_stand_out_by_a_word_too(tmp_path: Path) -> None:
    page = write_certificate(tmp_path).read_text("utf-8")
    rows = re.findall(r'<tr class="fails">(.*?)</tr>', page)
    assert len(rows) == 1
    assert "FAIL" in rows[0]
    assert "Hysteresis" in rows[0]
    assert "FAIL: Hysteresis" in page
    assert "Bench &lt;1&gt; &amp; more" in page


def test_simulated_is_called_simulated(tmp_path: Path) -> None:
    # The misalignment of this joint comes from a simulation, whatever the session says.
    certificate = certificate_of(tmp_path)
    assert certificate.block["data"] == "simulated"
    assert certificate.block["simulated_sections"] == ["misalignment"]
    figures = certificate_figures(certificate)
    assert "SIMULATED" in certificate_page(certificate, figures)
    assert all("Simulated" in each.caption for each in figures)
    measured = TEXT.replace("simulated free motion", "free motion")
    assert certificate_of(tmp_path, measured).block["data"] == "measured"
    told = SESSION.replace('"measured"', '"simulated"')
    assert certificate_of(tmp_path, measured, told).block["data"] == "simulated"


def test_the_document_is_the_same_to_the_byte_and_has_pages(tmp_path: Path) -> None:
    certificate = certificate_of(tmp_path)
    figures = certificate_figures(certificate)
    first, second = (certificate_pdf(certificate, figures) for _ in range(2))
    assert first == second
    assert first.startswith(b"%PDF-")
    images = certificate_images(certificate, figures)
    assert len(images) >= 2
    assert all(image.startswith(b"\x89PNG") for image in images)
    assert certificate_page(certificate, figures) == certificate_page(certificate, figures)


def test_without_typst_the_page_is_still_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    certificate = certificate_of(tmp_path)
    monkeypatch.setitem(sys.modules, "typst", None)
    with pytest.raises(InputError, match=r"typst.*install strainwave\[pdf\]"):
        certificate_pdf(certificate, ())
    assert "FAIL: Hysteresis" in certificate_page(certificate, ())


def test_a_rounded_value_shows_its_side_of_the_limit() -> None:
    assert judged_text(0.28561, 1.0) == "0.2856"
    assert judged_text(1.0000001, 1.0) == "1.0000001"
    assert judged_text(1.0, 1.0) == "1"


def test_a_template_is_refused_until_it_is_filled_in(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"session.toml: .*expected.*certify --template"):
        session_of(tmp_path, session_template())
    tomllib.loads(session_template())


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('operator = "A. Example"', "", "operator.*(missing|lacks)"),
        ("valid_until = 2027-11-30", "valid_until = 2026-11-01", "before its date"),
        ("consistency = 0.03", "consistency = -1", r"\[limits\] consistency = -1"),
        ("consistency = 0.03", "konsistency = 1", 'did you mean "consistency"'),
        ('data = "measured"', 'data = "guessed"', '"measured" or "simulated"'),
        ("temperature_degC = 20.5", 'temperature_degC = "warm"', "expected a number"),
        ("date = 2026-11-20", 'date = "soon"', "date"),
        ("[environment]", "[environment", "not valid TOML"),
    ],
)
def test_bad_sessions_are_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        session_of(tmp_path, SESSION.replace(old, new))


def test_a_joint_without_serial_or_results_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has no serial"):
        certificate_of(tmp_path, TEXT.replace('serial = "HD-25-0117"\n', ""))
    with pytest.raises(InputError, match="no section with results"):
        certificate_of(tmp_path, 'schema_version = 1\n[joint]\nname = "a"\nserial = "1"\n')


def test_the_block_is_plain_json(tmp_path: Path) -> None:
    block = certificate_of(tmp_path).block
    assert json.loads(json.dumps(block, allow_nan=False)) == block


@pytest.mark.parametrize(
    ("line", "instead", "words"),
    [
        ('operator = ""', "", 'the key "operator" is missing (who calibrated); add it'),
        ('operator = ""', "operator = 5", "operator = 5: expected a text"),
        ('operator = ""', "operator = [5]", "operator = [5]: expected a text"),
    ],
)
def test_a_key_of_no_section_is_named_without_brackets(
    tmp_path: Path, line: str, instead: str, words: str
) -> None:
    path = tmp_path / "session.toml"
    template = session_template()
    assert template.count(line) == 1
    path.write_text(template.replace(line, instead))
    with pytest.raises(InputError) as caught:
        read_session(path)
    assert str(caught.value).startswith(f"{path}: {words}")


def test_no_figure_is_written_over_a_certificate(tmp_path: Path) -> None:
    certificate = certificate_of(tmp_path)
    issued, figure = tmp_path / "certificate.pdf", tmp_path / "figure.pdf"
    issued.write_bytes(certificate_pdf(certificate, certificate_figures(certificate)))
    with pytest.raises(InputError, match=r"--figure .*: it is an issued certificate"):
        check_output(issued, option="--figure", endings=(".pdf",))
    drawn = Figure()
    drawn.suptitle("Calibration")
    write_figure(drawn, figure)
    check_output(figure, option="--figure", endings=(".pdf",))
