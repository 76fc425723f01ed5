// SPDX-License-Identifier: Apache-2.0
/// @file keeper.cpp
/// Saving and restoring what the filter has learned.

#include "keeper.hpp"

#include <cstring>

#include "checksum.hpp"

namespace keeper {

__attribute__((section(".noinit"))) Block block;

namespace {

std::uint32_t checksum_of(const Block& of) {
  return crc32(reinterpret_cast<const unsigned char*>(&of), offsetof(Block, checksum));
}

std::uint32_t joint_checksum() {
  return crc32(reinterpret_cast<const unsigned char*>(&joint::sensor.filter),
               sizeof(joint::sensor.filter));
}

}  // namespace

void save(const Learned& learned) {
  const std::uint32_t saved = block.mark == mark ? block.saved + 1 : 1;
  std::memset(&block, 0, sizeof(block));
  block.mark = mark;
  block.joint = joint_checksum();
  block.saved = saved;
  std::memcpy(block.learned, &learned, sizeof(learned));
  block.checksum = checksum_of(block);
}

Found restore(joint::SensorState& state) {
  if (block.mark != mark) {
    return Found::nothing;
  }
  if (checksum_of(block) != block.checksum) {
    return Found::corrupted;
  }
  if (block.joint != joint_checksum()) {
    return Found::of_another_joint;
  }
  Learned learned;
  std::memcpy(&learned, block.learned, sizeof(learned));
  if (!check(joint::sensor.filter, learned).ok()) {
    return Found::corrupted;
  }
  state.filter = restored(joint::sensor.filter, learned);
  return Found::restored;
}

}  // namespace keeper
