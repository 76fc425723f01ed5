// SPDX-License-Identifier: Apache-2.0
/// @file keeper.hpp
/// Keeps what the filter has learned over a reset, and believes a block only after checking it.
///
/// The block lies in RAM that the start-up leaves alone; on a product it would lie in flash.  It is
/// believed where its mark, its joint and its checksum are right and the coefficients themselves
/// are sound.
#pragma once

#include <cstddef>
#include <cstdint>

#include "joint.hpp"
#include "strainwave/learned_ripple.hpp"

namespace keeper {

using Learned = strainwave::LearnedRipple<float, joint::pairs>;

struct Block {
  std::uint32_t mark;
  std::uint32_t joint;  ///< checksum of the configuration that the coefficients belong to
  std::uint32_t saved;  ///< how often
  unsigned char learned[sizeof(Learned)];
  std::uint32_t checksum;  ///< of all above
};

/// What became of the block at the start.
enum class Found : std::uint8_t { restored, nothing, corrupted, of_another_joint };

inline constexpr std::uint32_t mark = 0x53574C31;  ///< "SWL1"

/// The one block; two in turn would outlive a loss of power during saving, too.
extern Block block;

/// Takes over what the filter knows; called from the background.
void save(const Learned& learned);

/// The filter's state to start with: what was learned where that can be believed, else the
/// configuration's own start.
Found restore(joint::SensorState& state);

}  // namespace keeper
