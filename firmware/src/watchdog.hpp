// SPDX-License-Identifier: Apache-2.0
/// @file watchdog.hpp
/// The board's watchdog (CMSDK APB): bites where it is not fed in time.
///
/// Its first expiry raises an interrupt, wired to the NMI; its second one, if that interrupt is
/// still pending, resets the processor.  Fed from the background, and only after the sampled
/// interrupt has made progress: a dead interrupt beside a live background is caught, too.
#pragma once

#include <cstdint>

#include "board.hpp"

class Watchdog {
 public:
  /// Starts it with a time in which it has to be fed.
  void start(std::uint32_t milliseconds) {
    reg(board::watchdog + 0xC00) = 0x1ACCE551;  // unlock
    reg(board::watchdog + 0x00) = board::clock_Hz / 1000U * milliseconds;
    reg(board::watchdog + 0x08) = 3;  // interrupt and reset
  }

  /// Feeds it if the interrupt has counted on since the last call.
  void feed_after(std::uint32_t interrupts) {
    if (interrupts != last_) {
      last_ = interrupts;
      reg(board::watchdog + 0x0C) = 1;  // clears the interrupt and reloads the counter
    }
  }

 private:
  std::uint32_t last_ = 0;
};
