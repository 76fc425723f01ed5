// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "bind_ripple_filter.hpp"
#include "bind_status.hpp"
#include "strainwave/batch_ripple.hpp"
#include "strainwave/batch_ripple_long.hpp"
#include "strainwave/learned_ripple.hpp"
#include "strainwave/sample_clock.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

/// Pairs that a batch has room for: those that run on lanes.
inline constexpr std::size_t batch_pairs = most_lane_pairs;

/// Results of one channel: two of the outputs, and the status.
template <class Real>
struct RippleResultRow {
  FilledVector<Real> first;
  FilledVector<Real> second;
  FilledVector<std::uint32_t> status;

  explicit RippleResultRow(std::size_t size) : first(size), second(size), status(size) {}
};
template <class Real>
using RippleGiven = std::tuple<VectorOut<Real>, VectorOut<Real>, VectorOut<std::uint32_t>>;

/// What a clock says of a recording's stamps.
template <class Real>
struct Stamped {
  std::vector<Real> interval_s;
  std::vector<std::pair<std::size_t, Status>> remarks;
};

template <class Real>
Stamped<Real> stamped(SampleClock& clock, const double* time_s, std::size_t size) {
  Stamped<Real> result;
  result.interval_s.resize(size);
  for (std::size_t k = 0; k < size; ++k) {
    const Interval interval = take_stamp(clock, time_s[k]);
    const bool finite = !has(interval.status, StatusFlag::time_not_finite);
    result.interval_s[k] =
        finite ? static_cast<Real>(interval.interval_s) : std::numeric_limits<Real>::quiet_NaN();
    if (interval.status != 0) {
      result.remarks.emplace_back(k, interval.status);
    }
  }
  return result;
}

template <class Real>
class RippleBatch {
 public:
  using Config = RippleFilterConfig<Real, batch_pairs>;
  using State = RippleFilterState<Real, batch_pairs>;
  using Rows = std::vector<
      std::tuple<Vector<double>, Vector<double>, Vector<Real>, std::optional<Vector<Real>>>>;

  RippleBatch(const std::vector<RippleConfigD>& configs, const std::vector<LearnedD>& kept) {
    if (!kept.empty()) {
      require_same_length("learned", kept.size(), "configs", configs.size());
    }
    for (const RippleConfigD& each : configs) {
      if (pair_count(each) > batch_pairs) {
        raise_input_error("configs have more than " + std::to_string(batch_pairs) +
                          " pairs of coefficients: take RippleFilter for these");
      }
      configs_.push_back(converted<Real, batch_pairs>(each));
      require(check(configs_.back()));  // what double holds may vanish or overflow in float
    }
    for (std::size_t i = 0; i < kept.size(); ++i) {
      require(check(configs[i], kept[i]));
      kept_.push_back(converted<Real, batch_pairs>(kept[i]));
    }
    reset();
  }

  void reset() {
    calls_.wait();
    states_.clear();
    for (std::size_t i = 0; i < configs_.size(); ++i) {
      states_.push_back(kept_.empty() ? initial_state(configs_[i])
                                      : restored(configs_[i], kept_[i]));
    }
    clocks_.assign(configs_.size(), SampleClock{});
  }

  std::vector<RippleGiven<Real>> process(const Rows& rows, bool angle_referenced, VectorLevel level,
                                         std::size_t threads) {
    return run_batch(rows, angle_referenced, torque_and_ripple, level, threads);
  }

  std::vector<RippleGiven<Real>> innovations(const Rows& rows, bool angle_referenced,
                                             VectorLevel level, std::size_t threads) {
    return run_batch(rows, angle_referenced, {RippleOutput::innovation, RippleOutput::variance},
                     level, threads);
  }

  std::pair<RippleGiven<Real>, LongReport> process_one(const Rows& rows, bool angle_referenced,
                                                       const LongOptions& options) {
    LongReport report;
    auto given = run(rows, angle_referenced, torque_and_ripple,
                     [&](const std::vector<RippleChannel<Real>>& channels) {
                       report = process_long(configs_[0], states_[0], channels[0], options);
                     });
    return {std::move(given[0]), report};
  }

  [[nodiscard]] std::vector<CountsByName> counters() const {
    calls_.wait();
    std::vector<CountsByName> counts;
    counts.reserve(states_.size());
    for (const State& state : states_) {
      counts.push_back(counts_by_name(state.counters));
    }
    return counts;
  }

 private:
  using Outputs = std::pair<RippleOutput, RippleOutput>;
  static constexpr Outputs torque_and_ripple = {RippleOutput::torque, RippleOutput::ripple};

  std::vector<RippleGiven<Real>> run_batch(const Rows& rows, bool angle_referenced,
                                           const Outputs& outputs, VectorLevel level,
                                           std::size_t threads) {
    return run(rows, angle_referenced, outputs,
               [&](const std::vector<RippleChannel<Real>>& channels) {
                 process_batch<Real, batch_pairs>(configs_, states_, channels,
                                                  {.level = level, .thread_count = threads});
               });
  }

  template <class Filter>
  std::vector<RippleGiven<Real>> run(const Rows& rows, bool angle_referenced,
                                     const Outputs& outputs, const Filter& filter) {
    require_same_length("rows", rows.size(), "configs", configs_.size());
    std::vector<RippleChannel<Real>> channels(rows.size());
    std::vector<RippleResultRow<Real>> results;
    results.reserve(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto& [time_s, angle_rad, torque_Nm, expected_Nm] = rows[i];
      const std::size_t size = torque_Nm.shape(0);
      require_same_length("time_s", time_s.shape(0), "torque_Nm", size);
      require_same_length("motor_angle_rad", angle_rad.shape(0), "torque_Nm", size);
      if (expected_Nm) {
        require_same_length("expected_torque_Nm", expected_Nm->shape(0), "torque_Nm", size);
      }
      RippleResultRow<Real>& result = results.emplace_back(size);
      RippleChannel<Real>& channel = channels[i];
      channel.sample_count = size;
      channel.measured_torque_Nm = torque_Nm.data();
      channel.motor_angle_rad = angle_rad.data();
      channel.expected_torque_Nm = expected_Nm ? expected_Nm->data() : nullptr;
      channel.angle_referenced = angle_referenced;
      channel.output(outputs.first) = result.first.data();
      channel.output(outputs.second) = result.second.data();
      channel.status = result.status.data();
    }
    {
      const CallLock::Long running(calls_);
      std::vector<Stamped<Real>> stamps;
      stamps.reserve(rows.size());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        stamps.push_back(
            stamped<Real>(clocks_[i], std::get<0>(rows[i]).data(), channels[i].sample_count));
        channels[i].interval_s = stamps.back().interval_s.data();
      }
      filter(channels);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        for (const auto& [k, status] : stamps[i].remarks) {
          channels[i].status[k] |= status;
        }
      }
    }
    std::vector<RippleGiven<Real>> given;
    given.reserve(results.size());
    for (RippleResultRow<Real>& result : results) {
      given.emplace_back(result.first.give(), result.second.give(), result.status.give());
    }
    return given;
  }

  std::vector<Config> configs_;
  std::vector<LearnedRipple<Real, batch_pairs>> kept_;  ///< empty: from nothing
  std::vector<State> states_;
  std::vector<SampleClock> clocks_;
  CallLock calls_;
};

template <class Real>
void bind_precision(nb::module_& m, const char* name) {
  using Batch = RippleBatch<Real>;
  nb::class_<Batch>(m, name, "Ripple filters side by side, each with its own state.")
      .def(nb::init<const std::vector<RippleConfigD>&, const std::vector<LearnedD>&>(), "configs"_a,
           "learned"_a, "learned: coefficients to start with; none: from nothing.")
      .def("reset", &Batch::reset, "Back to the start, learned coefficients included.")
      .def("process", &Batch::process, "rows"_a, "angle_referenced"_a, "level"_a, "threads"_a,
           "For each channel (time_s, motor_angle_rad, torque_Nm, expected_torque_Nm or None); "
           "returns torque, ripple and status of each.")
      .def("innovations", &Batch::innovations, "rows"_a, "angle_referenced"_a, "level"_a,
           "threads"_a, "The same; returns innovation, its variance and status of each.")
      .def(
          "process_long",
          [](Batch& self, const Batch::Rows& rows, bool angle_referenced, VectorLevel level,
             std::size_t threads, bool in_sequence, double warm_up_memories, double tolerance_Nm,
             double state_tolerance_Nm) {
            const LongOptions options = {.batch = {.level = level, .thread_count = threads},
                                         .in_sequence = in_sequence,
                                         .warm_up_memories = warm_up_memories,
                                         .tolerance_Nm = tolerance_Nm,
                                         .state_tolerance_Nm = state_tolerance_Nm};
            return self.process_one(rows, angle_referenced, options);
          },
          "rows"_a, "angle_referenced"_a, "level"_a, "threads"_a, "in_sequence"_a,
          "warm_up_memories"_a, "tolerance_Nm"_a, "state_tolerance_Nm"_a,
          "One channel's long log in time chunks.")
      .def_prop_ro("counters", &Batch::counters,
                   "For each channel: how often each status flag was raised.");
}

}  // namespace

void bind_batch_ripple(nb::module_& m) {
  m.attr("MOST_LANE_PAIRS") = batch_pairs;
  m.attr("SLOWNESS_OF_FURTHER_PAIRS") = strainwave::detail::slowness_of_further_pairs;
  bind_precision<double>(m, "RippleBatchFloat64");
  bind_precision<float>(m, "RippleBatchFloat32");
}

}  // namespace strainwave::bindings
