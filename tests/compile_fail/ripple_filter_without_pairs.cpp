// expected: strainwave: MaxPairs must be at least 1
#include "strainwave/ripple_filter.hpp"

#ifdef STRAINWAVE_CONTROL
constexpr std::size_t max_pairs = 1;
#else
constexpr std::size_t max_pairs = 0;
#endif

std::size_t misuse(const strainwave::RippleFilterConfig<float, max_pairs>& config) {
  return config.order_count;
}
