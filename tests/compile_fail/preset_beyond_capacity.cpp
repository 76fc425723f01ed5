// expected: strainwave: taghirad1999 needs MaxOrders of at least 3
#include "strainwave/oscillator_filter.hpp"

#ifdef STRAINWAVE_CONTROL
constexpr std::size_t max_orders = 3;
#else
constexpr std::size_t max_orders = 2;
#endif

auto misuse() { return strainwave::taghirad1999<float, max_orders>({100, 1}); }
