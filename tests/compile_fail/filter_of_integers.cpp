// expected: strainwave: Real must be float or double
#include "strainwave/oscillator_filter.hpp"

#ifdef STRAINWAVE_CONTROL
using Scalar = float;
#else
using Scalar = int;
#endif

std::size_t misuse(const strainwave::OscillatorFilterConfig<Scalar, 2>& config) {
  return config.order_count;
}
