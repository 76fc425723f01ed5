// SPDX-License-Identifier: Apache-2.0
/// @file keeper.hpp
/// Keeps what the filter has learned over a reset, and believes it only after checking it.
///
/// The block lies in RAM that the start-up leaves alone; on a product it would lie in flash, and
/// two in turn would outlive a loss of power during saving, too.
#pragma once

#include "joint.hpp"
#include "strainwave/learned_block.hpp"

namespace keeper {

using Block = strainwave::LearnedBlock<float, joint::pairs>;

/// What became of it at the start.
enum class Found : std::uint8_t {
  restored,
  nothing,  ///< never saved: no fault
  refused,  ///< damaged, or of another filter; the filter starts from the joint file
};

extern Block block;

/// Takes over what the filter knows; called from the background.
void save(const strainwave::LearnedRipple<float, joint::pairs>& learned);

/// Lets the filter start with what was saved, where that can be believed.
Found restore(joint::SensorState& state);

}  // namespace keeper
