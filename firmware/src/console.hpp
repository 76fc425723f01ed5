// SPDX-License-Identifier: Apache-2.0
/// @file console.hpp
/// Text and whole numbers on the board's serial line.  No printf: it would bring a heap.
#pragma once

#include <cstddef>
#include <cstdint>

#include "board.hpp"

namespace console {

inline void open() {
  reg(board::uart + 0x10) = 16;  // fastest divisor the device takes
  reg(board::uart + 0x08) = 1;   // transmit
}

inline void put(char c) {
  while ((reg(board::uart + 0x04) & 1U) != 0U) {  // the transmitter is full
  }
  reg(board::uart) = static_cast<std::uint8_t>(c);
}

inline void put(const char* text) {
  for (; *text != '\0'; ++text) {
    put(*text);
  }
}

inline void put(std::uint32_t number) {
  char digits[10];
  std::size_t count = 0;
  do {
    digits[count++] = static_cast<char>('0' + number % 10U);
    number /= 10U;
  } while (number != 0U);
  while (count > 0) {
    put(digits[--count]);
  }
}

inline void put(std::int32_t number) {
  if (number < 0) {
    put('-');
  }
  const auto bits = static_cast<std::uint32_t>(number);
  put(number < 0 ? 0U - bits : bits);
}

/// A number in thousandths of its unit, rounded.
inline void put_thousandths(float value) {
  put(static_cast<std::int32_t>(value * 1000.0F + (value < 0.0F ? -0.5F : 0.5F)));
}

}  // namespace console
