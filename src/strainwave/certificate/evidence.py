"""Recordings read again with what the joint file says: errors under load, fluctuation before and after."""

from __future__ import annotations

import itertools
import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from strainwave.calibrate.fluctuation import fit_fluctuation
from strainwave.commissioning.fluctuation import FLUCTUATION_KEYS
from strainwave.commissioning.torque_table import read_load_table
from strainwave.errors import InputError
from strainwave.joint import Provenance
from strainwave.records.table import read_table
from strainwave.records.voltages import codes_to_volts

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from strainwave.calibrate.loadings import Loadings
    from strainwave.joint import Joint, Section


@dataclass(frozen=True)
class Source:
    """A recording behind a figure.

    Attributes
    ----------
    name, sha256 : str
        The file.
    is_the_calibrations : bool
        Whether it is the file that the section of the joint file was computed from.
    """

    name: str
    sha256: str
    is_the_calibrations: bool


@dataclass(frozen=True)
class LoadEvidence:
    """Torque by the joint file beside the loads that were there.

    Attributes
    ----------
    source : Source
        The table.
    loadings : Loadings
        Its experiments.
    error_percent : numpy.ndarray
        Torque by the joint file minus load, percent of the rated torque, shape (rows,).
    hysteresis_percent : numpy.ndarray
        Of each experiment, the largest difference between means from above and from below at one
        load; NaN where no load was reached both ways. Shape (experiments,).
    """

    source: Source
    loadings: Loadings
    error_percent: NDArray[np.float64]
    hysteresis_percent: NDArray[np.float64]

    @property
    def largest_error_percent(self) -> float:
        """Largest error of a reading as a magnitude, percent of the rated torque."""
        return float(np.max(np.abs(self.error_percent)))

    @property
    def largest_hysteresis_percent(self) -> float | None:
        """Largest hysteresis, percent of the rated torque; None where none can be told."""
        finite = self.hysteresis_percent[np.isfinite(self.hysteresis_percent)]
        return float(finite.max()) if len(finite) else None


@dataclass(frozen=True)
class FluctuationEvidence:
    """Fluctuation of the gauges' sum with equal gains and with those of the joint file.

    Attributes
    ----------
    source : Source
        The recording.
    phasors : numpy.ndarray
        Of every gauge at gain 1, V, shape (harmonics, gauges): sine part real, cosine part
        imaginary.
    gains : numpy.ndarray
        Those of the joint file, shape (gauges,).
    standard_uncertainty_V : numpy.ndarray
        Of the amplitude of the weighted sum, shape (harmonics,).
    """

    source: Source
    phasors: NDArray[np.complex128]
    gains: NDArray[np.float64]
    standard_uncertainty_V: NDArray[np.float64]

    @property
    def before_V(self) -> NDArray[np.float64]:
        """Amplitude with equal gains of the same sum, shape (harmonics,)."""
        mean = self.gains.mean()
        return np.asarray(np.abs(self.phasors.sum(axis=1) * mean))

    @property
    def after_V(self) -> NDArray[np.float64]:
        """Amplitude with the gains of the joint file, shape (harmonics,)."""
        return np.asarray(np.abs(self.phasors @ self.gains))


def load_evidence(path: Path, mapping: Sequence[str], joint: Joint) -> LoadEvidence:
    """Read a table of loads and compute every torque with the calibration of a joint file.

    Parameters
    ----------
    path : Path
        CSV or Parquet.
    mapping : sequence of str
        Which columns are what; without, the mapping that the section's own command had.
    joint : Joint
        A joint with ``[gear]`` and ``[torque_calibration]``.

    Returns
    -------
    LoadEvidence
        Errors and hysteresis.

    Raises
    ------
    InputError
        If a section or the mapping is missing, or the table cannot be read.
    """
    calibration, gear = joint.torque_calibration, joint.gear
    if calibration is None or gear is None:
        missing = "[torque_calibration]" if calibration is None else "[gear]"
        raise InputError(
            f"--loads {path}: the joint file has no section {missing}; expected it, so that "
            "readings become torque, so calibrate torque first or leave --loads out"
        )
    texts = _mapping("--loads", mapping, calibration)
    loadings = read_load_table(path, texts, codes_to_volts(joint)).loadings
    full_Nm = gear.rated_torque_Nm
    share = calibration.gain_Nm_per_V * (loadings.voltage_V - calibration.zero_V) / full_Nm
    torque = share + sum(c * share**n for n, c in enumerate(calibration.linearisation, start=2))
    error = 100.0 * (torque - loadings.load_Nm / full_Nm)
    return LoadEvidence(_source(path, calibration), loadings, error, _hysteresis(loadings, error))


def _hysteresis(loadings: Loadings, error: NDArray[np.float64]) -> NDArray[np.float64]:
    levels = loadings.levels()
    found = np.full(len(loadings.names), np.nan)
    for index, rows in enumerate(loadings.rows()):
        differences = []
        for level in np.unique(levels[rows]):
            here = rows[levels[rows] == level]
            up, down = error[here[loadings.path[here] > 0]], error[here[loadings.path[here] < 0]]
            if len(up) and len(down):
                differences.append(abs(float(up.mean() - down.mean())))
        if differences:
            found[index] = max(differences)
    return found


def fluctuation_evidence(path: Path, mapping: Sequence[str], joint: Joint) -> FluctuationEvidence:
    """Read a recording of all gauges and compute what the gains of a joint file leave of it.

    Parameters
    ----------
    path : Path
        CSV or Parquet.
    mapping : sequence of str
        Which columns are what; without, the mapping that the section's own command had.
    joint : Joint
        A joint with ``[gains]``; factor m from ``[gear]``, 1 without.

    Returns
    -------
    FluctuationEvidence
        Amplitudes before and after.

    Raises
    ------
    InputError
        If a section or the mapping is missing, the number of gauges differs, or the recording
        cannot be read.
    """
    section = joint.gains
    if section is None:
        raise InputError(
            f"--fluctuation {path}: the joint file has no section [gains]; expected the gains that "
            "cancel the fluctuation, so calibrate it first or leave --fluctuation out"
        )
    texts = _mapping("--fluctuation", mapping, section)
    table = read_table(
        path,
        texts,
        FLUCTUATION_KEYS,
        required=("angle", "gauges"),
        codes_to_volts=codes_to_volts(joint),
    )
    table.require_complete(("angle", "gauges"))
    volts, gains = table.values["gauges"], np.array(section.gains)
    if volts.shape[1] != len(gains):
        raise InputError(
            f"--fluctuation {path}: {volts.shape[1]} gauges are mapped, but [gains] has "
            f"{len(gains)}; expected one column for each gain, so correct the mapping"
        )
    harmonics = max(section.harmonics or (1,)) + 1
    try:
        fit = fit_fluctuation(
            volts,
            table.values["angle"],
            positions_rad=np.zeros(len(gains)),
            harmonics=harmonics,
            wave_factor=1.0 if joint.gear is None else joint.gear.factor_m,
        )
    except InputError as error:
        raise InputError(f"--fluctuation {path}: {error}") from error
    phasors = fit.amplitudes * np.exp(1j * fit.phase_errors_rad)
    spread = np.sqrt((fit.amplitude_standard_errors**2) @ gains**2)
    return FluctuationEvidence(_source(path, section), phasors, gains, spread)


def _mapping(option: str, mapping: Sequence[str], section: Section) -> list[str]:
    """Return the mapping that was given, or that of the command that filled the section."""
    if mapping:
        return list(mapping)
    command = None if section.provenance is None else section.provenance.command
    words = [] if command is None else shlex.split(command)
    found = [after for word, after in itertools.pairwise(words) if word == "--map"]
    # A sheet of `strainwave calibrate plan` is read without a mapping.
    if not found and not (words[:3] == ["strainwave", "calibrate", "torque"]):
        raise InputError(
            f"{option}: nothing is mapped, and the joint file does not keep a command with --map "
            f"for this section; expected to be told which columns are what, so add {option}-map"
        )
    return found


def _source(path: Path, section: Section) -> Source:
    here = Provenance.of_file(path)
    assert here.input_sha256 is not None
    made_from = None if section.provenance is None else section.provenance.input_sha256
    return Source(here.input, here.input_sha256, made_from == here.input_sha256)
