// What the core put aside is there again for the sketch.
#include <strainwave_arduino.h>

#if !defined(min) || !defined(max) || !defined(abs) || !defined(round) || !defined(bit) || \
    !defined(word) || !defined(radians) || !defined(degrees) || !defined(sq)
#error "strainwave_arduino.h has taken a macro of Arduino's away"
#endif

static_assert(max(min(1, 2), bit(2)) == 4);
