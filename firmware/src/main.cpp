// SPDX-License-Identifier: Apache-2.0
/// @file main.cpp
/// The image: samples in the interrupt, prints, saves and feeds the watchdog in the background.
///
/// It lives through four starts, each of which ends in a reset, so that one run of the image shows
/// all there is to show:
///   1  a cold start with what the joint file knows: learns, saves, resets itself
///   2  goes on with what it learned; then its sampled interrupt dies, and the watchdog bites
///   3  goes on again; then a byte of the saved block is spoilt, and it resets itself
///   4  refuses the block and starts from what the joint file knows
///
/// Where the joint's own constants are spoilt there is one start, and no torque.

#include <cstdint>

#include "board.hpp"
#include "console.hpp"
#include "sampling.hpp"
#include "semihosting.hpp"
#include "watchdog.hpp"

namespace {

/// Outlives a reset, as the reason for it does in a register of a real chip.
struct Lives {
  std::uint32_t mark;
  std::uint32_t starts;
  std::uint32_t bites;  ///< of the watchdog
};
__attribute__((section(".noinit"))) Lives lives;

constexpr std::uint32_t lives_mark = 0x4C495645;
constexpr std::uint32_t second = joint::sample_rate_Hz;
constexpr std::uint32_t watchdog_ms = 20;

const char* text_of(keeper::Found found) {
  switch (found) {
    case keeper::Found::restored:
      return "restored";
    case keeper::Found::nothing:
      return "nothing";
    default:
      return "refused";
  }
}

[[noreturn]] void reset() {
  __asm volatile("dsb" ::: "memory");  // what was written is written
  reg(board::reset_control) = 0x05FA0004;
  for (;;) {
  }
}

void print(const sampling::Report& report) {
  console::put("samples=");
  console::put(report.samples);
  console::put(" torque_mNm=");
  console::put_thousandths(report.torque_Nm);
  console::put(" measured_mNm=");
  console::put_thousandths(report.measured_Nm);
  console::put(" load_mNm=");
  console::put_thousandths(report.load_Nm);
  console::put(" mean_square_uNm2=");
  console::put(static_cast<std::uint32_t>(report.mean_square_Nm2 * 1e6F));
  console::put(" intact=");
  console::put(std::uint32_t{report.joint_intact});
  console::put(" status=");
  console::put(report.status);
  console::put("\n");
}

/// The background: until so many samples are through.
void work_until(std::uint32_t samples, Watchdog& watchdog) {
  std::uint32_t printed = 0;
  for (;;) {
    const sampling::Report report = sampling::report();
    watchdog.feed_after(report.samples);
    if (report.samples - printed >= second / 4) {
      printed = report.samples;
      print(report);
    }
    if (report.samples >= samples) {
      return;
    }
  }
}

/// The background goes on, but nothing is sampled any more.
[[noreturn]] void live_on_without_samples(Watchdog& watchdog) {
  for (;;) {
    watchdog.feed_after(sampling::report().samples);
  }
}

/// A spoilt joint is no matter for a reset, after which it would be as spoilt: the image says so
/// and goes on without torque.  A product stays here; the test has seen enough after two rows.
int work_without_torque(Watchdog& watchdog) {
  console::put("fault: the joint's constants are corrupt\n");
  work_until(second / 2, watchdog);
  return exit_corrupt_joint;
}

}  // namespace

/// The watchdog's first expiry.  A product takes its power stage off here; the reset follows.
extern "C" void watchdog_handler() {
  ++lives.bites;
  for (;;) {
  }
}

int main() {
  if (lives.mark != lives_mark) {
    lives = {lives_mark, 0, 0};
  }
  ++lives.starts;
  console::open();
  const keeper::Found found = sampling::start();
  Watchdog watchdog;
  watchdog.start(watchdog_ms);
  console::put("start=");
  console::put(lives.starts);
  console::put(" learned=");
  console::put(text_of(found));
  console::put(" watchdog_bites=");
  console::put(lives.bites);
  console::put("\n");
  if (!sampling::report().joint_intact) {
    return work_without_torque(watchdog);
  }
  switch (lives.starts) {
    case 1:
      work_until(2 * second, watchdog);
      keeper::save(sampling::learned());
      reset();
    case 2:
      work_until(second / 4, watchdog);
      sampling::break_down();
      live_on_without_samples(watchdog);
    case 3:
      work_until(second / 4, watchdog);
      keeper::block.words[keeper::Block::size / 2] ^= 0x10U;
      reset();
    default:
      work_until(second / 4, watchdog);
      return 0;
  }
}
