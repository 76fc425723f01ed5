// SPDX-License-Identifier: Apache-2.0
// strainwave_speed CASE INPUTS: one case, told what to do by lines, answers in lines of JSON.
// strainwave_speed --list: the cases there are.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "case.hpp"

namespace {

speed::Cases all_cases() {
  speed::Cases cases;
  speed::add_published(cases);
  speed::add_default(cases);
  speed::add_published_eigen(cases);
  speed::add_default_eigen(cases);
  speed::add_states(cases);
  return cases;
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// time SAMPLES SECONDS: runs until so much time has passed.
void time(const speed::Case& timed, std::size_t samples, double least_s) {
  std::size_t done = 0;
  int runs = 0;
  const double began_s = now_s();
  double taken_s = 0;
  while (taken_s < least_s) {
    done += timed.run(samples);
    ++runs;
    taken_s = now_s() - began_s;
  }
  std::printf("{\"ns_per_sample\": %.6g, \"runs\": %d%s}\n",
              1e9 * taken_s / static_cast<double>(done), runs, timed.remarks().c_str());
}

/// write SAMPLES FILE: the ripple as doubles.
void write(const speed::Case& timed, std::size_t samples, const std::string& path) {
  timed.run(samples);
  const auto ripple_Nm = timed.ripple_Nm();
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(ripple_Nm.data()),
             static_cast<std::streamsize>(ripple_Nm.size() * sizeof(double)));
  std::printf("{\"samples\": %zu}\n", ripple_Nm.size());
}

}  // namespace

int main(int argc, char** argv) {
  const speed::Cases cases = all_cases();
  if (argc == 2 && std::string(argv[1]) == "--list") {
    for (const auto& each : cases) {
      std::puts(each.first.c_str());
    }
    return 0;
  }
  if (argc != 3 || !cases.contains(argv[1])) {
    std::fputs("usage: strainwave_speed CASE INPUTS, CASE from strainwave_speed --list\n", stderr);
    return 2;
  }
  const speed::Case timed = cases.at(argv[1])(speed::read_recording(argv[2]));
  std::printf("{\"version\": \"%s\"}\n", SPEED_VERSION);
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string what;
    std::string argument;
    std::size_t samples = 0;
    words >> what >> samples >> argument;
    if (what == "time") {
      time(timed, samples, std::stod(argument));
    } else {
      write(timed, samples, argument);
    }
    std::fflush(stdout);
  }
  return 0;
}
