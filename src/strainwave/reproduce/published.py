"""Numbers printed in the two papers, each with its place.

T: Taghirad & Belanger 1999, "Intelligent built-in torque sensor for harmonic drive systems".
G: Godler, Horiuchi, Hashimoto & Ninomiya 2000, "Accuracy improvement of built-in torque sensing for
Harmonic Drives".

What a preset has as its own input, such as the sensor gain of Table I, is taken from there.
"""

from __future__ import annotations

from typing import Final

from strainwave.simulate.presets import taghirad1999 as station

# Taghirad & Belanger 1999
SENSOR_GAIN_NM_PER_V: Final = station.SENSOR_GAIN_NM_PER_V  # Table I
CONSISTENCY_MEASURE: Final = 0.02  # Table I, over eight experiments
MOTOR_SPEED_RAD_S: Final = station.FREE_MOTION_SPEED_RAD_S  # section V, fig. 8
SPECTRUM_START_S: Final = 0.8  # section V, fig. 8
SPECTRUM_END_S: Final = 1.1  # section V, fig. 8
FUNDAMENTAL_RAD_S: Final = 312.0  # section V, fig. 8
FIRST_HARMONIC_RAD_S: Final = 624.0  # section V, fig. 8
MISALIGNMENT_MOUNTED_NM: Final = 10.0  # section VI, fig. 10, peak to peak
MISALIGNMENT_REASSEMBLED_NM: Final = 2.0  # section VI, peak to peak, "less than"

# Godler et al. 2000
FLUCTUATION_TWO_GAUGES_FS: Final = 0.04  # fig. 3 (b)
FLUCTUATION_FOUR_GAUGES_FS: Final = 0.01  # fig. 6
FLUCTUATION_THREE_GAUGES_FS: Final = 0.02  # fig. 9 (b)
FLUCTUATION_COMPENSATED_FS: Final = 0.002  # fig. 10
COMPENSATION_FACTOR_TWO_GAUGES: Final = 10.0  # section II-A
HARMONICS_RATIO: Final = 20.0  # section II-B
LINEARITY_TWO_GAUGES_FS: Final = 0.02  # fig. 4
LINEARITY_FOUR_GAUGES_FS: Final = 0.005  # fig. 7
LINEARITY_THREE_GAUGES_FS: Final = 0.02  # fig. 11, "less than"
THREE_GAUGE_AMPLITUDES: Final = (1.0, 1.07, 1.15)  # section IV
THREE_GAUGE_PHASE_ERRORS_DEG: Final = (0.0, -1.5, -0.4)  # section IV
