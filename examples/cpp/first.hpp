#include <strainwave/torque_sensor.hpp>

constexpr strainwave::RippleSensorConfig<float, 1, 2> config{
    .calibration = {.gain_Nm_per_V = 6.60F},
    .filter = {.order_count = 2, .orders = {{.order = {2, 1}}, {.order = {4, 1}}}},
    .sample_period_s = 1e-3F};
static_assert(check(config).ok());
inline auto state = initial_state(config);

inline float torque_Nm(std::int32_t code, std::int64_t encoder_counts, std::uint32_t sample) {
  return step(config, state,
              {.codes = {{code}},
               .motor_phase = strainwave::phase_from_counts(encoder_counts, 4096),
               .sequence = sample})
      .torque_Nm;
}
