// SPDX-License-Identifier: Apache-2.0
/// @file checksum.hpp
/// A checksum of values: the same number from the compiler, from the chip's memory and from Python.
///
/// CRC-32 as in IEEE 802.3 (reflected, polynomial 0x04C11DB7) over the values' bytes, lowest first:
/// every change of up to 32 neighbouring bits is found, and of others all but one in 2^32.  Values
/// are taken one after the other, without the padding between them.  At run time each byte is read
/// from memory, so that the compiler cannot answer for the flash.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace strainwave {

/// A checksum that is being made.
struct Checksum {
  std::uint32_t remainder = 0xFFFFFFFFU;
};

/// The finished checksum.
[[nodiscard]] constexpr std::uint32_t value_of(const Checksum& checksum) {
  return ~checksum.remainder;
}

namespace detail {

/// Remainders of the sixteen half bytes: 64 bytes of flash, and a compiler is done with it soon.
inline constexpr std::uint32_t half_byte_remainders[16] = {
    0x00000000U, 0x1DB71064U, 0x3B6E20C8U, 0x26D930ACU, 0x76DC4190U, 0x6B6B51F4U,
    0x4DB26158U, 0x5005713CU, 0xEDB88320U, 0xF00F9344U, 0xD6D6A3E8U, 0xCB61B38CU,
    0x9B64C2B0U, 0x86D3D2D4U, 0xA00AE278U, 0xBDBDF21CU};

constexpr void take_byte(Checksum& checksum, std::uint32_t byte) {
  std::uint32_t rest = checksum.remainder ^ byte;
  rest = (rest >> 4U) ^ half_byte_remainders[rest & 15U];
  checksum.remainder = (rest >> 4U) ^ half_byte_remainders[rest & 15U];
}

template <class Bits>
constexpr void take_bits(Checksum& checksum, Bits bits) {
  for (std::size_t i = 0; i < sizeof(Bits); ++i) {
    take_byte(checksum, static_cast<std::uint32_t>(bits >> (8U * i)) & 0xFFU);
  }
}

/// The whole number that has a value's bits.
template <class Value>
using BitsOf = std::conditional_t<
    sizeof(Value) == 1, std::uint8_t,
    std::conditional_t<sizeof(Value) == 2, std::uint16_t,
                       std::conditional_t<sizeof(Value) == 4, std::uint32_t, std::uint64_t>>>;

/// Takes in a number's bytes as they lie in memory now, whatever the compiler knows of it, and
/// zeros above them.  One function for all of them, because it runs once and flash is dear.
#if defined(__GNUC__)
[[gnu::noinline]]
#endif
inline void take_memory(Checksum& checksum, const void* number, std::size_t size,
                        std::size_t zeros) {
  const auto* const memory = static_cast<const volatile unsigned char*>(number);
  for (std::size_t i = 0; i < size; ++i) {
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    take_byte(checksum, memory[size - 1 - i]);
#else
    take_byte(checksum, memory[i]);
#endif
  }
  for (std::size_t i = 0; i < zeros; ++i) {
    take_byte(checksum, 0);
  }
}

}  // namespace detail

/// Takes in one number, truth value or enumerator.
template <class Value>
  requires(std::is_arithmetic_v<Value> || std::is_enum_v<Value>)
constexpr void take(Checksum& checksum, const Value& value) {
  static_assert(sizeof(Value) <= 8, "strainwave: a checksum takes numbers of at most 64 bits");
  if (std::is_constant_evaluated()) {
    detail::take_bits(checksum, __builtin_bit_cast(detail::BitsOf<Value>, value));
  } else {
    detail::take_memory(checksum, &value, sizeof(Value), 0);
  }
}

/// Takes in a count, with as many bytes on every platform.
constexpr void take_count(Checksum& checksum, const std::size_t& count) {
  if (std::is_constant_evaluated()) {
    detail::take_bits(checksum, std::uint64_t{count});
  } else {
    detail::take_memory(checksum, &count, sizeof(count), 8 - sizeof(count));
  }
}

}  // namespace strainwave
