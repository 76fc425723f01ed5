"""Every row comes out once and in its place, whatever a method holds back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from helpers.log_files import (
    MAP,
    Halving,
    halved,
    healthy,
    read_result,
    write_csv,
)
from strainwave.methods.interface import Cleaned, Method
from strainwave.methods.registry import Setting
from strainwave.records import Options, filter_log, parse_mapping
from strainwave.records.in_order import InOrder
from strainwave.samples import Samples

NAMES = ["time_s", "torque_measured_Nm", "torque_Nm", "ripple_Nm", "status"]


def test_methods_that_look_ahead_give_every_row_once(tmp_path: Path) -> None:
    columns = healthy(3000)
    columns["t_s"][1000] = 0.0
    log = write_csv(tmp_path / "log.csv", columns)
    options = Options(parse_mapping([MAP]), "motor", rated_torque_Nm=30.0)
    methods = {True: Halving(holds_back=True), False: Halving()}
    results = []
    for holds_back, method in methods.items():
        seen: list[tuple[str, Setting]] = []
        out = tmp_path / f"{holds_back}.csv"

        def build(name: str, setting: Setting, method: Method = method) -> Method:
            seen.append((name, setting))  # noqa: B023 - called before the loop goes on
            return method

        done = filter_log(log, out, options, method="any", build=build)
        ((name, setting),) = seen
        assert name == "any"
        assert setting.sample_period_s == pytest.approx(1e-3, rel=1e-9)
        assert done.rows_by_flag["sample_out_of_order"] == 1
        results.append(read_result(out))
    for name in NAMES:
        np.testing.assert_array_equal(results[0][name], results[1][name])
    expected = 0.5 * columns["tau_Nm"]
    expected[1000] = expected[999]
    np.testing.assert_array_equal(results[0]["ripple_Nm"], expected)


class _FewAtATime:
    """Hands out rows late and in pieces that fit no chunk."""

    def __init__(self) -> None:
        self.held = np.empty(0)

    def process(self, samples: Samples, /) -> Cleaned:
        self.held = np.append(self.held, samples.torque_Nm)
        ready = len(self.held) // 7 * 5
        given, self.held = self.held[:ready], self.held[ready:]
        return halved(given)

    def finish(self) -> Cleaned:
        return halved(self.held)


def test_rows_go_back_to_their_places_however_late_they_come() -> None:
    random = np.random.default_rng(8)
    time_s = np.cumsum(random.normal(0.4, 1.0, 500))
    torque_Nm = np.arange(500.0)
    method = InOrder(_FewAtATime())
    parts = []
    for part in np.split(np.arange(500), [3, 50, 50, 90, 400]):
        zeros = np.zeros(len(part))
        parts.append(method.process(Samples(time_s[part], zeros, torque_Nm[part], zeros)))
    parts.append(method.finish())
    found = np.concatenate([part.torque_Nm for part in parts])
    in_order = time_s > np.append(-np.inf, np.maximum.accumulate(time_s)[:-1])
    last = np.maximum.accumulate(np.where(in_order, np.arange(500), 0))
    np.testing.assert_array_equal(found, 0.5 * torque_Nm[last])
    status = np.concatenate([part.status for part in parts])
    np.testing.assert_array_equal(status == 0, in_order)
