"""The golden vectors: one set for host, Python and microcontroller."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import strainwave as sw
from benchmarks.golden import vectors
from benchmarks.golden.__main__ import main
from benchmarks.golden.chains import CHAINS, Answers
from benchmarks.golden.inputs import NAN_CODE, noise, samples_of, sine

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def golden():
    return vectors.read_golden()


@pytest.fixture(scope="module")
def samples(golden):
    return samples_of(golden["definition"], golden["definition"]["samples"])


@pytest.mark.parametrize("precision", ["double", "float"])
@pytest.mark.parametrize("name", CHAINS)
def test_answers_have_the_same_bits(golden, samples, name, precision):
    answers = CHAINS[name](golden["definition"], samples, vectors.PRECISIONS[precision])
    found = vectors.deviations(golden, name, answers)
    assert found["same_bits"]
    assert found["other_status"] == 0
    assert found[f"from_{precision}_FS"] == 0
    assert found["from_double_FS"] <= 1e-4
    if precision == "float":  # the comparison would see it if float were double in disguise
        assert found["from_double_FS"] >= 1e-8


def test_the_file_is_what_would_be_made_now(golden):
    assert vectors.golden_text(vectors.make_golden()) == vectors.GOLDEN.read_text()


def test_the_file_is_small():
    assert vectors.GOLDEN.stat().st_size < 1_000_000


@pytest.mark.parametrize(
    ("name", "flags"),
    [
        ("published_6", ["torque_not_finite", "rotation_invalid", "expected_torque_not_finite"]),
        ("default_3_orders", ["at_rest", "sample_out_of_order", "samples_missing"]),
        (
            "chain_4_gauges",
            [
                "gauge_saturated",
                "temperature_not_finite",
                "temperature_out_of_range",
                "sample_repeated",
                "sample_out_of_order",
                "samples_missing",
                "gauge_suspected",
                "gauge_lost",
                "gauges_insufficient",
                "at_rest",
            ],
        ),
    ],
)
def test_what_shall_go_wrong_goes_wrong(golden, samples, name, flags):
    status = CHAINS[name](golden["definition"], samples, np.float64).status
    for flag in flags:
        raised = np.count_nonzero(status & int(sw.StatusFlag[flag]))
        assert 0 < raised < status.size, flag


def test_the_ripple_is_removed_so_that_the_vectors_mean_something(golden, samples):
    definition = golden["definition"]
    load_Nm = np.repeat(definition["loads_Nm"], 2048)
    load_Nm = np.resize(load_Nm, definition["samples"]).astype(float)
    load_Nm += ((4096 * sine(np.arange(load_Nm.size) * 13)) >> 15) / 4096
    answers = CHAINS["default_3_orders"](definition, samples, np.float64)
    usable = (samples.torque != NAN_CODE) & (answers.status == 0)
    late = usable & (np.arange(load_Nm.size) > 50_000) & (np.arange(load_Nm.size) < 100_000)
    before = np.std((samples.torque / 4096 - load_Nm)[late])
    after = np.std((answers.torque_Nm - load_Nm)[late])
    assert 1.2 < before < 1.8
    assert 0.1 * before < after < 0.4 * before


def test_the_sine_of_whole_numbers_is_one():
    angle = np.arange(-70_000, 70_000)
    error = sine(angle) / 2**15 - np.sin(2 * np.pi * angle / 2**16)
    assert 1e-4 < np.max(np.abs(error)) < 2e-3


def test_the_noise_is_independent_and_about_normal():
    first, second = noise(100_000, 0), noise(100_000, 1)
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.01
    assert abs(np.corrcoef(first[1:], first[:-1])[0, 1]) < 0.01
    assert np.std(first) == pytest.approx(2 * np.sqrt((256**2 - 1) / 12), rel=0.01)


def test_a_changed_answer_is_seen(golden, samples):
    answers = CHAINS["published_4"](golden["definition"], samples, np.float32)
    changed = answers.torque_Nm.copy()
    changed[12_345] = np.nextafter(changed[12_345], np.float32(1e9))
    found = vectors.deviations(
        golden, "published_4", Answers(changed, answers.ripple_Nm, answers.status)
    )
    assert not found["same_bits"]


def written(path, golden, samples, spoil=lambda rows: rows):
    rows = [CHAINS[name](golden["definition"], samples, np.float32).records() for name in CHAINS]
    spoil(np.concatenate(rows)).tofile(path)


def compared(monkeypatch, path, *options):
    monkeypatch.setattr(sys, "argv", ["golden", "--compare", str(path), *options])
    return main()


def test_comparison_takes_the_hosts_own_answers(golden, samples, tmp_path, monkeypatch, capsys):
    written(tmp_path / "answers.bin", golden, samples)
    assert compared(monkeypatch, tmp_path / "answers.bin") == 0
    assert capsys.readouterr().out.count("same bits as") == len(CHAINS)


@pytest.mark.parametrize(("torque_Nm", "fused_passes"), [(1e-4, True), (1e-2, False)])
def test_comparison_refuses_other_bits(
    golden, samples, tmp_path, monkeypatch, capsys, torque_Nm, fused_passes
):
    def spoil(rows):
        rows["torque_Nm"][777] += torque_Nm
        return rows

    written(tmp_path / "answers.bin", golden, samples, spoil)
    assert compared(monkeypatch, tmp_path / "answers.bin") == 1
    assert "FAILED" in capsys.readouterr().out
    assert (
        compared(monkeypatch, tmp_path / "answers.bin", "--arithmetic", "fused") == 0
    ) == fused_passes


def test_comparison_reads_double(golden, samples, tmp_path, monkeypatch, capsys):
    rows = np.concatenate(
        [CHAINS[name](golden["definition"], samples, np.float64).records() for name in CHAINS]
    )
    padded = np.zeros(rows.size, [*rows.dtype.descr, ("padding", "<u4")])
    for name in rows.dtype.names:
        padded[name] = rows[name]
    padded.tofile(tmp_path / "answers.bin")
    assert compared(monkeypatch, tmp_path / "answers.bin", "--arithmetic", "double") == 0
    assert capsys.readouterr().out.count("same bits as the host's double") == len(CHAINS)


def test_comparison_refuses_another_status(golden, samples, tmp_path, monkeypatch):
    def spoil(rows):
        rows["status"][777] ^= 1
        return rows

    written(tmp_path / "answers.bin", golden, samples, spoil)
    assert compared(monkeypatch, tmp_path / "answers.bin", "--arithmetic", "fused") == 1


def test_comparison_says_when_the_image_stopped_early(tmp_path, monkeypatch, capsys):
    (tmp_path / "answers.bin").write_bytes(b"\0" * 24)
    assert compared(monkeypatch, tmp_path / "answers.bin") == 1
    assert "2 records, expected 512000" in capsys.readouterr().out
    assert compared(monkeypatch, tmp_path / "none.bin") == 1
    assert "no such file" in capsys.readouterr().out


def test_the_header_holds_the_same_bits(golden, tmp_path):
    target = tmp_path / "golden_vectors.hpp"
    tool = ROOT / "tools" / "golden_header.py"
    subprocess.run([sys.executable, tool, vectors.GOLDEN, target], check=True)
    text = target.read_text()
    for name in CHAINS:
        for precision in vectors.PRECISIONS:
            line = re.search(rf"{name}_{precision}_Nm\[\] = {{(.*)}};", text).group(1)
            kept = golden["answers"][name][precision]["torque_Nm"]
            assert line.split(", ") == kept
            assert len(kept) == golden["definition"]["samples"] // golden["definition"]["every"]
