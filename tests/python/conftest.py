"""Settings of the test tools that apply to every Python test."""

import hypothesis

# The same examples on every run: a failure is a property of the code, not of the day.
hypothesis.settings.register_profile("fixed", derandomize=True, deadline=None)
hypothesis.settings.load_profile("fixed")
