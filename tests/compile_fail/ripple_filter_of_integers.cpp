// expected: strainwave: Real must be float or double
#include "strainwave/ripple_filter.hpp"

#ifdef STRAINWAVE_CONTROL
using Scalar = float;
#else
using Scalar = int;
#endif

std::size_t misuse(const strainwave::RippleFilterConfig<Scalar, 3>& config) {
  return config.order_count;
}
