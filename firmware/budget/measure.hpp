// SPDX-License-Identifier: Apache-2.0
/// @file measure.hpp
/// What one update costs: instructions, typical and worst, state and stack.
///
/// Under `qemu -icount shift=0` an instruction takes 1 ns of simulated time, and SysTick counts
/// that time at the board's clock; counts are the same in every run.
#pragma once

#include <cstddef>
#include <cstdint>

#include "board.hpp"
#include "console.hpp"
#include "semihosting.hpp"

namespace measure {

inline constexpr std::uint32_t instructions_per_tick = 1'000'000'000U / board::clock_Hz;

inline void start_clock() {
  reg(board::systick_reload) = 0xFFFFFF;
  reg(board::systick_value) = 0;
  reg(board::systick_control) = 5;  // the processor's clock, no interrupt
}

inline std::uint32_t ticks() { return reg(board::systick_value); }
/// From an earlier reading to a later one; the clock counts down, in 24 bits.
inline std::uint32_t ticks_between(std::uint32_t earlier, std::uint32_t later) {
  return (earlier - later) & 0xFFFFFFU;
}

/// The stack below here is painted, and looked at afterwards.
inline constexpr std::uint32_t paint = 0xA5A5A5A5U;
extern "C" std::uint32_t stack_limit[];

[[gnu::always_inline]] inline std::uint32_t* stack_pointer() {
  std::uint32_t* sp = nullptr;
  __asm volatile("mov %0, sp" : "=r"(sp));
  return sp;
}

[[gnu::always_inline]] inline void paint_stack() {
  for (volatile std::uint32_t* word = stack_limit; word < stack_pointer(); ++word) {
    *word = paint;
  }
}

[[gnu::always_inline]] inline std::uint32_t painted_over_bytes() {
  const std::uint32_t* word = stack_limit;
  while (word < stack_pointer() && *word == paint) {
    ++word;
  }
  return static_cast<std::uint32_t>(stack_pointer() - word) * 4U;
}

/// Samples prepared at a time: making them is no part of what is counted.
inline constexpr std::uint32_t block_length = 64;
inline constexpr std::uint32_t warm_up_blocks = 64;
inline constexpr std::uint32_t counted_blocks = 64;
/// Of a run whose every instruction is logged: until the speed, smoothed over 10 ms, is there.
inline constexpr std::uint32_t traced_blocks = 4;

inline void print(const char* key, std::uint32_t value) {
  console::put(key);
  console::put("=");
  console::put(value);
  console::put("\n");
}

}  // namespace measure
