// The golden vectors as whole recordings: what each chain's filter is fed, for filters that take
// many samples at once.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "../golden/golden_chains.hpp"
#include "strainwave/batch.hpp"
#include "strainwave/batch_ripple.hpp"

namespace golden {

/// What comes out of a filter, sample by sample.
template <class Real>
struct Outputs {
  std::vector<Real> torque_Nm;
  std::vector<Real> ripple_Nm;
  std::vector<strainwave::Status> status;

  explicit Outputs(std::size_t size) : torque_Nm(size), ripple_Nm(size), status(size) {}
};

/// A filter's signals, and which of the golden samples each came from.
template <class Real>
struct Signals {
  std::vector<Real> measured_Nm;
  std::vector<Real> expected_Nm;
  std::vector<Real> speed_rad_s;
  std::vector<Real> interval_s;
  std::vector<double> angle_rad;
  std::vector<strainwave::Status> of_clock;  ///< flags that do not come from the filter
  std::vector<std::size_t> sample;

  [[nodiscard]] std::size_t size() const { return measured_Nm.size(); }

  void add(const RawSample& raw, const Shaft& shaft, std::size_t k) {
    measured_Nm.push_back(number<Real>(raw.torque, 4096));
    expected_Nm.push_back(number<Real>(raw.expected, 4096));
    speed_rad_s.push_back(number<Real>(raw.speed, 64));
    interval_s.push_back(static_cast<Real>(shaft.interval.interval_s));
    angle_rad.push_back(raw.angle_known ? strainwave::to_radians<double>(shaft.phase)
                                        : std::numeric_limits<double>::quiet_NaN());
    of_clock.push_back(shaft.interval.status);
    sample.push_back(k);
  }
};

/// The signals as the chains without gauges take them.
template <class Real>
[[nodiscard]] Signals<Real> signals() {
  Signals<Real> signals;
  Inputs inputs;
  Shaft shaft;
  for (std::size_t k = 0; k < sample_count; ++k) {
    const RawSample raw = inputs.next();
    shaft.take(raw);
    signals.add(raw, shaft, k);
  }
  return signals;
}

/// What the chain of four gauges hands to its filter.  Samples that it refuses by their number
/// never get there; a torque that it knows to be wrong is NaN here.
template <class Real>
[[nodiscard]] Signals<Real> signals_behind_gauges() {
  Signals<Real> signals;
  Chain<Real> chain;
  Inputs inputs;
  Shaft shaft;
  for (std::size_t k = 0; k < sample_count; ++k) {
    const RawSample raw = inputs.next();
    const auto before = chain.state();
    shaft.take(raw);
    (void)chain.take(raw);
    const auto& after = chain.state();
    if (after.filter.counters.samples == before.filter.counters.samples) {
      continue;
    }
    signals.add(raw, shaft, k);
    constexpr strainwave::Status torque_wrong = mask(strainwave::StatusFlag::gauge_saturated) |
                                                mask(strainwave::StatusFlag::gauges_insufficient);
    signals.measured_Nm.back() = (after.last_reading.status & torque_wrong) != 0U
                                     ? std::numeric_limits<Real>::quiet_NaN()
                                     : after.filter.measured_Nm;
    Real& interval_s = signals.interval_s.back();
    if (has(shaft.interval.status, strainwave::StatusFlag::sample_out_of_order)) {
      interval_s = Real(-1);
    } else if (interval_s == Real(0)) {
      interval_s = chain.config().sample_period_s;
    } else {
      interval_s += before.refused_interval_s;
    }
  }
  return signals;
}

}  // namespace golden
