// SPDX-License-Identifier: Apache-2.0
/// @file strainwave_arduino.h
/// The core for sketches: Arduino's macros put aside while its headers are read.
#ifndef STRAINWAVE_ARDUINO_H
#define STRAINWAVE_ARDUINO_H

#if !defined(__cplusplus) || __cplusplus < 202002L
#error "strainwave needs C++20: set -std=gnu++20 for this board, see the export command's reference"
#endif

#include <Arduino.h>

#pragma push_macro("min")
#pragma push_macro("max")
#pragma push_macro("abs")
#pragma push_macro("round")
#pragma push_macro("bit")
#pragma push_macro("word")
#pragma push_macro("radians")
#pragma push_macro("degrees")
#pragma push_macro("sq")
#undef min
#undef max
#undef abs
#undef round
#undef bit
#undef word
#undef radians
#undef degrees
#undef sq

#include "strainwave/config_checksum.hpp"
#include "strainwave/learned_block.hpp"
#include "strainwave/sample_clock.hpp"
#include "strainwave/torque_sensor.hpp"

#pragma pop_macro("sq")
#pragma pop_macro("degrees")
#pragma pop_macro("radians")
#pragma pop_macro("word")
#pragma pop_macro("bit")
#pragma pop_macro("round")
#pragma pop_macro("abs")
#pragma pop_macro("max")
#pragma pop_macro("min")

#endif  // STRAINWAVE_ARDUINO_H
