// SPDX-License-Identifier: Apache-2.0
// One long log in sequence: what the chunks of a long log are compared with.
#include <memory>

#include "cases.hpp"
#include "filters.hpp"
#include "long_signals.hpp"

namespace speed {

namespace {

struct Log {
  std::vector<float> torque_Nm;
  std::vector<float> speed_rad_s;
  std::vector<strainwave::Phase> phases;
  std::vector<float> ripple_Nm;
};

std::vector<double> in_double(const std::vector<float>& values) {
  return {values.begin(), values.end()};
}

Case sequential_published(const Recording& recording, const Options& /*options*/) {
  const auto log = std::make_shared<Log>();
  Case each;
  each.prepare = [log, recording](std::size_t samples) {
    repeat(recording.torque_Nm, samples, log->torque_Nm);
    repeat(recording.motor_speed_rad_s, samples, log->speed_rad_s);
    log->ripple_Nm.resize(samples);
  };
  each.run = [log](std::size_t samples) {
    filter_published(published<float>, log->torque_Nm.data(), log->speed_rad_s.data(), samples,
                     log->ripple_Nm.data());
    return samples;
  };
  each.ripple_Nm = [log] { return in_double(log->ripple_Nm); };
  return each;
}

Case sequential_default(const Recording& recording, const Options& /*options*/) {
  const auto log = std::make_shared<Log>();
  Case each;
  each.prepare = [log, recording](std::size_t samples) {
    repeat(recording.torque_Nm, samples, log->torque_Nm);
    repeat(phases(recording), samples, log->phases);
    log->ripple_Nm.resize(samples);
  };
  each.run = [log](std::size_t samples) {
    filter_default(default_15<float>, log->torque_Nm.data(), log->phases.data(), samples,
                   log->ripple_Nm.data());
    return samples;
  };
  each.ripple_Nm = [log] { return in_double(log->ripple_Nm); };
  return each;
}

}  // namespace

void add_sequential(Cases& cases) {
  cases["sequential_published"] = sequential_published;
  cases["sequential_default"] = sequential_default;
}

}  // namespace speed
