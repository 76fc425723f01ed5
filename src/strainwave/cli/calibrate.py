"""`strainwave calibrate`: from measurements on a joint to the sections of its joint file."""

from __future__ import annotations

import cyclopts

calibrate_app = cyclopts.App(
    name="calibrate", help="Find gains, torque calibration and drift of a joint's gauges."
)
