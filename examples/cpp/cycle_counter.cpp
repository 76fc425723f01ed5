// What an update costs on a real Cortex-M4, M7 or M33, by its own cycle counter.
//
// Call `measure_cycles()` once at start-up, with the interrupts off and the clock, caches and flash
// accelerator set as in the product, and look at the result in a debugger. The counter counts what
// an emulator cannot: wait states, pipeline, caches.
#include <cstdint>

#include "first.hpp"

namespace {

volatile std::uint32_t& reg(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

constexpr std::uintptr_t debug_control = 0xE000EDFC;    // DEMCR
constexpr std::uintptr_t dwt_control = 0xE0001000;      // DWT_CTRL
constexpr std::uintptr_t dwt_cycles = 0xE0001004;       // DWT_CYCCNT
constexpr std::uintptr_t dwt_lock_access = 0xE0001FB0;  // DWT_LAR, on the Cortex-M7

void start_counter() {
  reg(debug_control) |= 1U << 24U;  // trace on
  reg(dwt_lock_access) = 0xC5ACCE55U;
  reg(dwt_cycles) = 0;
  reg(dwt_control) |= 1U;
}

// Flattened, so that the constant configuration folds into the update.
[[gnu::noinline, gnu::flatten]] float update(std::int32_t code, std::int64_t counts,
                                             std::uint32_t sample) {
  return torque_Nm(code, counts, sample);
}

}  // namespace

struct Cycles {
  std::uint32_t least = 0xFFFFFFFFU;
  std::uint32_t most = 0;
  std::uint32_t mean = 0;
};

Cycles measured;  // for the debugger
volatile float last_torque_Nm;

void measure_cycles() {
  constexpr std::uint32_t updates = 4096;
  start_counter();
  std::uint32_t sum = 0;
  for (std::uint32_t k = 1; k <= updates; ++k) {
    // A motor at 150 rad/s, and a converter that sees something.
    const auto code = static_cast<std::int32_t>(32768U + 97U * (k % 64U));
    const std::uint32_t before = reg(dwt_cycles);
    last_torque_Nm = update(code, std::int64_t{98} * k, k);
    const std::uint32_t cycles = reg(dwt_cycles) - before;  // right across the wrap
    sum += cycles;
    measured.least = cycles < measured.least ? cycles : measured.least;
    measured.most = cycles > measured.most ? cycles : measured.most;
  }
  measured.mean = sum / updates;
}
