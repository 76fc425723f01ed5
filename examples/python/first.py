import numpy as np

import strainwave as sw

time_s = np.arange(5000) * 1e-3
ripple_Nm = 1.6 * np.sin(2 * 156.0 * time_s)
contact_Nm = np.where(time_s > 4.0, 10.0, 0.0)
sensor = sw.OscillatorFilter(sw.OscillatorFilterConfig(orders=[2, 4]))
clean = sensor.process(ripple_Nm + contact_Nm, motor_speed_rad_s=np.full_like(time_s, 156.0))
print(f"{np.std(ripple_Nm):.2f} -> {np.std((clean.torque_Nm - contact_Nm)[3000:]):.2f} Nm rms")
