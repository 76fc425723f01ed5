// The exported header alone, as C++ firmware uses it: nothing is constructed before start-up and
// nothing is shared but what the caller owns.
#include "strainwave/learned_block.hpp"
#include "wrist.hpp"

namespace joint = strainwave::joints::wrist;

static_assert(joint::gauge_capacity == 4);
static_assert(joint::has_learned);
static_assert(sizeof(joint::joint_hash) == 65);

extern "C" bool exported_start(joint::State& state) {
  if (!joint::joint_is_intact()) {
    return false;
  }
  state = joint::power_up_state();
  return true;
}

extern "C" float exported_step(joint::State& state, const joint::Sample& sample) {
  return step(joint::config, state, sample).torque_Nm;
}

using Block = strainwave::LearnedBlock<joint::Real, joint::pair_capacity>;

extern "C" bool exported_keep(joint::State& state, Block& block) {
  save_learned(joint::config, state, block);
  return restore_learned(joint::config, state, block) == strainwave::BlockFault::none;
}
