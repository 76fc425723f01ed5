// SPDX-License-Identifier: Apache-2.0
// strainwave_limits SECONDS BYTES: what this machine can do, as one object of JSON. Products and
// sums a second at each vector level and precision; bytes a second copied and in a triad, by
// threads.
#include <algorithm>
#include <chrono>
#include <cstring>
#include <exception>
#include <functional>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include "multiply_add.hpp"

namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Best of five, each for at least a fifth of the time: a limit is what can be reached.
double best_rate(double seconds, const std::function<double()>& work_done) {
  double best = 0;
  for (int attempt = 0; attempt < 5; ++attempt) {
    double work = 0;
    const double began_s = now_s();
    double taken_s = 0;
    while (taken_s < seconds / 5) {
      work += work_done();
      taken_s = now_s() - began_s;
    }
    best = std::max(best, work / taken_s);
  }
  return best;
}

double operations_a_second(const speed::Rate& rate, double seconds) {
  constexpr long rounds = 100'000;
  volatile double sink = 0;
  return best_rate(seconds, [&] {
    sink = rate.run(rounds);
    return rate.operations_a_round * static_cast<double>(rounds);
  });
}

/// Bytes read and written a second, a share of the arrays to each thread.
template <class Work>
double bytes_a_second(std::size_t threads, double seconds, double bytes_a_pass, const Work& work) {
  return best_rate(seconds, [&] {
    std::vector<std::jthread> others;
    for (std::size_t t = 1; t < threads; ++t) {
      others.emplace_back([&work, t] { work(t); });
    }
    work(0);
    others.clear();
    return bytes_a_pass;
  });
}

struct Bandwidth {
  double copy;
  double triad;
};

Bandwidth bandwidth(std::size_t threads, double seconds, std::size_t bytes) {
  const std::size_t count = bytes / sizeof(float) / threads;
  std::vector<std::vector<float>> a(threads, std::vector<float>(count, 1.0F));
  auto b = a;
  auto c = a;
  const auto all = static_cast<double>(count * threads * sizeof(float));
  const double copy = bytes_a_second(threads, seconds, 2 * all, [&](std::size_t t) {
    std::memcpy(a[t].data(), b[t].data(), count * sizeof(float));
  });
  const double triad = bytes_a_second(threads, seconds, 3 * all, [&](std::size_t t) {
    float* const to = a[t].data();
    const float* const first = b[t].data();
    const float* const second = c[t].data();
    for (std::size_t i = 0; i < count; ++i) {
      to[i] = first[i] + 3.0F * second[i];
    }
  });
  return {copy, triad};
}

void print_level(int level, const speed::Rate& in_float, const speed::Rate& in_double,
                 double seconds) {
  std::cout << (level == 2 ? "" : ", ") << "\"v" << level << R"(": {"lanes_float": )"
            << in_float.lanes << R"(, "float": )" << operations_a_second(in_float, seconds)
            << R"(, "double": )" << operations_a_second(in_double, seconds) << "}";
}

void print_bandwidth(std::size_t threads, double seconds, std::size_t bytes) {
  const Bandwidth found = bandwidth(threads, seconds, bytes);
  std::cout << (threads == 1 ? "" : ", ") << '"' << threads << R"(": {"copy": )" << found.copy
            << R"(, "triad": )" << found.triad << "}";
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 3) {
    std::cerr << "usage: strainwave_limits SECONDS BYTES\n";
    return 2;
  }
  const double seconds = std::stod(arguments[1]);
  const auto bytes = static_cast<std::size_t>(std::stod(arguments[2]));
  std::cout << R"({"operations_per_s": {)";
  print_level(2, speed::v2::rate_of_float(), speed::v2::rate_of_double(), seconds);
  if (__builtin_cpu_supports("x86-64-v3")) {
    print_level(3, speed::v3::rate_of_float(), speed::v3::rate_of_double(), seconds);
  }
  if (__builtin_cpu_supports("x86-64-v4")) {
    print_level(4, speed::v4::rate_of_float(), speed::v4::rate_of_double(), seconds);
  }
  std::cout << R"(}, "bandwidth_bytes_per_s": {)";
  const std::size_t most = std::min<std::size_t>(2, std::thread::hardware_concurrency());
  for (std::size_t threads = 1; threads <= most; ++threads) {
    print_bandwidth(threads, seconds, bytes);
  }
  std::cout << "}}\n";
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
