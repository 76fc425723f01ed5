"""From a table of measurements to a section of the joint file: what `strainwave calibrate` does."""
