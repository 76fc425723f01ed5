// The golden vectors on a Cortex-M4F: runs the five chains over all samples, prints each one's
// checksum beside the host's, and writes all answers to golden-answers.bin for comparison.

#include <cstddef>
#include <cstdint>

#include "golden_chains.hpp"
#include "semihosting.hpp"

namespace {

#ifdef GOLDEN_DOUBLE
using Real = double;
constexpr bool is_double = true;
#else
using Real = float;
constexpr bool is_double = false;
#endif

/// Answers on their way to the host, many to a call.
class Records {
 public:
  explicit Records(std::uint32_t file) : file_(file) {}

  void add(const golden::Answer<Real>& answer) {
    rows_[count_++] = answer;
    if (count_ == capacity) {
      flush();
    }
  }
  void flush() {
    good_ = semihosting::write(file_, rows_, count_ * sizeof(rows_[0])) && good_;
    count_ = 0;
  }
  [[nodiscard]] bool good() const { return good_; }

 private:
  static constexpr std::size_t capacity = 512;
  std::uint32_t file_;
  std::size_t count_ = 0;
  bool good_ = true;
  golden::Answer<Real> rows_[capacity] = {};
};

void print_hex(std::uint32_t value) {
  char text[9] = {};
  for (std::size_t digit = 0; digit < 8; ++digit) {
    text[7 - digit] = "0123456789abcdef"[value & 0xFU];
    value >>= 4U;
  }
  semihosting::print(text);
}

}  // namespace

extern "C" std::uint32_t golden_main() {
  golden::Inputs check_inputs;
  golden::Checksum of_inputs;
  for (std::uint32_t k = 0; k < golden::sample_count; ++k) {
    add(of_inputs, check_inputs.next());
  }
  if (of_inputs.value() != golden::inputs_checksum) {
    semihosting::print("golden: the samples are not those of the host\n");
    return 2;
  }
  const std::uint32_t file = semihosting::create("golden-answers.bin");
  static Records records(file);
  golden::for_each_chain<Real>([](const golden::Golden& expected, auto chain) {
    golden::Inputs inputs;
    golden::Checksum checksum;
    for (std::uint32_t k = 0; k < golden::sample_count; ++k) {
      const golden::Answer<Real> answer = chain.take(inputs.next());
      add(checksum, answer);
      records.add(answer);
    }
    const std::uint32_t host = is_double ? expected.double_checksum : expected.float_checksum;
    semihosting::print(expected.name);
    semihosting::print(": checksum ");
    print_hex(checksum.value());
    semihosting::print(checksum.value() == host ? ", the host's\n" : ", not the host's\n");
  });
  records.flush();
  semihosting::close(file);
  return records.good() ? 0 : 1;
}
