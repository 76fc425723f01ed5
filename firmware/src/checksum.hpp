// SPDX-License-Identifier: Apache-2.0
/// @file checksum.hpp
/// CRC-32 as Ethernet and zip have it: reflected polynomial 0xEDB88320.
#pragma once

#include <cstddef>
#include <cstdint>

/// Bit by bit: a block is checked at the start and when it is saved, not in the sample path.
constexpr std::uint32_t crc32(const unsigned char* bytes, std::size_t count) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (std::size_t i = 0; i < count; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc >> 1U) ^ ((crc & 1U) != 0U ? 0xEDB88320U : 0U);
    }
  }
  return ~crc;
}

namespace checksum_examples {
// The check value of the catalogues: CRC-32 of the digits 1 to 9.
inline constexpr unsigned char digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
static_assert(crc32(digits, sizeof(digits)) == 0xCBF43926U);
}  // namespace checksum_examples
