// expected: strainwave: Real must be float or double
#include "strainwave/arithmetic.hpp"

#ifdef STRAINWAVE_CONTROL
using Scalar = double;
#else
using Scalar = int;
#endif

bool misuse() { return strainwave::is_finite(Scalar{1}); }
