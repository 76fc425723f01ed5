// What a board's core gives a sketch, as far as the example uses it, macros in the way included.
#pragma once

#define min(a, b) ((a) < (b) ? (a) : (b))
#define max(a, b) ((a) > (b) ? (a) : (b))
#define abs(x) ((x) > 0 ? (x) : -(x))
#define round(x) ((x) >= 0 ? (long)((x) + 0.5) : (long)((x) - 0.5))
#define sq(x) ((x) * (x))
#define radians(deg) ((deg) * 0.017453292519943295)
#define degrees(rad) ((rad) * 57.29577951308232)
#define bit(b) (1UL << (b))
#define word(high, low) (((high) << 8) | (low))
#define PI 3.1415926535897932384626433832795
#define HIGH 0x1
#define LOW 0x0
#define INPUT 0x0
#define DEC 10
#define HEX 16

enum { A0 = 14, A1, A2, A3 };

extern "C" {
int analogRead(int pin);
unsigned long micros(void);
}

struct SerialPort {
  void begin(unsigned long baud);
  void println(const char* text);
  void println(double value);
};
extern SerialPort Serial;
