// SPDX-License-Identifier: Apache-2.0
/// @file sampling.hpp
/// The sampled interrupt and what passes between it and the background.
#pragma once

#include <cstdint>

#include "joint.hpp"
#include "keeper.hpp"
#include "signals.hpp"

namespace sampling {

/// What the background sees of the sampled interrupt.
struct Report {
  std::uint32_t samples = 0;
  float torque_Nm = 0.0F;
  float measured_Nm = 0.0F;
  float load_Nm = 0.0F;          ///< the truth, which a product does not have
  float mean_square_Nm2 = 0.0F;  ///< of torque less load, smoothed over some 1000 samples
  strainwave::Status status = 0;
  bool joint_intact = false;  ///< false: a fault, and the torque is 0
};

/// Checks the joint's constants in memory, sets the chain up and starts the interrupt; says what
/// became of the coefficients kept.  With a spoilt joint the interrupt measures nothing.
keeper::Found start();

/// A consistent copy: taken again where the interrupt came in between.
Report report();

/// What the filter has learned, likewise.
strainwave::LearnedRipple<float, joint::pairs> learned();

/// Stops the timer, as a fault of it would: for the watchdog's test.
void break_down();

}  // namespace sampling
