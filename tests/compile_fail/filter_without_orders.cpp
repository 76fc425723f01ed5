// expected: strainwave: MaxOrders must be at least 1
#include "strainwave/oscillator_filter.hpp"

#ifdef STRAINWAVE_CONTROL
constexpr std::size_t max_orders = 1;
#else
constexpr std::size_t max_orders = 0;
#endif

std::size_t misuse(const strainwave::OscillatorFilterConfig<float, max_orders>& config) {
  return config.order_count;
}
