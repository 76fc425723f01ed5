"""Least squares against the certified values of NIST's reference data for linear regression.

Each data set is first solved in rational arithmetic, so that a wrong digit in the files shows.
"""

from __future__ import annotations

import tomllib
from decimal import Decimal, localcontext
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from strainwave.calibrate.torque import least_squares

FOLDER = Path(__file__).parents[1] / "data" / "strd"
NAMES = ("norris", "longley", *(f"wampler{k}" for k in range(1, 6)))
DIGITS = 15
"""Significant digits of the certified values."""
EPS = float(np.finfo(np.float64).eps)


def _read(name: str) -> tuple[dict[str, Any], list[list[Fraction]], list[Fraction]]:
    with (FOLDER / f"{name}.toml").open("rb") as stream:
        found = tomllib.load(stream, parse_float=Fraction)
    rows = [[Fraction(value) for value in row] for row in found["rows"]]
    degree = 5 if found["model"] == "quintic" else 1
    matrix = [
        [Fraction(1), *(value**power for value in row[1:] for power in range(1, degree + 1))]
        for row in rows
    ]
    return found, matrix, [row[0] for row in rows]


def _inverse(matrix: list[list[Fraction]]) -> list[list[Fraction]]:
    size = len(matrix)
    work = [[*row, *(Fraction(i == j) for j in range(size))] for i, row in enumerate(matrix)]
    for i in range(size):
        pivot = next(k for k in range(i, size) if work[k][i] != 0)
        work[i], work[pivot] = work[pivot], work[i]
        work[i] = [value / work[i][i] for value in work[i]]
        for k in range(size):
            if k != i and work[k][i] != 0:
                factor = work[k][i]
                work[k] = [a - factor * b for a, b in zip(work[k], work[i], strict=True)]
    return [row[size:] for row in work]


def _exact(
    matrix: list[list[Fraction]], measured: list[Fraction]
) -> tuple[list[Fraction], list[Fraction], Fraction]:
    """Estimates, and the squares of standard errors and of the residuals' standard deviation."""
    size = range(len(matrix[0]))
    normal = [[sum((row[i] * row[j] for row in matrix), Fraction(0)) for j in size] for i in size]
    right = [
        sum((row[i] * y for row, y in zip(matrix, measured, strict=True)), Fraction(0))
        for i in size
    ]
    inverse = _inverse(normal)
    estimates = [sum((inverse[i][j] * right[j] for j in size), Fraction(0)) for i in size]
    squares = sum(
        (y - sum((a * b for a, b in zip(row, estimates, strict=True)), Fraction(0))) ** 2
        for row, y in zip(matrix, measured, strict=True)
    )
    variance = Fraction(squares) / (len(matrix) - len(matrix[0]))
    return estimates, [variance * inverse[i][i] for i in size], variance


def _decimal(value: Fraction) -> Decimal:
    return Decimal(value.numerator) / Decimal(value.denominator)


def _rounded(value: Decimal) -> Decimal:
    return value if value == 0 else Decimal(f"{value:.{DIGITS - 1}E}")


@pytest.mark.parametrize("name", NAMES)
def test_the_files_hold_the_certified_problem(name: str) -> None:
    found, matrix, measured = _read(name)
    estimates, variances, variance = _exact(matrix, measured)
    with localcontext() as context:
        context.prec = 60
        for exact, text in zip(estimates, found["certified_estimates"], strict=True):
            assert _rounded(_decimal(exact)) == Decimal(text)
        for exact, text in zip(variances, found["certified_standard_errors"], strict=True):
            assert _rounded(_decimal(exact).sqrt()) == Decimal(text)
        residual = Decimal(found["certified_residual_standard_deviation"])
        assert _rounded(_decimal(variance).sqrt()) == residual


# Fewest digits in common with the certified estimates and standard errors; none is certified for the
# standard errors of an exact polynomial but 0.
DIGITS_KEPT = {
    "norris": (13.5, 13.0),
    "longley": (10.3, 12.0),
    "wampler1": (9.3, None),
    "wampler2": (12.3, None),
    "wampler3": (9.0, 13.0),
    "wampler4": (7.0, 13.0),
    "wampler5": (5.0, 13.0),
}


def _digits(value: float, certified: str) -> float:
    difference = abs(value - float(certified)) / abs(float(certified))
    return float(min(DIGITS, -np.log10(difference) if difference > 0 else DIGITS))


@pytest.mark.parametrize("name", NAMES)
def test_least_squares_keeps_the_digits_double_can_keep(name: str) -> None:
    found, exact_matrix, exact_measured = _read(name)
    matrix = np.array(exact_matrix, np.float64)
    measured = np.array(exact_measured, np.float64)
    fit = least_squares(matrix, measured)
    of_estimates, of_errors = DIGITS_KEPT[name]
    pairs = zip(fit.parameters, found["certified_estimates"], strict=True)
    assert min(_digits(*pair) for pair in pairs) >= of_estimates
    pairs = zip(fit.standard_errors, found["certified_standard_errors"], strict=True)
    if of_errors is None:
        assert fit.standard_errors == pytest.approx(0.0, abs=1e-9)
    else:
        assert min(_digits(*pair) for pair in pairs) >= of_errors


@pytest.mark.parametrize("name", NAMES)
def test_errors_are_those_of_rounding_the_data_once(name: str) -> None:
    # What rounding every element of A and b by eps does to the solution, to first order: Bjorck,
    # Numerical Methods for Least Squares Problems, section 1.4.5. No solver in double can promise
    # less; ours stays below it without a factor.
    found, exact_matrix, exact_measured = _read(name)
    estimates, _, _ = _exact(exact_matrix, exact_measured)
    size = range(len(estimates))
    normal = [[sum(row[i] * row[j] for row in exact_matrix) for j in size] for i in size]
    covariance = _inverse([[Fraction(value) for value in row] for row in normal])
    residuals = [
        y - sum(a * b for a, b in zip(row, estimates, strict=True))
        for row, y in zip(exact_matrix, exact_measured, strict=True)
    ]
    pseudo = [[sum(covariance[i][k] * row[k] for k in size) for row in exact_matrix] for i in size]
    fit = least_squares(np.array(exact_matrix, np.float64), np.array(exact_measured, np.float64))
    sums = [
        abs(y) + sum(abs(a * b) for a, b in zip(row, estimates, strict=True))
        for row, y in zip(exact_matrix, exact_measured, strict=True)
    ]
    slopes = [
        sum(abs(row[k] * r) for row, r in zip(exact_matrix, residuals, strict=True)) for k in size
    ]
    for j in size:
        change = sum(abs(p) * s for p, s in zip(pseudo[j], sums, strict=True))
        change += sum(abs(covariance[j][k]) * slopes[k] for k in size)
        assert abs(Fraction(float(fit.parameters[j])) - estimates[j]) <= Fraction(EPS) * change
    assert len(found["certified_estimates"]) == len(estimates)
