// SPDX-License-Identifier: Apache-2.0
// Many channels at once: the recording begun at another sample for each of them.
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include "batch_options.hpp"
#include "cases.hpp"
#include "log_signals.hpp"

namespace speed {

namespace {

/// Each channel has its own arrays, as logs have them.
template <class Signals>
struct Channels {
  std::vector<Signals> signals;
  std::vector<std::vector<float>> ripple_Nm;
};

template <class Signals>
void filter_channels(Channels<Signals>& channels, const strainwave::BatchOptions& how) {
  using Config = std::remove_cvref_t<decltype(Signals::config)>;
  const std::size_t count = channels.signals.size();
  const std::vector<Config> configs(count, Signals::config);
  std::vector states(count, strainwave::initial_state(Signals::config));
  std::vector<decltype(channels.signals[0].channel(channels.ripple_Nm[0]))> inputs;
  inputs.reserve(count);
  for (std::size_t c = 0; c < count; ++c) {
    inputs.push_back(channels.signals[c].channel(channels.ripple_Nm[c]));
  }
  strainwave::process_batch(std::span(configs), std::span(states), std::span(std::as_const(inputs)),
                            how);
}

template <class Signals>
Case batch(const Recording& recording, const Options& options) {
  const std::size_t count = number(options, "channels", 64);
  const auto channels = std::make_shared<Channels<Signals>>();
  Case each;
  each.prepare = [channels, recording, count](std::size_t samples) {
    channels->signals.resize(count);
    channels->ripple_Nm.assign(count, std::vector<float>(samples));
    for (std::size_t c = 0; c < count; ++c) {
      channels->signals[c].prepare(recording, samples, 997 * c);
    }
  };
  each.run = [channels, count, how = batch_options(options)](std::size_t samples) {
    filter_channels(*channels, how);
    return samples * count;
  };
  each.ripple_Nm = [channels] {
    return std::vector<double>(channels->ripple_Nm[0].begin(), channels->ripple_Nm[0].end());
  };
  return each;
}

}  // namespace

void add_batch(Cases& cases) {
  cases["batch_published"] = batch<PublishedSignals>;
  cases["batch_default"] = batch<DefaultSignals>;
}

}  // namespace speed
