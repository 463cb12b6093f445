// Text that is no configuration: refused with a line, whatever it is. tests/fuzz/config.cpp
// searches further; what it found once stands here.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "examples/gateway/calibration_file.hpp"
#include "examples/gateway/config.hpp"
#include "examples/gateway/toml_parser.hpp"

namespace fairlead::gateway {
namespace {

using namespace std::string_literals;

std::string first_error(const std::string& text) {
    const ConfigResult got = parse_config(text, "c");
    return got.errors.empty() ? "none" : got.errors.front();
}

std::string example() {
    std::ifstream in{"examples/gateway/gateway.toml", std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
}

TEST(Toml, BytesThatNoTomlHasAreRefusedWithTheirLine) {
    EXPECT_EQ(first_error("[\0"s), "c:1: the text contains the control character 0");
    EXPECT_EQ(first_error("\n\nx = \"\x01\"\n"), "c:3: the text contains the control character 1");
    EXPECT_EQ(first_error("\n\x7F"), "c:2: the text contains the control character 127");
    for (const char* bad : {"\xFF", "\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80",
                            "\xF0\x80\x80\x80", "\xC3", "\xE2\x82", "\x80"})
        EXPECT_EQ(first_error("x = 1\n"s + bad), "c:2: the text is not UTF-8");
    for (const char* good : {"# \xC3\xA9", "# \xE2\x82\xAC", "# \xF0\x9F\x98\x80", "\xEF\xBB\xBF#",
                             "x = \"\xC3\x90\" # \xC3\x90"})
        EXPECT_EQ(first_error(good).find("UTF"), std::string::npos) << first_error(good);
    EXPECT_EQ(first_error("n\xC3\x90"), "c:1: a letter beyond ASCII stands outside of a text");
    EXPECT_EQ(first_error(std::string(toml_size_max + 1, '#')),
              "c:1: the text is longer than 1048576 bytes");
}

TEST(Toml, WhatTheFuzzerFoundStaysMended) {
    // toml++ looks for the end of a broken value beyond quotes: a letter in a text is none there
    EXPECT_NE(first_error("TTTTTTTTs = 1979$5-27T07\"\"\":3\xEF\xBB\xBF"
                          "0^n"),
              "none");
    EXPECT_NE(first_error("x = 1979$\"\"\"\xC3\x90"), "none");
}

TEST(Toml, DeepNestingIsRefused) {
    EXPECT_NE(first_error("x = " + std::string(100000, '[')), "none");
    std::string tables = "x = ";
    for (int i = 0; i < 10000; ++i) tables += "{a=";
    EXPECT_NE(first_error(tables), "none");
}

/// Every prefix of the example, and 10,000 mutations of it: errors or a configuration, no more.
TEST(Toml, CutAndMutatedConfigurationsNeverStopTheProgram) {
    const std::string text = example();
    ASSERT_GT(text.size(), 1000u);
    for (std::size_t n = 0; n < text.size(); n += 3)
        static_cast<void>(first_error(text.substr(0, n)));
    const unsigned seed = 20;
    std::mt19937 random{seed};
    const std::string special = "[]{}\"'=,.#\\\n\0\x80\xFF-+_ 0123456789eExXtTzZ:"s;
    int accepted = 0;
    for (int round = 0; round < 10000; ++round) {
        std::string mutated = text;
        for (auto n = 1 + random() % 6; n > 0; --n) {
            const std::size_t at = random() % mutated.size();
            const char letter = random() % 4 == 0 ? static_cast<char>(random())
                                                  : special[random() % special.size()];
            switch (random() % 4) {
                case 0: mutated[at] = letter; break;
                case 1: mutated.insert(at, 1 + random() % 3, letter); break;
                case 2: mutated.erase(at, 1 + random() % 20); break;
                default: mutated.insert(at, mutated.substr(random() % mutated.size(), 30)); break;
            }
            if (mutated.empty()) mutated = "x";
        }
        accepted += parse_config(mutated, "c").errors.empty();
    }
    EXPECT_GT(accepted, 500) << "comments hold most of the bytes";
    EXPECT_LT(accepted, 9500) << "and the mutations do reach the rest";
}

class Files : public ::testing::Test {
  protected:
    void SetUp() override {
        char name[] = "/tmp/fairlead-test-XXXXXX";
        ASSERT_NE(mkdtemp(name), nullptr);
        folder_ = name;
    }
    void TearDown() override {
        for (const std::string& path : made_) unlink(path.c_str());
        rmdir(folder_.c_str());
    }
    std::string write(const std::string& name, const std::string& bytes) {
        const std::string path = folder_ + "/" + name;
        std::ofstream{path, std::ios::binary} << bytes;
        made_.push_back(path);
        return path;
    }
    std::string read_error(const std::string& path) {
        const ConfigResult got = read_config(path);
        return got.errors.empty() ? "none" : got.errors.front();
    }
    std::string folder_;
    std::vector<std::string> made_;
};

TEST_F(Files, OnlyARegularFileIsRead) {
    const std::string pipe = folder_ + "/pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    made_.push_back(pipe);
    EXPECT_EQ(read_error(pipe), pipe + ": is not a regular file") << "and nobody waits for it";
    EXPECT_EQ(read_error(folder_), folder_ + ": is not a regular file");
    EXPECT_EQ(read_error("/dev/zero"), "/dev/zero: is not a regular file");
    EXPECT_EQ(read_error(folder_ + "/none"),
              folder_ + "/none: cannot be read: No such file or directory");
}

TEST_F(Files, ACalibrationComesFromTomlOrFromSavedBytes) {
    const std::string text = write("board.toml",
                                   "gyro_offset_rad_s = [0.01, -0.02, 0.03]\n"
                                   "accel_matrix = [1.01, 0, 0, 0, 0.99, 0, 0, 0, 1]\n"
                                   "temperature_C = 31\n");
    Calibration c;
    std::vector<std::string> errors;
    read_calibration(text, c, errors);
    ASSERT_TRUE(errors.empty()) << errors.front();
    EXPECT_FLOAT_EQ(c.gyro.offset.y, -0.02f);
    EXPECT_FLOAT_EQ(c.accel.matrix.x.x, 1.01f);
    EXPECT_FLOAT_EQ(c.temperature_C, 31);
    const auto saved = save(c);
    std::string bytes(sizeof saved, 0);
    std::memcpy(bytes.data(), &saved, sizeof saved);
    Calibration again;
    read_calibration(write("board.cal", bytes), again, errors);
    EXPECT_TRUE(errors.empty());
    EXPECT_TRUE(same_calibration(c, again));
    EXPECT_FALSE(same_calibration(c, Calibration{}));
    bytes[40] = static_cast<char>(bytes[40] ^ 1);
    Calibration kept;
    read_calibration(write("damaged.cal", bytes), kept, errors);
    ASSERT_EQ(errors.size(), 1u);
    EXPECT_NE(errors[0].find("damaged.cal: is damaged"), std::string::npos);
    EXPECT_TRUE(same_calibration(kept, Calibration{}));
    errors.clear();
    read_calibration(write("short.cal", bytes.substr(0, 50)), kept, errors);
    read_calibration(write("zero.toml", "mag_matrix = [0, 0, 0, 0, 0, 0, 0, 0, 0]\n"), kept,
                     errors);
    read_calibration(write("nan.toml", "gyro_offset_rad_s = [nan, 0, 0]\n"), kept, errors);
    read_calibration(write("typo.toml", "gyro_ofset = [0, 0, 0]\n"), kept, errors);
    ASSERT_EQ(errors.size(), 4u);
    EXPECT_NE(errors[1].find("mag_matrix has no inverse"), std::string::npos) << errors[1];
    EXPECT_NE(errors[2].find("nan.toml:1: gyro_offset_rad_s must be"), std::string::npos);
    EXPECT_NE(errors[3].find("typo.toml:1: gyro_ofset is not known"), std::string::npos);
}

TEST(Mounting, NamesTheSensorsAxesInTheBodysOrder) {
    int right = 0;
    const std::vector<std::string> axes{"x", "-x", "y", "-y", "z", "-z"};
    const auto axis = [](const std::string& name) {
        const float sign = name[0] == '-' ? -1.0f : 1.0f;
        const char c = name.back();
        return Vec3{c == 'x' ? sign : 0, c == 'y' ? sign : 0, c == 'z' ? sign : 0};
    };
    for (const auto& x : axes)
        for (const auto& y : axes)
            for (const auto& z : axes) {
                Quat q;
                const bool good = parse_mounting(x + " " + y + "  " + z, q);
                const bool is_right_handed = dot(axis(x), cross(axis(y), axis(z))) > 0.5f;
                ASSERT_EQ(good, is_right_handed) << x << y << z;
                if (!good) continue;
                ++right;
                // what the sensor feels along its x axis, say, arrives on the body's axis that
                // names it
                const Vec3 felt{1, 2, 3};
                const Vec3 body = rotate(q, felt);
                EXPECT_NEAR(body.x, dot(axis(x), felt), 1e-5f);
                EXPECT_NEAR(body.y, dot(axis(y), felt), 1e-5f);
                EXPECT_NEAR(body.z, dot(axis(z), felt), 1e-5f);
            }
    EXPECT_EQ(right, 24);
    Quat q;
    for (const char* bad : {"", "x", "x y", "x y z x", "a b c", "x y zz", "--x y z"})
        EXPECT_FALSE(parse_mounting(bad, q)) << bad;
}

TEST_F(Files, TheKeysOfASensorReachTheUnit) {
    write("board.toml", "mag_offset_uT = [1, 2, 3]\n");
    const std::string unit =
        "[[unit]]\nid = 1\nsource = \"sensor\"\nline = 4\nsensor = \"mpu6050\"\nmag = \"lis3mdl\"\n"
        "address = 0x69\nmag_address = 0x1E\naccept_unknown = true\nbias_max_deg_s = 6\n"
        "calibration = \"board.toml\"\nmounting = \"-y x z\"\nbus = 3\n";
    const ConfigResult got = parse_config(unit, folder_ + "/c");
    ASSERT_TRUE(got.errors.empty()) << got.errors.front();
    const UnitConfig& u = got.config.units[0];
    EXPECT_EQ(u.imu.address, 0x69);
    EXPECT_EQ(u.imu.mag_address, 0x1E);
    EXPECT_TRUE(u.imu.accept_unknown);
    EXPECT_NEAR(u.bias_max_rad_s, 6 * 0.017453292, 1e-7);
    EXPECT_FLOAT_EQ(u.calibration.mag.offset.y, 2);
    EXPECT_EQ(u.bus, "/dev/i2c-3");
    const Vec3 body = rotate(u.calibration.q_bs, Vec3{1, 2, 3});
    EXPECT_NEAR(body.x, -2, 1e-6);
    UnitConfig other = u;
    EXPECT_TRUE(other == u);
    other.calibration.mag.offset.y = 3;
    EXPECT_FALSE(other == u);
}

}  // namespace
}  // namespace fairlead::gateway
