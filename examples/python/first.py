import numpy as np

import strainwave as sw

time_s = np.arange(5000) * 1e-3
motor_angle_rad = 156.0 * time_s
ripple_Nm = 1.6 * np.sin(2 * motor_angle_rad)
contact_Nm = np.where(time_s > 4.0, 10.0, 0.0)
noise_Nm = np.random.default_rng(1).normal(0.0, 0.04, 5000)
ripple_filter = sw.RippleFilter(sw.RippleFilterConfig(orders=[2, 4]))
clean = ripple_filter.process(time_s, motor_angle_rad, contact_Nm + ripple_Nm + noise_Nm)
error_Nm = (clean.torque_Nm - contact_Nm)[1000:]
print(f"{np.std(ripple_Nm):.2f} -> {np.std(error_Nm):.2f} Nm rms")
