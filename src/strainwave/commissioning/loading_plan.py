"""The loading sequence of a torque calibration, as a sheet that a technician fills in."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.checks import real_number, whole_number
from strainwave.calibrate.locked_positions import planned_positions_rad
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

PRELOAD: Final = "preload"
MEASURE: Final = "measure"
TEMPERATURE: Final = "temperature"
COLUMNS: Final = (
    "step",
    "experiment",
    "position_deg",
    "target_temperature_degC",
    "phase",
    "series",
    "load_Nm",
    "dwell_s",
    "voltage_V",
    "temperature_degC",
    "note",
)
"""Header of the sheet; by it `strainwave calibrate torque` knows a sheet."""

SHEET_MAP: Final = (
    "load=load_Nm,voltage=voltage_V,experiment=experiment,position=position_deg:deg",
    "direction=series,phase=phase,temperature=temperature_degC",
)
"""How the sheet is read."""

_MOST_ROWS: Final = 100_000


@dataclass(frozen=True)
class PlanOptions:
    """What a loading sequence is to be.

    Attributes
    ----------
    rated_torque_Nm : float
        Full scale, Nm.
    harmonics : int
        Harmonics of the fluctuation, N.
    positions : int or None
        Positions of the wave generator; 2 N + 1 without.
    experiments : int or None
        Loading experiments; one for each position without.
    temperatures_degC : sequence of float
        Temperatures to calibrate at; none where it is as it is.
    steps : int
        Load steps up to full scale.
    preloads : int
        Loadings to full scale before each direction.
    dwell_s : float
        Wait before each reading, s.
    one_direction : bool
        Whether positive torque alone is loaded.
    """

    rated_torque_Nm: float
    harmonics: int
    positions: int | None = None
    experiments: int | None = None
    temperatures_degC: Sequence[float] = ()
    steps: int = 5
    preloads: int = 3
    dwell_s: float = 30.0
    one_direction: bool = False


@dataclass(frozen=True)
class PlanRow:
    """One load to be put on.

    Attributes
    ----------
    experiment : int
        Counted from 1.
    position_deg : float
        Where the wave generator is locked, degrees.
    temperature_degC : float or None
        Temperature to wait for.
    phase : str
        "preload" or "measure".
    series : str
        "up" or "down": how the load is reached.
    load_Nm : float
        The torque.
    dwell_s : float
        Wait before the reading, s.
    """

    experiment: int
    position_deg: float
    temperature_degC: float | None
    phase: str
    series: str
    load_Nm: float
    dwell_s: float


@dataclass(frozen=True)
class LoadingPlan:
    """The whole sequence.

    Attributes
    ----------
    options : PlanOptions
        What it was made from.
    positions_deg : tuple of float
        Positions, degrees.
    experiments : int
        Number of experiments.
    rows : tuple of PlanRow
        Every load, in order.
    """

    options: PlanOptions
    positions_deg: tuple[float, ...]
    experiments: int
    rows: tuple[PlanRow, ...]

    @property
    def readings(self) -> int:
        """Number of readings to be taken."""
        return sum(row.phase == MEASURE for row in self.rows)

    @property
    def duration_s(self) -> float:
        """Time that the dwells take together, s."""
        return sum(row.dwell_s for row in self.rows)


def make_plan(options: PlanOptions) -> LoadingPlan:
    """Plan the loading sequence.

    In each experiment and direction: preloads to full scale and back; zero, loads up in equal
    steps, down again to zero. Temperatures change after every round of positions and from position
    to position, so that neither stands for the other.

    Parameters
    ----------
    options : PlanOptions
        What it is to be.

    Returns
    -------
    LoadingPlan
        The sequence.

    Raises
    ------
    InputError
        If an option is out of range.
    """
    _check(options)
    degrees = np.degrees(planned_positions_rad(options.harmonics, options.positions))
    count = len(degrees) if options.experiments is None else options.experiments
    count = whole_number("experiments", count)
    if count < len(degrees):
        raise InputError(
            f"experiments = {count}: expected at least {len(degrees)}, one for each position; plan "
            "more experiments or fewer positions"
        )
    temperatures = list(options.temperatures_degC)
    per_experiment = (2 * options.preloads + 2 * options.steps + 1) * (
        1 if options.one_direction else 2
    )
    if count * per_experiment > _MOST_ROWS:
        raise InputError(
            f"the sheet would have {count * per_experiment} rows: expected at most {_MOST_ROWS}; "
            "plan fewer experiments or steps"
        )
    rows: list[PlanRow] = []
    for index in range(count):
        place = index % len(degrees)
        # The shift by the round keeps positions and temperatures from going in step.
        turn = index + index // len(degrees)
        temperature = float(temperatures[turn % len(temperatures)]) if temperatures else None
        rows += _experiment(options, index + 1, float(degrees[place]), temperature)
    return LoadingPlan(options, tuple(float(each) for each in degrees), count, tuple(rows))


def _experiment(
    options: PlanOptions, number: int, position_deg: float, temperature_degC: float | None
) -> list[PlanRow]:
    steps = options.steps
    top = options.rated_torque_Nm
    rows = []

    def add(phase: str, series: str, load_Nm: float) -> None:
        rows.append(
            PlanRow(number, position_deg, temperature_degC, phase, series, load_Nm, options.dwell_s)
        )

    for sense in (1,) if options.one_direction else (1, -1):
        for _ in range(options.preloads):
            add(PRELOAD, "up", sense * top)
            add(PRELOAD, "down", 0.0)
        for step in range(steps + 1):
            add(MEASURE, "up", sense * top * step / steps + 0.0)
        for step in range(steps - 1, -1, -1):
            add(MEASURE, "down", sense * top * step / steps + 0.0)
    return rows


def _check(options: PlanOptions) -> None:
    whole_number("harmonics", options.harmonics)
    for name, value, low, high, unit in (
        ("rated_torque_Nm", options.rated_torque_Nm, 1e-6, 1e7, " Nm"),
        ("dwell_s", options.dwell_s, 0.0, 86400.0, " s"),
        ("steps", options.steps, 2, 1000, ""),
        ("preloads", options.preloads, 0, 100, ""),
        ("harmonics", options.harmonics, 1, 100, ""),
        *(("temperatures", each, -273.15, 1000.0, " degC") for each in options.temperatures_degC),
    ):
        if not low <= real_number(name, value) <= high:
            raise InputError(
                f"{name} = {value:g}{unit}: expected {low:g} to {high:g}{unit}; correct this value"
            )


def sheet_csv(plan: LoadingPlan) -> str:
    """Write the sheet.

    Parameters
    ----------
    plan : LoadingPlan
        The sequence.

    Returns
    -------
    str
        CSV with the header `COLUMNS`; volts, temperature and note are empty.
    """
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    for step, row in enumerate(plan.rows, 1):
        temperature = "" if row.temperature_degC is None else f"{row.temperature_degC:.10g}"
        writer.writerow(
            (
                step,
                row.experiment,
                f"{row.position_deg:.10g}",
                temperature,
                row.phase,
                row.series,
                f"{row.load_Nm:.10g}",
                f"{row.dwell_s:.10g}",
                "",
                "",
                "",
            )
        )
    return stream.getvalue()


def is_sheet(names: Sequence[str] | None) -> bool:
    """Tell whether columns are those of a sheet; a technician may have added others.

    Parameters
    ----------
    names : sequence of str or None
        Names of the columns.

    Returns
    -------
    bool
        Whether all of `COLUMNS` are among them.
    """
    return names is not None and set(COLUMNS) <= set(names)
