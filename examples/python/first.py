import numpy as np

import strainwave as sw

time_s = np.arange(5000) * 1e-3
speed_rad_s = np.full_like(time_s, 156.0)
ripple_Nm = 1.6 * np.sin(2 * 156.0 * time_s)
contact_Nm = np.where(time_s > 4.0, 10.0, 0.0)
config = sw.OscillatorFilterConfig(orders=[2, 4])
clean = sw.OscillatorFilter(config).process(ripple_Nm + contact_Nm, motor_speed_rad_s=speed_rad_s)
error_Nm = (clean.torque_Nm - contact_Nm)[3000:]
print(f"ripple {np.std(ripple_Nm):.2f} Nm rms, left {np.std(error_Nm):.2f} Nm with a 10 Nm contact")
