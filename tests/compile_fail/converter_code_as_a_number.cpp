// expected: no match for
#include "strainwave/bridge.hpp"

#ifdef STRAINWAVE_CONTROL
int misuse(strainwave::ConverterCode code) { return code.value + 1; }
#else
int misuse(strainwave::ConverterCode code) { return code + 1; }
#endif
