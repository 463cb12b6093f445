#pragma once
// A stand-in for the core of an Arduino board: the macros and the functions that the example
// sketches meet, as the real cores have them. AVR_STYLE adds the four function macros that older
// cores define.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#define HIGH 0x1
#define LOW 0x0
#define INPUT 0x0
#define OUTPUT 0x1
#define INPUT_PULLUP 0x2
#define PI 3.1415926535897932384626433832795
#define HALF_PI 1.5707963267948966192313216916398
#define TWO_PI 6.283185307179586476925286766559
#define DEG_TO_RAD 0.017453292519943295769236907684886
#define RAD_TO_DEG 57.295779513082320876798154814105
#define EULER 2.718281828459045235360287471352
#define SERIAL 0x0
#define DISPLAY 0x1
#define CHANGE 1
#define FALLING 2
#define RISING 3
#define DEFAULT 1
#define EXTERNAL 0
#define B0 0
#define B1 1
#define B11 3
#define F(text) (text)
#define constrain(amt, low, high) ((amt) < (low) ? (low) : ((amt) > (high) ? (high) : (amt)))
#define radians(deg) ((deg)*DEG_TO_RAD)
#define degrees(rad) ((rad)*RAD_TO_DEG)
#define sq(x) ((x) * (x))
#define lowByte(w) ((uint8_t)((w)&0xff))
#define highByte(w) ((uint8_t)((w) >> 8))
#define bitRead(value, bit) (((value) >> (bit)) & 0x01)
#define bitSet(value, bit) ((value) |= (1UL << (bit)))
#define bit(b) (1UL << (b))
#define _BV(b) (1UL << (b))
#define interrupts() (void)0
#define noInterrupts() (void)0
#ifdef AVR_STYLE
#undef abs
#define min(a, b) ((a) < (b) ? (a) : (b))
#define max(a, b) ((a) > (b) ? (a) : (b))
#define abs(x) ((x) > 0 ? (x) : -(x))
#define round(x) ((x) >= 0 ? (long)((x) + 0.5) : (long)((x)-0.5))
#endif

typedef bool boolean;
typedef uint8_t byte;
typedef unsigned int word;

extern "C" {
unsigned long millis();
unsigned long micros();
void delay(unsigned long ms);
void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t value);
int digitalRead(uint8_t pin);
}
long random(long below);
long map(long x, long in_low, long in_high, long out_low, long out_high);
void setup();
void loop();

class HardwareSerial {
  public:
    void begin(unsigned long baud);
    size_t write(const uint8_t* data, size_t size);
    size_t print(const char* text);
    size_t print(char c);
    size_t print(double value, int digits = 2);
    size_t println(const char* text);
};
extern HardwareSerial Serial;
