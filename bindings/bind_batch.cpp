// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <span>
#include <vector>

#include "bind_oscillator_filter.hpp"
#include "bind_status.hpp"
#include "strainwave/batch.hpp"
#include "strainwave/batch_long.hpp"

namespace strainwave::bindings {

using namespace nb::literals;

namespace {

template <class Number>
using Writable = nb::ndarray<Number, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <class Array>
using Rows = std::optional<std::vector<Array>>;

void require_available(VectorLevel level) {
  if (!is_available(level)) {
    raise_input_error(
        "level: this processor does not have it; leave it out, or take one of "
        "available_vector_levels()");
  }
}

/// One row for each channel, each as long as the channel.
template <class Array, class Number>
void put_rows(const char* name, const Rows<Array>& rows,
              std::vector<OscillatorChannel<std::remove_const_t<Number>>>& channels,
              Number* OscillatorChannel<std::remove_const_t<Number>>::* member) {
  if (!rows) {
    return;
  }
  require_same_length(name, rows->size(), "configs", channels.size());
  for (std::size_t i = 0; i < channels.size(); ++i) {
    require_same_length(name, (*rows)[i].shape(0), "torque_Nm", channels[i].sample_count);
    channels[i].*member = (*rows)[i].data();
  }
}

template <class Real>
class Batch {
 public:
  using Config = OscillatorFilterConfig<Real, most_orders>;
  using State = OscillatorFilterState<Real, most_orders>;
  using Channel = OscillatorChannel<Real>;

  explicit Batch(const std::vector<OscillatorConfigD>& configs) {
    for (const OscillatorConfigD& each : configs) {
      const auto config = converted<Real, most_orders>(each);
      require(check(config));  // what double holds may vanish or overflow in float
      if (config.rotation_source != RotationSource::speed) {
        raise_input_error(
            "configs turn by angle: expected rotation_source speed; take OscillatorFilter for "
            "recordings of the angle");
      }
      configs_.push_back(config);
    }
    reset();
  }

  void reset() {
    calls_.wait();
    states_.clear();
    for (const Config& config : configs_) {
      states_.push_back(initial_state(config));
    }
  }

  void process(const std::vector<Vector<Real>>& torque_Nm,
               const std::vector<Vector<Real>>& speed_rad_s, const Rows<Vector<Real>>& expected_Nm,
               const Rows<Writable<Real>>& clean_Nm, const Rows<Writable<Real>>& ripple_Nm,
               const Rows<Writable<std::uint32_t>>& status, VectorLevel level,
               std::size_t threads) {
    require_available(level);
    const std::vector<Channel> channels =
        to_channels(torque_Nm, speed_rad_s, expected_Nm, clean_Nm, ripple_Nm, status);
    const CallLock::Long running(calls_);
    process_batch<Real, most_orders>(configs_, states_, channels,
                                     {.level = level, .thread_count = threads});
  }

  [[nodiscard]] LongReport process_one(const Vector<Real>& torque_Nm,
                                       const Vector<Real>& speed_rad_s,
                                       const std::optional<Vector<Real>>& expected_Nm,
                                       const std::optional<Writable<Real>>& clean_Nm,
                                       const std::optional<Writable<Real>>& ripple_Nm,
                                       const std::optional<Writable<std::uint32_t>>& status,
                                       const LongOptions& options) {
    require_available(options.batch.level);
    const std::vector<Channel> channels =
        to_channels({torque_Nm}, {speed_rad_s}, to_rows(expected_Nm), to_rows(clean_Nm),
                    to_rows(ripple_Nm), to_rows(status));
    const CallLock::Long running(calls_);
    return process_long(configs_[0], states_[0], channels[0], options);
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
  template <class Array>
  [[nodiscard]] static Rows<Array> to_rows(const std::optional<Array>& row) {
    return row ? Rows<Array>(std::vector<Array>{*row}) : std::nullopt;
  }

  [[nodiscard]] std::vector<Channel> to_channels(
      const std::vector<Vector<Real>>& torque_Nm, const std::vector<Vector<Real>>& speed_rad_s,
      const Rows<Vector<Real>>& expected_Nm, const Rows<Writable<Real>>& clean_Nm,
      const Rows<Writable<Real>>& ripple_Nm, const Rows<Writable<std::uint32_t>>& status) const {
    require_same_length("torque_Nm", torque_Nm.size(), "configs", configs_.size());
    std::vector<Channel> channels(configs_.size());
    for (std::size_t i = 0; i < channels.size(); ++i) {
      channels[i].sample_count = torque_Nm[i].shape(0);
      channels[i].measured_torque_Nm = torque_Nm[i].data();
    }
    put_rows<Vector<Real>>("motor_speed_rad_s", Rows<Vector<Real>>(speed_rad_s), channels,
                           &Channel::motor_speed_rad_s);
    put_rows("expected_torque_Nm", expected_Nm, channels, &Channel::expected_torque_Nm);
    put_rows("clean_torque_Nm", clean_Nm, channels, &Channel::torque_Nm);
    put_rows("ripple_Nm", ripple_Nm, channels, &Channel::ripple_Nm);
    if (status) {
      require_same_length("status", status->size(), "configs", channels.size());
      for (std::size_t i = 0; i < channels.size(); ++i) {
        require_same_length("status", (*status)[i].shape(0), "torque_Nm", channels[i].sample_count);
        channels[i].status = (*status)[i].data();
      }
    }
    return channels;
  }

  std::vector<Config> configs_;
  std::vector<State> states_;
  CallLock calls_;
};

template <class Real>
void bind_precision(nb::module_& m, const char* name) {
  nb::class_<Batch<Real>>(m, name, "Published filters side by side, each with its own state.")
      .def(nb::init<const std::vector<OscillatorConfigD>&>(), "configs"_a)
      .def("reset", &Batch<Real>::reset, "Back to x(0) and P(0).")
      .def("process", &Batch<Real>::process, "torque_Nm"_a.noconvert(),
           "motor_speed_rad_s"_a.noconvert(), "expected_torque_Nm"_a.noconvert().none(),
           "clean_torque_Nm"_a.noconvert().none(), "ripple_Nm"_a.noconvert().none(),
           "status"_a.noconvert().none(), "level"_a, "threads"_a,
           "A row for each channel; results are written into the rows that are given.")
      .def(
          "process_long",
          [](Batch<Real>& self, const Vector<Real>& torque_Nm, const Vector<Real>& speed_rad_s,
             const std::optional<Vector<Real>>& expected_Nm,
             const std::optional<Writable<Real>>& clean_Nm,
             const std::optional<Writable<Real>>& ripple_Nm,
             const std::optional<Writable<std::uint32_t>>& status, VectorLevel level,
             std::size_t threads, bool in_sequence, double warm_up_memories, double tolerance_Nm) {
            LongOptions options;
            options.batch = {.level = level, .thread_count = threads};
            options.in_sequence = in_sequence;
            options.warm_up_memories = warm_up_memories;
            options.tolerance_Nm = tolerance_Nm;
            options.state_tolerance_Nm = state_tolerance_ratio * tolerance_Nm;
            return self.process_one(torque_Nm, speed_rad_s, expected_Nm, clean_Nm, ripple_Nm,
                                    status, options);
          },
          "torque_Nm"_a.noconvert(), "motor_speed_rad_s"_a.noconvert(),
          "expected_torque_Nm"_a.noconvert().none(), "clean_torque_Nm"_a.noconvert().none(),
          "ripple_Nm"_a.noconvert().none(), "status"_a.noconvert().none(), "level"_a, "threads"_a,
          "in_sequence"_a, "warm_up_memories"_a, "tolerance_Nm"_a,
          "One channel's long log in time chunks.")
      .def_prop_ro("counters", &Batch<Real>::counters,
                   "For each channel: how often each status flag was raised.");
}

}  // namespace

void bind_batch(nb::module_& m) {
  nb::enum_<VectorLevel>(m, "VectorLevel", "What the processor can do with vectors.")
      .value("one_by_one", VectorLevel::one_by_one, "no vectors: channel after channel")
      .value("portable", VectorLevel::portable, "16 bytes; NEON on aarch64")
      .value("x86_64_v2", VectorLevel::x86_64_v2, "16 bytes, SSE 4.2")
      .value("x86_64_v3", VectorLevel::x86_64_v3, "32 bytes, AVX2 and fused products")
      .value("x86_64_v4", VectorLevel::x86_64_v4, "64 bytes, AVX-512");
  m.def("best_vector_level", &best_vector_level, "The highest level that this processor has.");
  m.def("is_available", &is_available, "level"_a, "Whether this processor has the level.");

  nb::class_<LongReport>(m, "LongReport",
                         "How a long log was cut, and how far it is from one in sequence.")
      .def_ro("chunk_count", &LongReport::chunk_count, "1: in sequence.")
      .def_ro("repeated_chunks", &LongReport::repeated_chunks,
              "Filtered again in sequence, because they differed too much.")
      .def_ro("warm_up_samples", &LongReport::warm_up_samples, "Filtered twice.")
      .def_ro("largest_ripple_difference_Nm", &LongReport::largest_ripple_difference_Nm)
      .def_ro("rms_ripple_difference_Nm", &LongReport::rms_ripple_difference_Nm)
      .def_ro("largest_state_difference_Nm", &LongReport::largest_state_difference_Nm);

  bind_precision<double>(m, "OscillatorBatchFloat64");
  bind_precision<float>(m, "OscillatorBatchFloat32");
}

}  // namespace strainwave::bindings
