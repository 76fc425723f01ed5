"""`strainwave calibrate`: from measurements on a joint to the sections of its joint file."""

from __future__ import annotations

import cyclopts

calibrate_app = cyclopts.App(
    name="calibrate",
    help="From measurements to the joint file: gains, torque, temperature and misalignment.",
)
