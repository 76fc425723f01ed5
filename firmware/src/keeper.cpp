// SPDX-License-Identifier: Apache-2.0
/// @file keeper.cpp
/// Saving and restoring what the filter has learned.

#include "keeper.hpp"

namespace keeper {

__attribute__((section(".noinit"))) Block block;

void save(const strainwave::LearnedRipple<float, joint::pairs>& learned) { pack(learned, block); }

Found restore(joint::SensorState& state) {
  if (block.words[0] == 0) {
    return Found::nothing;  // as memory is that was never written; flash would be all ones
  }
  const auto fault = restore_learned(joint::sensor, state, block);
  return fault == strainwave::BlockFault::none ? Found::restored : Found::refused;
}

}  // namespace keeper
