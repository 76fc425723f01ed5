// SPDX-License-Identifier: Apache-2.0
// PROGRAM CASE[:OPTION=VALUE...] INPUTS: one case, told what to do by lines, answers in lines of
// JSON. PROGRAM --list: the cases there are.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "case.hpp"

namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// time SAMPLES SECONDS: runs until so much time has passed.
void time(const speed::Case& timed, std::size_t samples, double least_s) {
  timed.prepare(samples);
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
  timed.prepare(samples);
  timed.run(samples);
  const auto ripple_Nm = timed.ripple_Nm();
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(ripple_Nm.data()),
             static_cast<std::streamsize>(ripple_Nm.size() * sizeof(double)));
  std::printf("{\"samples\": %zu}\n", ripple_Nm.size());
}

/// Takes the options off a case's name.
speed::Options options_of(std::string& name) {
  speed::Options options;
  std::istringstream parts(name);
  std::getline(parts, name, ':');
  for (std::string part; std::getline(parts, part, ':');) {
    const std::size_t equals = part.find('=');
    options[part.substr(0, equals)] = part.substr(equals + 1);
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const speed::Cases cases = speed::all_cases();
  if (argc == 2 && std::string(argv[1]) == "--list") {
    for (const auto& each : cases) {
      std::puts(each.first.c_str());
    }
    return 0;
  }
  std::string name = argc == 3 ? argv[1] : "";
  const speed::Options options = options_of(name);
  if (!cases.contains(name)) {
    std::fprintf(stderr,
                 "usage: CASE[:OPTION=VALUE...] INPUTS, or --list\nthere is no case \"%s\"\n",
                 name.c_str());
    return 2;
  }
  const speed::Case timed = cases.at(name)(speed::read_recording(argv[2]), options);
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
