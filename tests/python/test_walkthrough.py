"""The main job on a simulated joint, its picture's words, and the README's table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from strainwave.joint import read_joint
from strainwave.report.demo_main_job import as_markdown, main_job_table
from strainwave.report.figures_main_job import summary
from strainwave.walkthrough.main_job import MEASURED, OURS, PUBLISHED, TRUE, MainJob, main_job
from strainwave.walkthrough.recordings import DELAY_S, PHASES

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> MainJob:
    return main_job(tmp_path_factory.mktemp("job"))


def test_what_was_put_into_the_joint_is_found(job: MainJob) -> None:
    ripple = job.identified.ripple
    assert ripple.delay is not None
    assert ripple.delay.delay_s == pytest.approx(DELAY_S, abs=1e-4)
    # Noise of 0.006 V in one full bridge of 6.6 Nm/V.
    assert ripple.noise_Nm == pytest.approx(0.006 * 6.6, rel=0.1)
    assert {2.0, 4.0} <= {order.order for order in ripple.present}
    assert read_joint(job.identified.out).joint.gear is not None


def test_ripple_goes_and_touches_stay(job: MainJob) -> None:
    before, after = job.score(MEASURED), job.score(OURS)
    assert before.error_rms_Nm == pytest.approx(1.0, abs=0.05)
    # Noise of 0.04 Nm, and the sensor's own gain, zero and hysteresis beside it.
    assert 0.04 < after.error_rms_Nm < 0.12
    assert 20 * np.log10(before.order_2_Nm / after.order_2_Nm) > 40.0
    assert 20 * np.log10(before.order_4_Nm / after.order_4_Nm) > 40.0
    for read_Nm in (after.touch_in_motion_Nm, after.touch_at_rest_Nm):
        assert read_Nm == pytest.approx(10.0, abs=0.2)
    assert after.by_phase_Nm.keys() == PHASES.keys()
    assert all(after.by_phase_Nm[phase] < 0.15 * before.by_phase_Nm[phase] for phase in PHASES)


def test_the_published_filter_removes_the_touch_with_the_ripple(job: MainJob) -> None:
    published = job.score(PUBLISHED)
    assert published.order_2_Nm < 0.02
    assert published.error_rms_Nm > 2.0
    assert abs(published.touch_at_rest_Nm) < 0.5


def test_the_truth_is_itself(job: MainJob) -> None:
    true = job.score(TRUE)
    assert true.error_rms_Nm == 0.0
    assert true.touch_in_motion_Nm == pytest.approx(10.0, abs=1e-9)


def test_scores_are_those_of_the_torques(job: MainJob) -> None:
    for name, torque_Nm in job.torque_Nm.items():
        error_Nm = torque_Nm - job.true_Nm
        assert job.score(name).error_rms_Nm == pytest.approx(
            float(np.sqrt(np.mean(np.square(error_Nm)))), rel=1e-12
        )


def test_the_readme_shows_this_run(job: MainJob) -> None:
    assert as_markdown(main_job_table(job)) in README
    for number in ("1.00 Nm rms as recorded", "0.10 Nm after"):
        assert number in summary(job)
