"""Settings of the test tools that apply to every Python test."""

import os

# Before numpy is there: matrices are small here, and threads beside the workers' are waited for.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import hypothesis

# The same examples on every run: a failure is a property of the code, not of the day.
hypothesis.settings.register_profile("fixed", derandomize=True, deadline=None)
hypothesis.settings.load_profile("fixed")
