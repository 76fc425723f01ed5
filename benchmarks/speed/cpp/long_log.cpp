// SPDX-License-Identifier: Apache-2.0
// One long log in chunks of time on lanes and threads.
#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <string>

#include "batch_options.hpp"
#include "cases.hpp"
#include "filters.hpp"
#include "long_signals.hpp"
#include "strainwave/batch_long.hpp"

namespace speed {

namespace {

struct Log {
  std::vector<float> torque_Nm;
  std::vector<float> speed_rad_s;
  std::vector<float> ripple_Nm;
  strainwave::LongReport report;
};

void filter_long(Log& log, const strainwave::LongOptions& how, std::vector<float>& ripple_Nm) {
  strainwave::OscillatorChannel<float> channel;
  channel.sample_count = log.torque_Nm.size();
  channel.measured_torque_Nm = log.torque_Nm.data();
  channel.motor_speed_rad_s = log.speed_rad_s.data();
  channel.ripple_Nm = ripple_Nm.data();
  auto state = strainwave::initial_state(published<float>);
  log.report = strainwave::process_long<float, 3>(published<float>, state, channel, how);
}

/// JSON members: how far the chunks came out from a sequence, and what they took.
std::string compared_with_sequence(Log& log) {
  const strainwave::LongReport report = log.report;
  std::vector<float> sequence_Nm(log.ripple_Nm.size());
  strainwave::LongOptions in_sequence;
  in_sequence.in_sequence = true;
  filter_long(log, in_sequence, sequence_Nm);
  double squares_Nm2 = 0.0;
  double largest_Nm = 0.0;
  for (std::size_t k = 0; k < sequence_Nm.size(); ++k) {
    const double apart_Nm =
        static_cast<double>(log.ripple_Nm[k]) - static_cast<double>(sequence_Nm[k]);
    squares_Nm2 += apart_Nm * apart_Nm;
    largest_Nm = std::max(largest_Nm, std::abs(apart_Nm));
  }
  std::ostringstream text;
  text << R"(, "difference_rms_Nm": )"
       << std::sqrt(squares_Nm2 / static_cast<double>(sequence_Nm.size()))
       << R"(, "difference_largest_Nm": )" << largest_Nm << R"(, "chunks": )" << report.chunk_count
       << R"(, "repeated_chunks": )" << report.repeated_chunks << R"(, "warm_up_samples": )"
       << report.warm_up_samples;
  return text.str();
}

Case long_published(const Recording& recording, const Options& options) {
  const auto log = std::make_shared<Log>();
  strainwave::LongOptions how;
  how.batch = batch_options(options);
  Case each;
  each.prepare = [log, recording](std::size_t samples) {
    repeat(recording.torque_Nm, samples, log->torque_Nm);
    repeat(recording.motor_speed_rad_s, samples, log->speed_rad_s);
    log->ripple_Nm.assign(samples, 0.0F);
  };
  each.run = [log, how](std::size_t samples) {
    filter_long(*log, how, log->ripple_Nm);
    return samples;
  };
  each.ripple_Nm = [log] {
    return std::vector<double>(log->ripple_Nm.begin(), log->ripple_Nm.end());
  };
  each.remarks = [log] { return compared_with_sequence(*log); };
  return each;
}

}  // namespace

void add_long(Cases& cases) { cases["long_published"] = long_published; }

}  // namespace speed
