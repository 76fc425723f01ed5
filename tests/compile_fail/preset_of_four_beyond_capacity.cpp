// expected: strainwave: taghirad1999-4 needs MaxOrders of at least 2
#include "strainwave/oscillator_filter.hpp"

#ifdef STRAINWAVE_CONTROL
constexpr std::size_t max_orders = 2;
#else
constexpr std::size_t max_orders = 1;
#endif

auto misuse() { return strainwave::taghirad1999_4<double, max_orders>(); }
