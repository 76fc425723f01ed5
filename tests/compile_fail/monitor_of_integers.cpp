// expected: strainwave: Real must be float or double
#include "strainwave/gauge_monitor.hpp"

#ifdef STRAINWAVE_CONTROL
using Number = float;
#else
using Number = int;
#endif

bool misuse(const strainwave::GaugeMonitorConfig<Number, 5>& config) { return config.active; }
