// What the golden image asks of its debugger or of qemu: text, a file, the end.
#pragma once

#include <cstddef>
#include <cstdint>

namespace semihosting {

inline std::uint32_t call(std::uint32_t operation, const void* argument) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

inline void print(const char* text) { call(0x04, text); }  // SYS_WRITE0

/// A file of the host, opened for writing; 0xFFFFFFFF where that failed.
inline std::uint32_t create(const char* name) {
  std::size_t length = 0;
  while (name[length] != '\0') {
    ++length;
  }
  constexpr std::uint32_t write_binary = 5;
  const std::uint32_t block[] = {reinterpret_cast<std::uint32_t>(name), write_binary,
                                 static_cast<std::uint32_t>(length)};
  return call(0x01, block);  // SYS_OPEN
}

/// True where all bytes were written.
inline bool write(std::uint32_t file, const void* bytes, std::size_t size) {
  const std::uint32_t block[] = {file, reinterpret_cast<std::uint32_t>(bytes),
                                 static_cast<std::uint32_t>(size)};
  return call(0x05, block) == 0;  // SYS_WRITE: bytes not written
}

inline void close(std::uint32_t file) {
  const std::uint32_t block[] = {file};
  call(0x02, block);  // SYS_CLOSE
}

[[noreturn]] inline void end(std::uint32_t status) {
  const std::uint32_t block[] = {0x20026U, status};  // ADP_Stopped_ApplicationExit
  call(0x20, block);                                 // SYS_EXIT_EXTENDED
  while (true) {
  }
}

}  // namespace semihosting
