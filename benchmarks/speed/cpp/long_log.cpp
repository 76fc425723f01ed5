// SPDX-License-Identifier: Apache-2.0
// One long log in chunks of time on lanes and threads.
#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <string>

#include "batch_options.hpp"
#include "cases.hpp"
#include "log_signals.hpp"
#include "strainwave/batch_long.hpp"
#include "strainwave/batch_ripple_long.hpp"

namespace speed {

namespace {

template <class Signals>
struct Log {
  Signals signals;
  std::vector<float> ripple_Nm;
  strainwave::LongReport report;
};

template <class Signals>
strainwave::LongReport filter_long(const Signals& signals, const strainwave::LongOptions& how,
                                   std::vector<float>& ripple_Nm) {
  auto state = strainwave::initial_state(Signals::config);
  return strainwave::process_long(Signals::config, state, signals.channel(ripple_Nm), how);
}

/// JSON members: how far the chunks came out from a sequence, and what they took.
template <class Signals>
std::string compared_with_sequence(const Log<Signals>& log) {
  std::vector<float> sequence_Nm(log.ripple_Nm.size());
  strainwave::LongOptions in_sequence;
  in_sequence.in_sequence = true;
  filter_long(log.signals, in_sequence, sequence_Nm);
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
       << R"(, "difference_largest_Nm": )" << largest_Nm << R"(, "chunks": )"
       << log.report.chunk_count << R"(, "repeated_chunks": )" << log.report.repeated_chunks
       << R"(, "warm_up_samples": )" << log.report.warm_up_samples;
  return text.str();
}

template <class Signals>
Case long_log(const Recording& recording, const Options& options) {
  const auto log = std::make_shared<Log<Signals>>();
  strainwave::LongOptions how;
  how.batch = batch_options(options);
  Case each;
  each.prepare = [log, recording](std::size_t samples) {
    log->signals.prepare(recording, samples, 0);
    log->ripple_Nm.assign(samples, 0.0F);
  };
  each.run = [log, how](std::size_t samples) {
    log->report = filter_long(log->signals, how, log->ripple_Nm);
    return samples;
  };
  each.ripple_Nm = [log] {
    return std::vector<double>(log->ripple_Nm.begin(), log->ripple_Nm.end());
  };
  each.remarks = [log] { return compared_with_sequence(*log); };
  return each;
}

}  // namespace

void add_long(Cases& cases) {
  cases["long_published"] = long_log<PublishedSignals>;
  cases["long_default"] = long_log<DefaultSignals>;
}

}  // namespace speed
