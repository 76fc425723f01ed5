// The least start-up for a Cortex-M4F: vectors, memory, floating-point unit.

#include <cstdint>

#include "semihosting.hpp"

extern "C" {
extern std::uint32_t image_stack_top;
extern std::uint32_t image_data_source;
extern std::uint32_t image_data_begin;
extern std::uint32_t image_data_end;
extern std::uint32_t image_bss_begin;
extern std::uint32_t image_bss_end;

std::uint32_t golden_main();

[[noreturn]] void reset_handler() {
  // Coprocessors 10 and 11: without them the first floating-point instruction is a fault.
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88U) |= 0xFU << 20U;
  asm volatile("dsb\n isb" ::: "memory");
  const std::uint32_t* from = &image_data_source;
  for (std::uint32_t* to = &image_data_begin; to < &image_data_end;) {
    *to++ = *from++;
  }
  for (std::uint32_t* to = &image_bss_begin; to < &image_bss_end;) {
    *to++ = 0;
  }
  semihosting::end(golden_main());
}

[[noreturn]] void fault_handler() {
  semihosting::print("golden: a fault of the processor\n");
  semihosting::end(3);
}
}

using Handler = void (*)();

struct Vectors {
  const std::uint32_t* stack_top;
  Handler handlers[15];
};

extern "C" __attribute__((section(".vectors"), used))
const Vectors vectors = {&image_stack_top,
                         {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler,
                          fault_handler, nullptr, nullptr, nullptr, nullptr, fault_handler,
                          fault_handler, nullptr, fault_handler, fault_handler}};
