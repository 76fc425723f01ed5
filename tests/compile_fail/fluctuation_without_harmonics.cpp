// expected: strainwave: MaxHarmonics must be at least 1
#include "strainwave/fluctuation.hpp"

#ifdef STRAINWAVE_CONTROL
constexpr std::size_t max_harmonics = 1;
#else
constexpr std::size_t max_harmonics = 0;
#endif

std::size_t misuse(const strainwave::GaugeFluctuation<float, max_harmonics>& gauge) {
  return gauge.harmonic_count;
}
