// Raspberry Pi Pico and an MPU-6050 on its default I2C pins: orientation, smoothed by a filter, in frames on the serial
// line; a button on GPIO 15 travels in the same stream with the time at which it was pressed.
#include <Wire.h>
#include <fairlead.h>

const uint8_t address = 0x68;
const float rad_s_per_count = 500.0f / 32768 * DEG_TO_RAD;  // range: 500 degrees a second
const float m_s2_per_count = 4 * 9.80665f / 32768;          // range: 4 g

const int button_pin = 15;

struct Board {
  using Input = fairlead::Imu<fairlead::AttitudeMode::imu>;  // gyro and accelerometer
  using Channels = fairlead::Channels<fairlead::Orientation>;
  using Filter = fairlead::PoseFilter<5>;               // two samples late
  static constexpr std::size_t delay_records_max = 32;  // samples: 0.32 s
  static constexpr fairlead::Beam beam = fairlead::Beam::narrow;
  static constexpr std::size_t events_max = 2;  // that may wait
};
using Motion = fairlead::Pipeline<Board>;

Motion::Params params() {
  Motion::Params p;
  p.sample_period_ns = 10000000;  // 100 samples a second
  p.tolerance.orientation_rad = 0.5f * DEG_TO_RAD;
  p.filter = Board::Filter{fairlead::binomial_mask<5>()};
  return p;
}
Motion motion{params()};

void write_register(uint8_t reg, uint8_t value) {
  Wire.beginTransmission(address);
  Wire.write(reg);
  Wire.write(value);
  Wire.endTransmission();
}

int16_t read_count() {
  const uint16_t high = static_cast<uint8_t>(Wire.read());
  return static_cast<int16_t>(high << 8 | static_cast<uint8_t>(Wire.read()));
}

// micros() wraps after 71 minutes; time in the library never goes backward
uint64_t micros64() {
  static uint32_t last = 0, wraps = 0;
  const uint32_t now = micros();
  if (now < last) ++wraps;
  last = now;
  return static_cast<uint64_t>(wraps) << 32 | now;
}

bool read_sample(fairlead::Sample &sample) {
  Wire.beginTransmission(address);
  Wire.write(0x3B);  // accelerometer, temperature, gyro: 14 bytes
  if (Wire.endTransmission(false) != 0 || Wire.requestFrom(address, static_cast<uint8_t>(14)) != 14) return false;
  int16_t count[7];
  for (int16_t &c : count) c = read_count();
  sample.t_ns = static_cast<int64_t>(micros64()) * 1000;
  sample.accel_m_s2 = {count[0] * m_s2_per_count, count[1] * m_s2_per_count, count[2] * m_s2_per_count};
  sample.gyro_rad_s = {count[4] * rad_s_per_count, count[5] * rad_s_per_count, count[6] * rad_s_per_count};
  sample.flags = fairlead::flag::gyro_valid | fairlead::flag::accel_valid;  // without them the readings are ignored
  return true;
}

void read_button(int64_t t_ns) {
  static int before = HIGH;
  const int now = digitalRead(button_pin);
  if (now == before) return;
  before = now;
  fairlead::Event event;
  event.t_ns = t_ns;
  event.value = now == LOW ? 1 : 0;
  motion.push_event(event);
}

void setup() {
  pinMode(button_pin, INPUT_PULLUP);
  Serial.begin(115200);
  Wire.begin();
  Wire.setClock(400000);
  write_register(0x6B, 0x01);  // wake up, clock from the gyro
  write_register(0x1A, 0x03);  // low pass 44 Hz
  write_register(0x1B, 0x08);  // gyro 500 degrees a second
  write_register(0x1C, 0x08);  // accelerometer 4 g
}

void loop() {
  static uint32_t next_us = micros();
  if (static_cast<int32_t>(micros() - next_us) < 0) return;
  next_us += 10000;  // 100 Hz
  fairlead::Sample sample;
  if (!read_sample(sample)) return;
  read_button(sample.t_ns);
  const fairlead::Bytes frames = motion.push(sample);
  if (!frames.empty()) Serial.write(frames.data, frames.size);  // whole frames
}
