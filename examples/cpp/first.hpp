#include <strainwave/torque_sensor.hpp>

constexpr auto filter = strainwave::with_orders<float>({{2, 1}, {4, 1}});  // cycles a motor turn
constexpr strainwave::TorqueSensorConfig<float, 1, 2> config{
    .calibration = {.gain_Nm_per_V = 6.60F}, .filter = filter};
static_assert(check(config).ok());
inline auto state = initial_state(config);

inline float torque_Nm(std::int32_t code, float motor_speed_rad_s) {  // once a sample
  return step(config, state, {.codes = {{code}}, .motor_speed_rad_s = motor_speed_rad_s}).torque_Nm;
}
