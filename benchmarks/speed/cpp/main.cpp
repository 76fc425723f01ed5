// SPDX-License-Identifier: Apache-2.0
// PROGRAM CASE[:OPTION=VALUE...] INPUTS: one case, told what to do by lines, answers in lines of
// JSON. PROGRAM --list: the cases there are.
#include <chrono>
#include <exception>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

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
  std::cout << R"({"ns_per_sample": )" << 1e9 * taken_s / static_cast<double>(done)
            << R"(, "runs": )" << runs << timed.remarks() << "}\n";
}

/// write SAMPLES FILE: the ripple as doubles.
void write(const speed::Case& timed, std::size_t samples, const std::string& path) {
  timed.prepare(samples);
  timed.run(samples);
  const auto ripple_Nm = timed.ripple_Nm();
  std::ofstream(path, std::ios::binary)
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): doubles as bytes
      .write(reinterpret_cast<const char*>(ripple_Nm.data()),
             static_cast<std::streamsize>(ripple_Nm.size() * sizeof(double)));
  std::cout << R"({"samples": )" << ripple_Nm.size() << "}\n";
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

int run(const std::vector<std::string>& arguments) {
  const speed::Cases cases = speed::all_cases();
  if (arguments.size() == 2 && arguments[1] == "--list") {
    for (const auto& each : cases) {
      std::cout << each.first << '\n';
    }
    return 0;
  }
  std::string name = arguments.size() == 3 ? arguments[1] : "";
  const speed::Options options = options_of(name);
  if (!cases.contains(name)) {
    std::cerr << "usage: CASE[:OPTION=VALUE...] INPUTS, or --list\n"
              << "there is no case \"" << name << "\"\n";
    return 2;
  }
  const speed::Case timed = cases.at(name)(speed::read_recording(arguments[2]), options);
  std::cout << R"({"version": ")" << SPEED_VERSION << "\"}\n" << std::flush;
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
    std::cout.flush();
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
