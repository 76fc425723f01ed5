// expected: static assertion failed
#include "strainwave/oscillator_filter.hpp"

namespace {

constexpr auto config = [] {
  auto changed = strainwave::taghirad1999<float, 3>({100, 1});
#ifndef STRAINWAVE_CONTROL
  changed.measurement_noise_variance_Nm2 = -1.0F;
#endif
  return changed;
}();

}  // namespace

static_assert(check(config).ok());
