// The README's example, fed with one converter code.
#include <cstdio>

#include "first.hpp"

int main() { std::printf("%.3f Nm\n", static_cast<double>(torque_Nm(36000, 0, 0))); }
