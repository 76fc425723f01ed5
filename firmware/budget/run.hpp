// SPDX-License-Identifier: Apache-2.0
/// @file run.hpp
/// One subject measured: a State, a Sample, how it is made sample by sample, and its update.
#pragma once

#include "measure.hpp"

namespace measure {

template <class Subject>
struct Bench {
  using State = typename Subject::State;
  using Sample = typename Subject::Sample;
  using Update = void (*)(State&, const Sample&);

  Subject subject;
  State state = Subject::initial();
  State copy = state;
  Sample samples[block_length] = {};

  void prepare(bool with_faults) {
    for (Sample& each : samples) {
      each = subject.next(with_faults);
    }
  }

  /// A block of updates, ticks.
  [[gnu::noinline]] std::uint32_t run_block(Update update) {
    const std::uint32_t before = ticks();
    for (const Sample& each : samples) {
      update(state, each);
    }
    return ticks_between(before, ticks());
  }

  /// The same update again and again from the same state, ticks: one tick is some 40 instructions,
  /// too coarse for a single one.
  [[gnu::noinline]] std::uint32_t run_repeated(Update update, const Sample& sample) {
    const std::uint32_t before = ticks();
    for (std::uint32_t i = 0; i < instructions_per_tick; ++i) {
      copy = state;
      update(copy, sample);
    }
    return ticks_between(before, ticks());
  }
};

template <class State, class Sample>
[[gnu::noinline]] void no_update(State&, const Sample&) {
  __asm volatile("" ::: "memory");
}

/// Prints what the subject costs.  `update` is the function whose cost it is.
template <class Subject>
int run(typename Bench<Subject>::Update update) {
  using State = typename Subject::State;
  using Sample = typename Subject::Sample;
  static Bench<Subject> bench;
  console::open();
  start_clock();
  if (semihosting::last_argument_is("trace")) {
    for (std::uint32_t b = 0; b < traced_blocks; ++b) {
      bench.prepare(false);
      for (const Sample& each : bench.samples) {
        update(bench.state, each);
      }
    }
    return 0;
  }
  for (std::uint32_t b = 0; b < warm_up_blocks; ++b) {
    bench.prepare(false);
    (void)bench.run_block(update);
  }
  std::uint32_t counted = 0;
  std::uint32_t empty = 0;
  for (std::uint32_t b = 0; b < counted_blocks; ++b) {
    bench.prepare(false);
    empty += bench.run_block(no_update<State, Sample>);
    counted += bench.run_block(update);
  }
  const std::uint32_t updates = counted_blocks * block_length;
  print("instructions_x100", (counted - empty) * instructions_per_tick * 100U / updates);

  std::uint32_t dearest[2] = {};
  for (std::uint32_t faults = 0; faults < 2; ++faults) {
    for (std::uint32_t b = 0; b < Subject::fault_blocks; ++b) {
      bench.prepare(faults == 1);
      for (const Sample& each : bench.samples) {
        const std::uint32_t cost =
            bench.run_repeated(update, each) - bench.run_repeated(no_update<State, Sample>, each);
        dearest[faults] = cost > dearest[faults] ? cost : dearest[faults];
        update(bench.state, each);
      }
    }
  }
  print("dearest_sound_instructions", dearest[0]);
  print("worst_instructions", dearest[1]);

  paint_stack();
  bench.prepare(true);
  (void)bench.run_block(update);
  const std::uint32_t used = painted_over_bytes();
  paint_stack();
  (void)bench.run_block(no_update<State, Sample>);
  print("stack_bytes", used - painted_over_bytes());
  print("state_bytes", static_cast<std::uint32_t>(sizeof(State)));
  print("config_bytes", Subject::config_bytes);
  return 0;
}

}  // namespace measure
