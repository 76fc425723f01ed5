// expected: strainwave: Real must be float or double
#include "strainwave/calibration.hpp"

#ifdef STRAINWAVE_CONTROL
using Scalar = double;
#else
using Scalar = long;
#endif

Scalar misuse(const strainwave::TorqueCalibration<Scalar>& calibration) {
  return calibration.gain_Nm_per_V;
}
