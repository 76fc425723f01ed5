// expected: strainwave: MaxGauges must be at least 1
#include "strainwave/gains.hpp"

#ifdef STRAINWAVE_CONTROL
constexpr std::size_t max_gauges = 1;
#else
constexpr std::size_t max_gauges = 0;
#endif

std::size_t misuse(const strainwave::Gains<double, max_gauges>& gains) { return gains.count; }
