// SPDX-License-Identifier: Apache-2.0
/// @file startup.cpp
/// From reset to main(): the vector table, the floating-point unit, the variables.

#include <cstdint>
#include <cstring>

#include "board.hpp"
#include "semihosting.hpp"

// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" {
extern std::uint32_t data_start[], data_end[], data_load[], bss_start[], bss_end[], stack_top[];
int main();
[[noreturn]] void reset_handler();
[[noreturn]] void unexpected_handler();
void systick_handler();
void watchdog_handler();
}
// NOLINTEND(bugprone-reserved-identifier)

/// A fault, or an interrupt nobody asked for.  A motor drive would take its power stage off here.
extern "C" void unexpected_handler() { semihosting::exit(exit_unexpected_exception); }

/// For images that do not use them.
extern "C" __attribute__((weak)) void systick_handler() { unexpected_handler(); }
extern "C" __attribute__((weak)) void watchdog_handler() { unexpected_handler(); }

extern "C" void reset_handler() {
  reg(board::cpacr) |= 0xFU << 20U;  // coprocessors 10 and 11: the floating-point unit
  __asm volatile("dsb\n isb" ::: "memory");
  std::memcpy(
      data_start, data_load,
      reinterpret_cast<std::uintptr_t>(data_end) - reinterpret_cast<std::uintptr_t>(data_start));
  std::memset(
      bss_start, 0,
      reinterpret_cast<std::uintptr_t>(bss_end) - reinterpret_cast<std::uintptr_t>(bss_start));
  semihosting::exit(main());
}

namespace {

using Handler = void (*)();
struct Vectors {
  std::uint32_t* initial_stack;
  Handler handlers[15];
};

}  // namespace

/// System exceptions alone: this image uses no peripheral's interrupt.
extern "C" __attribute__((section(".vectors"), used)) const Vectors vectors = {
    stack_top,
    {reset_handler, watchdog_handler /* NMI */, unexpected_handler, unexpected_handler,
     unexpected_handler, unexpected_handler, unexpected_handler, unexpected_handler,
     unexpected_handler, unexpected_handler, unexpected_handler, unexpected_handler,
     unexpected_handler, unexpected_handler, systick_handler},
};
