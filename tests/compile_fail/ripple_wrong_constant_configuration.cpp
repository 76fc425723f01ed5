// expected: static assertion failed
#include "strainwave/ripple_config.hpp"

namespace {

constexpr auto config = [] {
  strainwave::RippleFilterConfig<float, 3> changed;
#ifndef STRAINWAVE_CONTROL
  changed.memory_turns = 0.0F;
#endif
  return changed;
}();

}  // namespace

static_assert(check(config).ok());
