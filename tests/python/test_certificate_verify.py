"""`strainwave verify`: every changed value is refused, layout is not, and a changed certificate neither."""

import re
import tomllib
from datetime import UTC, date, datetime
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from helpers.certified import write_certificate
from helpers.elbow import GEAR, TEXT
from strainwave.certificate.verifying import verify_certificate
from strainwave.errors import InputError
from strainwave.joint import Provenance, read_joint, write_joint

DAY = date(2026, 12, 24)
LATER = Provenance(
    input="again.csv",
    created=datetime(2027, 1, 2, 3, 4, 5, tzinfo=UTC),
    version="0.3.0",
)
#: The text of the file with a history, so that its digits are tried too.
WITH_HISTORY = (
    TEXT
    + f"""
[[history]]
section = "gear"
change = "replaced"
changed_at = 2026-11-05T10:00:00Z
input = "entered by hand"
version = "0.1.0"
previous_input = "preset 7"
previous_created = 2026-11-01T08:00:00Z
previous_sha256 = "{"0123456789abcdef" * 4}"
"""
)


def digits_outside_comments(text: str) -> list[int]:
    places, start = [], 0
    for line in text.splitlines(keepends=True):
        code = line if line.count('"') % 2 else re.sub(r'#[^"]*$', "", line)
        places += [start + match.start() for match in re.finditer(r"\d", code)]
        start += len(line)
    return places


def says(text: str) -> dict[str, object] | None:
    try:
        return tomllib.loads(text)
    except ValueError:
        return None


PLACES = digits_outside_comments(WITH_HISTORY)


@pytest.fixture(scope="module")
def certified(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("certified")
    write_certificate(folder, WITH_HISTORY)
    return folder


def test_the_certified_file_is_verified(certified: Path) -> None:
    block = verify_certificate(certified / "joint.toml", certified / "certificate.html", on=DAY)
    assert block["joint"]["serial"] == "HD-25-0117"


@settings(
    max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(place=st.sampled_from(PLACES), digit=st.sampled_from("0123456789"))
def test_any_changed_digit_is_refused(certified: Path, place: int, digit: str) -> None:
    changed = WITH_HISTORY[:place] + digit + WITH_HISTORY[place + 1 :]
    path = certified / "changed.toml"
    path.write_text(changed, "utf-8")
    # The last of seventeen digits may leave the number what it was; nothing else may.
    if says(changed) == says(WITH_HISTORY):
        verify_certificate(path, certified / "certificate.html", on=DAY)
        return
    with pytest.raises(InputError, match=r"changed.toml"):
        verify_certificate(path, certified / "certificate.html", on=DAY)


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    line=st.integers(0, WITH_HISTORY.count("\n")),
    text=st.sampled_from(["\n", "# a remark 123\n", "   \n", "\t# another\n"]),
)
def test_comments_and_blank_lines_are_not(certified: Path, line: int, text: str) -> None:
    lines = WITH_HISTORY.splitlines(keepends=True)
    changed = "".join(lines[:line]) + text + "".join(lines[line:])
    notes = WITH_HISTORY.index('notes = """')
    inside = notes < len("".join(lines[:line])) <= WITH_HISTORY.index('"""', notes + 12)
    if inside or "[\n" in lines[max(0, line - 1)]:
        return
    path = certified / "remarked.toml"
    path.write_text(changed, "utf-8")
    verify_certificate(path, certified / "certificate.html", on=DAY)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("gain_Nm_per_V = 6.6\n", "gain_Nm_per_V   =   6.60 # the same\n"),
        ("rated_torque_Nm = 100 ", "rated_torque_Nm = 1e2 "),
        ("created = 2026-11-02T14:05:00+01:00", "created = 2026-11-02T13:05:00Z"),
    ],
)
def test_the_same_value_written_otherwise_is_the_same(certified: Path, old: str, new: str) -> None:
    assert old in WITH_HISTORY
    path = certified / "otherwise.toml"
    path.write_text(WITH_HISTORY.replace(old, new), "utf-8")
    verify_certificate(path, certified / "certificate.html", on=DAY)


def test_the_refusal_says_what_differs_and_what_the_history_tells(tmp_path: Path) -> None:
    certificate = write_certificate(tmp_path)
    path = tmp_path / "joint.toml"
    joint_file = read_joint(path)
    joint_file.set_section("gear", GEAR, LATER)
    joint_file.remove_section("temperature", LATER)
    write_joint(joint_file, path)
    with pytest.raises(InputError) as refused:
        verify_certificate(path, certificate, on=DAY)
    message = str(refused.value)
    assert "[gear] was changed, [temperature] was removed" in message
    assert "its history says [gear] replaced at 2027-01-02 03:04 UTC from again.csv" in message
    assert "issued on 2026-12-01T12:00:00Z" in message
    path.write_text(TEXT.replace("gain_Nm_per_V = 6.6\n", "gain_Nm_per_V = 6.7\n"), "utf-8")
    with pytest.raises(InputError, match=r"\[torque_calibration\] was changed; its history says n"):
        verify_certificate(path, certificate, on=DAY)


def test_another_serial_number_is_said_first(certified: Path) -> None:
    path = certified / "other.toml"
    path.write_text(WITH_HISTORY.replace("HD-25-0117", "HD-25-0118"), "utf-8")
    with pytest.raises(InputError, match=r"serial number HD-25-0118, but .* is for HD-25-0117"):
        verify_certificate(path, certified / "certificate.html", on=DAY)


def test_a_certificate_past_its_validity_is_refused(certified: Path) -> None:
    joint, certificate = certified / "joint.toml", certified / "certificate.html"
    verify_certificate(joint, certificate, on=date(2027, 11, 30))
    with pytest.raises(InputError, match="valid until 2027-11-30, and the day is 2027-12-01"):
        verify_certificate(joint, certificate, on=date(2027, 12, 1))


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_changed_character_of_the_certificate_is_refused(
    certified: Path, data: st.DataObject
) -> None:
    text = (certified / "certificate.html").read_text("utf-8")
    place = data.draw(st.sampled_from([m.start() for m in re.finditer(r"\d", text)][::7]))
    digit = data.draw(st.sampled_from("0123456789"))
    if digit == text[place]:
        return
    path = certified / "edited.html"
    path.write_text(text[:place] + digit + text[place + 1 :], "utf-8")
    with pytest.raises(InputError, match=r"edited.html"):
        verify_certificate(certified / "joint.toml", path, on=DAY)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"<html></html>", "holds no certificate blocks"),
        (b"%PDF-1.7 \xff\xfe", "give the HTML and not the PDF"),
        (
            b'<script type="application/json" id="strainwave-certificate">[1]</script>',
            "not as strainwave writes it",
        ),
        (
            b'<script type="application/json" id="strainwave-certificate">{</script>',
            "not as strainwave writes it",
        ),
    ],
)
def test_what_is_no_certificate_is_refused(certified: Path, content: bytes, message: str) -> None:
    path = certified / "none.html"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        verify_certificate(certified / "joint.toml", path, on=DAY)
    with pytest.raises(InputError, match="cannot be read"):
        verify_certificate(certified / "joint.toml", certified / "absent.html", on=DAY)


def test_line_ends_of_mail_do_no_harm(certified: Path) -> None:
    path = certified / "mailed.html"
    text = (certified / "certificate.html").read_text("utf-8")
    path.write_bytes(text.replace("\n", "\r\n").encode())
    verify_certificate(certified / "joint.toml", path, on=DAY)
