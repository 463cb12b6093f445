// Arduino UNO R4 and an MPU-6050 on SDA and SCL: prints roll, pitch and heading in degrees, ten times a second.
// Keep the board still for the first two seconds: the filter learns the gyro's bias at rest.
#include <Wire.h>
#include <fairlead.h>

const uint8_t address = 0x68;
const float rad_s_per_count = 500.0f / 32768 * DEG_TO_RAD;  // range: 500 degrees a second
const float m_s2_per_count = 4 * 9.80665f / 32768;          // range: 4 g

fairlead::AttitudeImu attitude{fairlead::AttitudeParams{}};

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

void setup() {
  Serial.begin(115200);
  Wire.begin();
  Wire.setClock(400000);
  write_register(0x6B, 0x01);  // wake up, clock from the gyro
  write_register(0x1A, 0x03);  // low pass 44 Hz
  write_register(0x1B, 0x08);  // gyro 500 degrees a second
  write_register(0x1C, 0x08);  // accelerometer 4 g
}

void loop() {
  static uint32_t next_us = micros(), printed = 0;
  if (static_cast<int32_t>(micros() - next_us) < 0) return;
  next_us += 10000;  // 100 Hz
  fairlead::Sample sample;
  if (!read_sample(sample)) {
    Serial.println("no answer from the MPU-6050");
    return;
  }
  const auto pose = attitude.push(sample);
  if (!pose || ++printed % 10 != 0) return;
  const fairlead::Quat &q = pose->q_wb;
  const float roll = fairlead::approx::atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y));
  const float pitch = fairlead::approx::asin(constrain(2 * (q.w * q.y - q.x * q.z), -1.0f, 1.0f));
  const float heading = fairlead::approx::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
  Serial.print(roll * RAD_TO_DEG);
  Serial.print(' ');
  Serial.print(pitch * RAD_TO_DEG);
  Serial.print(' ');
  Serial.print(heading * RAD_TO_DEG);
  Serial.println((pose->flags & fairlead::flag::settling) != 0 ? " settling" : "");
}
