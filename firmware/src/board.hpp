// SPDX-License-Identifier: Apache-2.0
/// @file board.hpp
/// Addresses and clocks of the boards, and registers by address.
#pragma once

#include <cstdint>

/// A device register.
inline volatile std::uint32_t& reg(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

namespace board {

#if defined(BOARD_MPS2_AN505)
inline constexpr const char* name = "mps2-an505 (Cortex-M33)";
inline constexpr std::uint32_t clock_Hz = 20'000'000;
inline constexpr std::uintptr_t uart = 0x50200000;
inline constexpr std::uintptr_t watchdog = 0x50081000;
#elif defined(BOARD_MPS2_AN500)
inline constexpr const char* name = "mps2-an500 (Cortex-M7)";
inline constexpr std::uint32_t clock_Hz = 25'000'000;
inline constexpr std::uintptr_t uart = 0x40004000;
inline constexpr std::uintptr_t watchdog = 0x40008000;
#elif defined(BOARD_MPS2_AN386)
inline constexpr const char* name = "mps2-an386 (Cortex-M4F)";
inline constexpr std::uint32_t clock_Hz = 25'000'000;
inline constexpr std::uintptr_t uart = 0x40004000;
inline constexpr std::uintptr_t watchdog = 0x40008000;
#else
#error "strainwave: no such board; say -DBOARD_MPS2_AN386, _AN500 or _AN505"
#endif

// The core's own registers, the same on every Cortex-M.
inline constexpr std::uintptr_t systick_control = 0xE000E010;
inline constexpr std::uintptr_t systick_reload = 0xE000E014;
inline constexpr std::uintptr_t systick_value = 0xE000E018;
inline constexpr std::uintptr_t reset_control = 0xE000ED0C;  ///< AIRCR
inline constexpr std::uintptr_t cpacr = 0xE000ED88;

}  // namespace board

/// Exit codes of an image, as the test sees them.
inline constexpr int exit_unexpected_exception = 70;
inline constexpr int exit_corrupt_joint = 71;
