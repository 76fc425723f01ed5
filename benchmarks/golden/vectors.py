"""The golden file: definition, answers in double and float, checksums; and answers held to it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

import numpy as np

from benchmarks.golden.chains import CHAINS, Answers
from benchmarks.golden.definition import definition
from benchmarks.golden.inputs import samples_of

GOLDEN: Final = Path(__file__).resolve().parents[2] / "tests" / "data" / "golden" / "golden.json"
#: Names of the precisions in the file.
PRECISIONS: Final = {"double": np.float64, "float": np.float32}


def answers_of(defined: dict[str, Any], name: str, precision: str) -> Answers:
    """Run one chain.

    Parameters
    ----------
    defined : dict
        The definition.
    name : str
        One of `benchmarks.golden.chains.CHAINS`.
    precision : str
        ``double`` or ``float``.

    Returns
    -------
    Answers
        Of every sample.
    """
    samples = samples_of(defined, defined["samples"])
    return CHAINS[name](defined, samples, PRECISIONS[precision])


def make_golden() -> dict[str, Any]:
    """Make the golden vectors anew on this machine.

    Returns
    -------
    dict
        What `golden_text` writes.
    """
    defined = definition()
    answers: dict[str, Any] = {}
    for name in CHAINS:
        answers[name] = {}
        for precision in PRECISIONS:
            found = answers_of(defined, name, precision)
            kept = slice(defined["every"] - 1, None, defined["every"])
            answers[name][precision] = {
                "checksum": found.checksum(),
                "torque_Nm": [float(value).hex() for value in found.torque_Nm[kept]],
                "status": found.status[kept].tolist(),
            }
    checksum = samples_of(defined, defined["samples"]).checksum()
    return {"definition": defined, "inputs_checksum": checksum, "answers": answers}


def golden_text(golden: dict[str, Any]) -> str:
    """Return the file's text.

    Parameters
    ----------
    golden : dict
        From `make_golden`.

    Returns
    -------
    str
        JSON, lists on one line.
    """
    lines = [f'"inputs_checksum": {golden["inputs_checksum"]}', '"definition": {']
    lines[-1] += ",".join(
        f'\n  "{key}": {json.dumps(value)}' for key, value in golden["definition"].items()
    )
    text = ",\n".join(lines) + "\n},\n" + '"answers": {\n'
    text += ",\n".join(
        f'  "{name}": {{\n'
        + ",\n".join(f'    "{each}": {json.dumps(value)}' for each, value in found.items())
        + "\n  }"
        for name, found in golden["answers"].items()
    )
    return "{\n" + text + "\n}\n}\n"


def read_golden() -> dict[str, Any]:
    """Read the golden file.

    Returns
    -------
    dict
        Definition and answers.
    """
    read: dict[str, Any] = json.loads(GOLDEN.read_text(encoding="utf-8"))
    return read


def deviations(golden: dict[str, Any], name: str, answers: Answers) -> dict[str, Any]:
    """Hold answers to the golden ones.

    Parameters
    ----------
    golden : dict
        From `read_golden`.
    name : str
        The chain.
    answers : Answers
        Of every sample, in float or double.

    Returns
    -------
    dict
        Largest deviation from the kept torques in both precisions, %FS / 100; whether all bits of
        all samples are those of the answers' own precision; and kept samples with another status.
    """
    every = golden["definition"]["every"]
    full_scale_Nm = golden["definition"]["full_scale_Nm"]
    own = "float" if answers.torque_Nm.dtype.itemsize == 4 else "double"
    kept = answers.torque_Nm[every - 1 :: every].astype(np.float64)
    expected = golden["answers"][name]
    far = {
        precision: float(
            np.max(
                np.abs(kept - [float.fromhex(each) for each in expected[precision]["torque_Nm"]])
            )
        )
        / full_scale_Nm
        for precision in PRECISIONS
    }
    other = answers.status[every - 1 :: every] != np.array(expected[own]["status"])
    return {
        "same_bits": answers.checksum() == expected[own]["checksum"],
        "from_float_FS": far["float"],
        "from_double_FS": far["double"],
        "other_status": int(np.count_nonzero(other)),
    }
