// SPDX-License-Identifier: Apache-2.0
// Many channels at once: the recording begun at another sample for each of them.
#include <memory>

#include "batch_options.hpp"
#include "cases.hpp"
#include "filters.hpp"
#include "long_signals.hpp"
#include "strainwave/batch.hpp"

namespace speed {

namespace {

/// Signals of all channels, each with its own arrays as logs have them.
struct Signals {
  std::vector<std::vector<float>> torque_Nm;
  std::vector<std::vector<float>> speed_rad_s;
  std::vector<std::vector<float>> ripple_Nm;
};

Case batch_published(const Recording& recording, const Options& options) {
  using Config = strainwave::OscillatorFilterConfig<float, 3>;
  using State = strainwave::OscillatorFilterState<float, 3>;
  const std::size_t channels = number(options, "channels", 64);
  const auto signals = std::make_shared<Signals>();
  Case each;
  each.prepare = [signals, recording, channels](std::size_t samples) {
    signals->torque_Nm.resize(channels);
    signals->speed_rad_s.resize(channels);
    signals->ripple_Nm.assign(channels, std::vector<float>(samples));
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t from = 997 * c;
      repeat(recording.torque_Nm, samples, signals->torque_Nm[c], from);
      repeat(recording.motor_speed_rad_s, samples, signals->speed_rad_s[c], from);
    }
  };
  each.run = [signals, channels, how = batch_options(options)](std::size_t samples) {
    const std::vector<Config> configs(channels, published<float>);
    std::vector<State> states(channels, strainwave::initial_state(published<float>));
    std::vector<strainwave::OscillatorChannel<float>> inputs(channels);
    for (std::size_t c = 0; c < channels; ++c) {
      inputs[c].sample_count = samples;
      inputs[c].measured_torque_Nm = signals->torque_Nm[c].data();
      inputs[c].motor_speed_rad_s = signals->speed_rad_s[c].data();
      inputs[c].ripple_Nm = signals->ripple_Nm[c].data();
    }
    strainwave::process_batch<float, 3>(configs, states, inputs, how);
    return samples * channels;
  };
  each.ripple_Nm = [signals] {
    return std::vector<double>(signals->ripple_Nm[0].begin(), signals->ripple_Nm[0].end());
  };
  return each;
}

}  // namespace

void add_batch(Cases& cases) { cases["batch_published"] = batch_published; }

}  // namespace speed
