// SPDX-License-Identifier: Apache-2.0
/// @file learned_block.hpp
/// What a ripple filter has learned, as words for a flash page, an EEPROM or backup memory.
///
/// A block is whole or it is refused: it says what it is, and ends with a checksum.  Erased memory,
/// a write that power loss cut short, another precision and another joint's orders are all found.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/checksum.hpp"
#include "strainwave/learned_ripple.hpp"
#include "strainwave/torque_sensor.hpp"

namespace strainwave {

/// Why a block cannot be used.
enum class BlockFault : std::uint8_t {
  none = 0,
  damaged = 1,       ///< erased, never written, cut short, or bits have flipped
  other_format = 2,  ///< of another precision, capacity or version of this layout
  other_filter = 3,  ///< sound, but of other orders and terms, or with values out of range
};

/// First word of every block: "SWLR".
inline constexpr std::uint32_t learned_block_mark = 0x524C5753U;
/// Version of the layout below.
inline constexpr std::uint32_t learned_block_version = 1;

/// mark, layout, number of orders; numerator, denominator and terms of each order; coefficients,
/// their standard deviations and the innovations' scale; checksum.
template <class Real, std::size_t MaxPairs>
struct LearnedBlock {
  static constexpr std::size_t words_per_real = sizeof(Real) / 4;
  static constexpr std::size_t size = 4 + 3 * MaxPairs + (4 * MaxPairs + 1) * words_per_real;

  std::uint32_t words[size] = {};
};

namespace detail {

/// What the second word says: layout, precision, capacity.
template <class Real, std::size_t MaxPairs>
inline constexpr std::uint32_t learned_block_layout =
    learned_block_version << 24U | static_cast<std::uint32_t>(sizeof(Real)) << 16U |
    static_cast<std::uint32_t>(MaxPairs);

/// Goes through a block's words one after the other.
struct BlockPlace {
  std::uint32_t* words = nullptr;
  std::size_t next = 0;

  constexpr void put(std::uint32_t word) { words[next++] = word; }
  template <class Real>
  constexpr void put_real(Real value) {
    const auto bits = __builtin_bit_cast(BitsOf<Real>, value);
    for (std::size_t i = 0; i < sizeof(Real); i += 4) {
      put(static_cast<std::uint32_t>(bits >> (8U * i)));
    }
  }
};

struct ConstBlockPlace {
  const std::uint32_t* words = nullptr;
  std::size_t next = 0;

  constexpr std::uint32_t get() { return words[next++]; }
  template <class Real>
  constexpr Real get_real() {
    BitsOf<Real> bits = 0;
    for (std::size_t i = 0; i < sizeof(Real); i += 4) {
      bits |= static_cast<BitsOf<Real>>(get()) << (8U * i);
    }
    return __builtin_bit_cast(Real, bits);
  }
};

[[nodiscard]] constexpr std::uint32_t checksum_of_words(const std::uint32_t* words,
                                                        std::size_t count) {
  Checksum checksum;
  for (std::size_t i = 0; i < count; ++i) {
    take_bits(checksum, words[i]);
  }
  return value_of(checksum);
}

[[nodiscard]] constexpr std::uint32_t terms_of(const RippleOrder& order) {
  return (order.with_load ? 1U : 0U) | (order.with_speed ? 2U : 0U) |
         (order.with_direction ? 4U : 0U) | (order.keep ? 8U : 0U);
}

}  // namespace detail

/// Writes learned coefficients as a block.
template <class Real, std::size_t MaxPairs>
constexpr void pack(const LearnedRipple<Real, MaxPairs>& kept,
                    LearnedBlock<Real, MaxPairs>& block) {
  detail::BlockPlace place = {block.words};
  place.put(learned_block_mark);
  place.put(detail::learned_block_layout<Real, MaxPairs>);
  place.put(static_cast<std::uint32_t>(kept.order_count));
  for (const RippleOrder& order : kept.orders) {
    place.put(order.order.numerator);
    place.put(order.order.denominator);
    place.put(detail::terms_of(order));
  }
  for (const Real& coefficient_Nm : kept.coefficients_Nm) {
    place.put_real(coefficient_Nm);
  }
  for (const Real& deviation_Nm : kept.standard_deviations_Nm) {
    place.put_real(deviation_Nm);
  }
  place.put_real(kept.innovation_scale_Nm);
  place.put(detail::checksum_of_words(block.words, place.next));
}

/// Reads a block; `kept` is changed only where it is sound.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr BlockFault unpack(const LearnedBlock<Real, MaxPairs>& block,
                                          LearnedRipple<Real, MaxPairs>& kept) {
  constexpr std::size_t last = LearnedBlock<Real, MaxPairs>::size - 1;
  if (block.words[0] != learned_block_mark) {
    return BlockFault::damaged;
  }
  if (block.words[1] != detail::learned_block_layout<Real, MaxPairs>) {
    return BlockFault::other_format;
  }
  if (block.words[last] != detail::checksum_of_words(block.words, last)) {
    return BlockFault::damaged;
  }
  detail::ConstBlockPlace place = {block.words, 2};
  kept.order_count = place.get();
  for (RippleOrder& order : kept.orders) {
    order.order.numerator = place.get();
    order.order.denominator = place.get();
    const std::uint32_t terms = place.get();
    order.with_load = (terms & 1U) != 0U;
    order.with_speed = (terms & 2U) != 0U;
    order.with_direction = (terms & 4U) != 0U;
    order.keep = (terms & 8U) != 0U;
  }
  for (Real& coefficient_Nm : kept.coefficients_Nm) {
    coefficient_Nm = place.template get_real<Real>();
  }
  for (Real& deviation_Nm : kept.standard_deviations_Nm) {
    deviation_Nm = place.template get_real<Real>();
  }
  kept.innovation_scale_Nm = place.template get_real<Real>();
  return BlockFault::none;
}

/// Keeps what a sensor's ripple filter has learned.
template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
inline void save_learned(const RippleSensorConfig<Real, MaxGauges, MaxPairs>& config,
                         const RippleSensorState<Real, MaxGauges, MaxPairs>& state,
                         LearnedBlock<Real, MaxPairs>& block) {
  pack(learned(config.filter, state.filter), block);
}

/// Lets a sensor's ripple filter start anew with a block's coefficients; where the block cannot be
/// used, the state stays as it is.
template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
[[nodiscard]] inline BlockFault restore_learned(
    const RippleSensorConfig<Real, MaxGauges, MaxPairs>& config,
    RippleSensorState<Real, MaxGauges, MaxPairs>& state,
    const LearnedBlock<Real, MaxPairs>& block) {
  LearnedRipple<Real, MaxPairs> kept;
  if (const BlockFault fault = unpack(block, kept); fault != BlockFault::none) {
    return fault;
  }
  if (!check(config.filter, kept).ok()) {
    return BlockFault::other_filter;
  }
  state.filter = restored(config.filter, kept);
  return BlockFault::none;
}

}  // namespace strainwave
