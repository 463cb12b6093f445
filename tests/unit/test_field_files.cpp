// Files as people have them: any order of columns, any unit, separator, number form and encoding.
// One motion is written in a random form and must be read back as it was, or be refused with a
// remedy. Never a silent guess.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <random>

#include "host_sim/recording/plausible.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/recording/writers.hpp"

using namespace fairlead;
using namespace fairlead::sim;

namespace {

/// A body that turns about a tilted axis in gravity and the earth's field; 9 axes at 100 Hz.
std::vector<Sample> turning(std::size_t n, std::int64_t start_ns, std::int64_t step_ns) {
    std::vector<Sample> out;
    for (std::size_t i = 0; i < n; ++i) {
        const double t = static_cast<double>(i) * static_cast<double>(step_ns) * 1e-9;
        const double a = 0.8 * std::sin(1.5 * t), w = 0.8 * 1.5 * std::cos(1.5 * t);
        const auto f = [](double x) { return static_cast<float>(x); };
        Sample s;
        s.t_ns = start_ns + static_cast<std::int64_t>(i) * step_ns;
        s.gyro_rad_s = {f(w), 0, 0};
        s.accel_m_s2 = {0, f(9.80665 * std::sin(a)), f(9.80665 * std::cos(a))};
        s.mag_uT = {20, f(-40 * std::sin(a)), f(-40 * std::cos(a))};
        s.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
        out.push_back(s);
    }
    return out;
}

std::string refusal_of(const std::string& bytes, const ReadOptions& options = {},
                       const std::string& name = "x") {
    try {
        parse_recording(bytes, name, options);
    } catch (const BadData& error) {
        return error.what();
    }
    return "accepted";
}

bool says(const std::vector<std::string>& lines, const std::string& what) {
    return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
        return line.find(what) != std::string::npos;
    });
}

std::string digits(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.12g", value);
    return text;
}

/// One quantity as a file may name it.
struct Spelling {
    const char* names[3];
    const char* unit;  // as the header states it; "": not stated
    double factor;     // of the library's unit
};
const Spelling gyro_spellings[] = {{{"w_x", "w_y", "w_z"}, "[rad s^-1]", 1},
                                   {{"gyro_x", "gyro_y", "gyro_z"}, "(deg/s)", 57.29577951308232},
                                   {{"omega_x", "omega_y", "omega_z"}, "", 1},
                                   {{"GyroX", "GyroY", "GyroZ"}, "[mrad/s]", 1000},
                                   {{"gx", "gy", "gz"}, "", 57.29577951308232},
                                   {{"Gyr_X", "Gyr_Y", "Gyr_Z"}, "[dps]", 57.29577951308232}};
const Spelling accel_spellings[] = {{{"a_x", "a_y", "a_z"}, "[m s^-2]", 1},
                                    {{"ax", "ay", "az"}, "", 1},
                                    {{"acc_x", "acc_y", "acc_z"}, "(g)", 1 / 9.80665},
                                    {{"alpha_x", "alpha_y", "alpha_z"}, "", 1 / 9.80665},
                                    {{"AccX", "AccY", "AccZ"}, "[mg]", 1000 / 9.80665}};
const Spelling mag_spellings[] = {{{"mx", "my", "mz"}, "[uT]", 1},
                                  {{"mag_x", "mag_y", "mag_z"}, "(gauss)", 0.01},
                                  {{"Mag_X", "Mag_Y", "Mag_Z"}, "", 0.01},
                                  {{"magn.x", "magn.y", "magn.z"}, "[mG]", 10}};
struct Clock {
    const char* name;
    std::int64_t per_unit_ns;
};
const Clock clocks[] = {{"timestamp [ns]", 1}, {"t_us", 1000},         {"time (ms)", 1000000},
                        {"t [s]", 1000000000}, {"timestamp", 1000000}, {"time", 1000000000},
                        {"timestamp", 1}};

/// A column: its name, and its text for a sample.
struct Out {
    std::string name;
    std::function<std::string(const Sample&)> text;
};

std::string decimal(std::int64_t value, std::int64_t per_unit) {
    std::string out = std::to_string(value / per_unit);
    if (per_unit == 1) return out;
    std::string rest = std::to_string(per_unit + value % per_unit).substr(1);
    return out + "." + rest;
}

template <std::size_t N>
void add_vector(std::vector<Out>& out, const Spelling (&spellings)[N], Vec3 Sample::*values,
                std::mt19937& random) {
    const Spelling& s = spellings[random() % N];
    const bool one_unit = random() % 2 == 0;  // on the first axis alone
    for (std::size_t k = 0; k < 3; ++k) {
        std::string name = s.names[k];
        if (*s.unit != 0 && (k == 0 || !one_unit)) name += std::string(" ") + s.unit;
        out.push_back({name, [=](const Sample& sample) {
                           const Vec3& v = sample.*values;
                           const float x = k == 0 ? v.x : k == 1 ? v.y : v.z;
                           return digits(static_cast<double>(x) * s.factor);
                       }});
    }
}

std::string utf16(const std::string& text, bool little) {
    std::string out = little ? "\xFF\xFE" : "\xFE\xFF";
    for (const char c : text) {
        if (!little) out += '\0';
        out += c;
        if (little) out += '\0';
    }
    return out;
}

std::string random_file(const std::vector<Sample>& samples, std::mt19937& random) {
    std::vector<Out> columns;
    const Clock& clock = clocks[random() % std::size(clocks)];
    columns.push_back(
        {clock.name, [&](const Sample& s) { return decimal(s.t_ns, clock.per_unit_ns); }});
    add_vector(columns, gyro_spellings, &Sample::gyro_rad_s, random);
    add_vector(columns, accel_spellings, &Sample::accel_m_s2, random);
    add_vector(columns, mag_spellings, &Sample::mag_uT, random);
    if (random() % 2) columns.push_back({"marker", [](const Sample&) { return "0"; }});
    if (random() % 2) columns.push_back({"label", [](const Sample&) { return "walk"; }});
    if (random() % 2) columns.push_back({"seq", [](const Sample&) { return "12"; }});
    std::shuffle(columns.begin(), columns.end(), random);
    const char separators[] = {',', ';', '\t'};
    const char separator = separators[random() % 3];
    const bool comma = separator != ',' && random() % 3 == 0, trailing = random() % 4 == 0;
    const std::string end = random() % 2 ? "\n" : "\r\n";
    std::string text = random() % 3 == 0 ? "# made by a test" + end : "";
    if (random() % 2) text += "#";
    for (const Out& c : columns)
        text += (&c == &columns[0] ? "" : std::string(1, separator)) + c.name;
    if (trailing) text += separator;
    text += end;
    for (const Sample& s : samples) {
        for (const Out& c : columns) {
            std::string field = c.text(s);
            if (comma) std::replace(field.begin(), field.end(), '.', ',');
            text += (&c == &columns[0] ? "" : std::string(1, separator)) + field;
        }
        if (trailing) text += separator;
        text += end;
    }
    switch (random() % 5) {
        case 0: return "\xEF\xBB\xBF" + text;
        case 1: return utf16(text, true);
        case 2: return utf16(text, false);
        default: return text;
    }
}

double apart(const Vec3& a, const Vec3& b) {
    return std::hypot(static_cast<double>(a.x - b.x), static_cast<double>(a.y - b.y),
                      static_cast<double>(a.z - b.z));
}

}  // namespace

TEST(FieldFiles, AnyFormOfANamedFileIsReadAsItWas) {
    std::size_t refused = 0;
    for (unsigned seed = 1; seed <= 600; ++seed) {
        std::mt19937 random{seed};
        const std::int64_t start = random() % 2 ? 1700000000000000000 : 5000000000;
        const auto samples = turning(300, start, 10000000);
        const std::string file = random_file(samples, random);
        SCOPED_TRACE(testing::Message() << "seed " << seed << ": " << file.substr(0, 300));
        Recording read;
        try {
            read = parse_recording(file, "x");
        } catch (const BadData& error) {
            EXPECT_NE(std::string(error.what()).find("--"), std::string::npos) << error.what();
            ++refused;
            continue;
        }
        ASSERT_EQ(read.samples.size(), samples.size());
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const Sample &a = read.samples[i], &b = samples[i];
            ASSERT_EQ(a.flags, b.flags);
            ASSERT_EQ(a.t_ns, b.t_ns);
            ASSERT_LT(apart(a.gyro_rad_s, b.gyro_rad_s), 1e-5);
            ASSERT_LT(apart(a.accel_m_s2, b.accel_m_s2), 1e-4);
            ASSERT_LT(apart(a.mag_uT, b.mag_uT), 1e-3);
        }
        EXPECT_TRUE(doubts(read).empty());
    }
    EXPECT_LT(refused, 60u) << "these forms are plain: nearly all must be read";
}

TEST(FieldFiles, WithoutAHeaderTheNumbersMustSettleIt) {
    const auto samples = turning(200, 1700000000000000000, 5000000);
    const auto rows = [&](const char* order, bool times) {
        std::string text;
        for (const Sample& s : samples) {
            if (times) text += std::to_string(s.t_ns);
            for (const char* c = order; *c != 0; ++c) {
                const Vec3& v = *c == 'g' ? s.gyro_rad_s : *c == 'a' ? s.accel_m_s2 : s.mag_uT;
                for (const float x : {v.x, v.y, v.z}) text += "," + digits(static_cast<double>(x));
            }
            text += "\n";
        }
        return text;
    };
    for (const char* order : {"ga", "ag", "gam", "agm"}) {
        const Recording read = parse_recording(rows(order, true), "x");
        EXPECT_LT(apart(read.samples[77].gyro_rad_s, samples[77].gyro_rad_s), 1e-5) << order;
        EXPECT_LT(apart(read.samples[77].accel_m_s2, samples[77].accel_m_s2), 1e-5) << order;
        EXPECT_TRUE(says(read.notes, "without a header: taken as")) << order;
    }
    for (const char* order : {"g", "aa", "gg", "gma", "gamg"})
        EXPECT_NE(refusal_of(rows(order, true)).find("--columns"), std::string::npos) << order;
}

TEST(FieldFiles, QuaternionsWithoutAHeader) {
    double middle = 0;  // about which angle the body turns
    const auto rows = [&](bool scalar_last, const char* separator, const char* unit) {
        std::string text;
        for (int i = 0; i < 100; ++i) {
            const double a = middle + 0.3 * std::sin(i * 0.1);
            const std::string w = digits(std::cos(a)), x = digits(std::sin(a));
            const std::string s = separator;
            text += (*unit == 's' ? decimal(1700000000000 + 10 * i, 1000)
                                  : std::to_string(1700000000000000000 + 10000000 * i)) +
                    s + "0.1" + s + "0.2" + s + "0.3" + s;
            text += scalar_last ? x + s + "0" + s + "0" + s + w : w + s + x + s + "0" + s + "0";
            text += "\n";
        }
        return text;
    };
    EXPECT_GT(parse_recording(rows(true, " ", "s"), "x").poses[5].q_wb.w, 0.9f);
    EXPECT_NE(refusal_of(rows(false, " ", "s")).find("--columns"), std::string::npos);
    // CSV: no attitude of the body makes one order look like the other
    for (const double about : {0.0, 0.8, 1.5707963}) {
        middle = about;
        for (const bool scalar_last : {true, false})
            for (const char* unit : {"ns", "s"}) {
                const std::string why = refusal_of(rows(scalar_last, ",", unit));
                EXPECT_NE(why.find("--columns t_s,px,py,pz,qx,qy,qz,qw or t_s,px,py,pz,qw"),
                          std::string::npos)
                    << why;
                EXPECT_NE(why.find("scalar may be first or last"), std::string::npos) << why;
            }
    }
    middle = 0;
    std::string euroc = rows(false, ",", "ns");  // velocity and biases follow
    for (std::size_t at = 0; (at = euroc.find('\n', at)) != std::string::npos; at += 19)
        euroc.insert(at, ",0,0,0,0,0,0,0,0,0");
    EXPECT_GT(parse_recording(euroc, "x").poses[5].q_wb.w, 0.9f);
    ReadOptions options;
    options.columns = "t_s,px,py,pz,qx,qy,qz,qw";
    EXPECT_GT(parse_recording(rows(true, ",", "s"), "x", options).poses[5].q_wb.w, 0.9f);
}

TEST(FieldFiles, WhatIsAmbiguousIsRefusedWithTheOption) {
    const auto refused = [](const std::string& text, const char* option) {
        const std::string why = refusal_of(text);
        EXPECT_NE(why.find(option), std::string::npos) << why;
    };
    refused("t_ns,x,y,z\n0,1,2,3\n10000000,1,2,3\n", "--columns t_ns,gx,gy,gz");
    refused("t_ns,q0,q1,q2,q3\n0,1,0,0,0\n10000000,1,0,0,0\n", "--columns");
    refused("t_ns,gx,gy\n0,1,2\n10000000,1,2\n", "--columns");
    refused("t_ns,gx,gy,gz,gyro_x,gyro_y,gyro_z\n0,1,2,3,4,5,6\n", "'gx' and 'gyro_x'");
    refused("ax,ay,az\n0,0,9.8\n0,0,9.8\n", "--rate");
    refused("t_ns,gx_raw,gy_raw,gz_raw\n0,1,2,3\n10000000,1,2,3\n", "--units gyro=");
    refused("t_ns,ax [foo],ay,az\n0,1,2,3\n10000000,1,2,3\n", "--units accel=");
    refused("foo,bar,baz\n0,1,2\n", "--columns");
    refused("t_ns,gx,gy,gz\n0,1,2,3,4\n5,1,2,3,4\n", "names 4 columns, but line 2 has 5");
    // 4 kHz in nanoseconds, or 4 Hz in microseconds?
    refused("time,gx,gy,gz,ax,ay,az\n0,0,0,0,0,0,9.8\n250000,0,0,0,0,0,9.8\n500000,0,0,0,0,0,9.8\n",
            "--units t=ns");
    // gravity in g: then the rate may be in anything
    refused("t_ns,gx,gy,gz,ax,ay,az\n0,0.1,0,0,0,0,1\n10000000,0.1,0,0,0,0,1\n", "--units gyro=");
    refused("1.30503e+09 0 0 0 0 0 0 1\n1.30503e+09 0 0 0 0 0 0 1\n", "--rate");
    refused("{\"a\": [\n1, 2\n]}\n", "--columns");
}

TEST(FieldFiles, KittiNeedsTimes) {
    std::string rows;
    for (int i = 0; i < 30; ++i) {
        const double a = 0.1 * i;
        rows += digits(std::cos(a)) + " " + digits(-std::sin(a)) + " 0 " + std::to_string(i) + " " +
                digits(std::sin(a)) + " " + digits(std::cos(a)) + " 0 2 0 0 1 3\n";
    }
    EXPECT_NE(refusal_of(rows).find("--rate HZ, or --times FILE"), std::string::npos);
    ReadOptions options;
    options.rate_hz = 10;
    const Recording read = parse_recording(rows, "x", options);
    EXPECT_EQ(read.format, Format::kitti);
    EXPECT_EQ(read.t_ns(7), 700000000);
    EXPECT_EQ(read.poses[7].p_w_m.x, 7);
    EXPECT_NEAR(static_cast<double>(read.poses[7].q_wb.z), std::sin(0.35), 1e-6);
    EXPECT_NEAR(static_cast<double>(read.poses[29].q_wb.w), std::cos(1.45), 1e-6);
    const std::string path = testing::TempDir() + "fairlead_times.txt";
    std::ofstream file(path);
    for (int i = 0; i < 30; ++i) file << decimal(100 * i, 1000) << "e+00\n";
    file.close();
    options.rate_hz = 0;
    options.times = path;
    EXPECT_EQ(parse_recording(rows, "x", options).t_ns(29), 2900000000);
    EXPECT_NE(refusal_of(rows + rows, options).find("30 times for 60 records"), std::string::npos);
}

TEST(FieldFiles, PhoneFilesAreMergedByTime) {
    const auto samples = turning(400, 1700000000000000000, 5000000);
    const std::string folder = testing::TempDir();
    const auto write = [&](const std::string& name, Vec3 Sample::*values, std::int64_t shift_ns,
                           std::size_t every) {
        std::ofstream file(folder + name);
        file << "time,seconds_elapsed,z,y,x\n";
        for (std::size_t i = 0; i < samples.size(); i += every) {
            const Vec3& v = samples[i].*values;
            const std::int64_t t = samples[i].t_ns + shift_ns;
            file << t << "," << decimal(t - samples[0].t_ns + 1000000, 1000000000) << ","
                 << digits(static_cast<double>(v.z)) << "," << digits(static_cast<double>(v.y))
                 << "," << digits(static_cast<double>(v.x)) << "\n";
        }
    };
    write("Gyroscope.csv", &Sample::gyro_rad_s, 0, 1);
    write("Accelerometer.csv", &Sample::accel_m_s2, 1700000, 1);
    write("Magnetometer.csv", &Sample::mag_uT, 900000, 10);
    ReadOptions options;
    options.with = {folder + "Accelerometer.csv", folder + "Magnetometer.csv"};
    const Recording read = read_recording(folder + "Gyroscope.csv", options);
    ASSERT_EQ(read.samples.size(), 400u);
    std::size_t fields = 0;
    for (std::size_t i = 0; i < 400; ++i) {
        const Sample& s = read.samples[i];
        ASSERT_TRUE(s.flags & flag::accel_valid) << i;
        ASSERT_LT(apart(s.accel_m_s2, samples[i].accel_m_s2), 1e-5);
        ASSERT_LT(apart(s.gyro_rad_s, samples[i].gyro_rad_s), 1e-5);
        fields += (s.flags & flag::mag_valid) != 0 ? 1 : 0;
    }
    EXPECT_EQ(fields, 40u);
    EXPECT_TRUE(says(read.notes, "moved by 1.700 ms at most"));
    options.with = {folder + "Gyroscope.csv"};
    EXPECT_THROW(read_recording(folder + "Gyroscope.csv", options), BadData);
    options.with = {folder + "Magnetometer.csv"};
    EXPECT_THROW(read_recording(folder + "Accelerometer.csv", options), BadData) << "no gyroscope";
    write("Magnetometer.csv", &Sample::mag_uT, 9000000000, 10);
    EXPECT_THROW(read_recording(folder + "Gyroscope.csv", options), BadData) << "no overlap";
    EXPECT_NE(refusal_of(read_bytes(folder + "Gyroscope.csv"), {}, "x").find("x, y, z"),
              std::string::npos);
}

/// The kinds of docs/formats.md, "Files of these kinds", each written anew.
TEST(FieldFiles, EveryKindOfTheTableIsReadRightlyOrRefusedWithARemedy) {
    constexpr int n = 300;
    const auto quat = [](int i) {
        return std::array<double, 2>{std::cos(i * 0.002), std::sin(i * 0.002)};
    };
    // rows of poses: stamp, position, quaternion with the scalar last
    const auto poses = [&](const std::string& separator,
                           const std::function<std::string(int)>& before, double away,
                           const std::string& after) {
        std::string text;
        for (int i = 0; i < n; ++i) {
            const auto [w, z] = quat(i);
            text += before(i);
            for (const double v : {away + 0.01 * i, -away, 1.0, 0.0, 0.0, z, w})
                text += separator + digits(v);
            text += after + "\n";
        }
        return text;
    };
    const auto seconds = [](int i) { return decimal(1305031102000 + 20 * i, 1000); };
    const auto right = [&](const std::string& text, double away = 0) {
        const Recording r = parse_recording(text, "x");
        ASSERT_EQ(r.poses.size(), std::size_t{n}) << text.substr(0, 80);
        for (int i = 0; i < n; ++i) {
            const Pose& p = r.poses[static_cast<std::size_t>(i)];
            ASSERT_EQ(p.t_ns - r.poses[0].t_ns, std::int64_t{20000000} * i);
            ASSERT_NEAR(static_cast<double>(p.q_wb.w), quat(i)[0], 1e-6);
            ASSERT_NEAR(static_cast<double>(p.q_wb.z), quat(i)[1], 1e-6);
            ASSERT_NEAR(static_cast<double>(p.p_w_m.x), away + 0.01 * i, 1e-7 * away + 1e-6);
        }
    };
    const auto ns = [](int i) { return std::to_string(1305031102000000000 + 20000000LL * i); };
    right("#timestamp [ns],tx,ty,tz,qx,qy,qz,qw\n" + poses(",", ns, 0, ""));
    right("#sec,nsec,x,y,z,qx,qy,qz,qw\n" + poses(
                                                ",",
                                                [](int i) {
                                                    return std::to_string(1305031102 + i / 50) +
                                                           "," +
                                                           std::to_string(20000000 * (i % 50));
                                                },
                                                0, ""));
    right("#num,t,x,y,z,qx,qy,qz,qw\n" +
          poses(
              ",", [&](int i) { return std::to_string(i) + "," + seconds(i); }, 0, ""));
    right("# timestamp(s) tx ty tz qx qy qz qw Pr11 Pr12 Pr13 Pr22 Pr23 Pr33 Pt11 Pt12\n" +
          poses(" ", seconds, 0, " 0 0 0 0 0 0 0 0"));
    right(poses(" ", seconds, 0, " 0 0 0 0 0 0 0 0"));
    right("\xEF\xBB\xBF" + poses(" ", seconds, 0, ""));
    right("timestamp tx ty tz qx qy qz qw\n" + poses(" ", seconds, 0, ""));
    right(poses(" ", seconds, 5000, ""), 5000);
    right(poses(" ", seconds, 30000, ""), 30000);
    right(utf16(poses(" ", seconds, 0, ""), true));
    const std::string plain = poses(" ", seconds, 0, "");
    std::size_t in_line_226 = 0;
    for (int i = 0; i < 225; ++i) in_line_226 = plain.find('\n', in_line_226) + 1;
    const std::string cut = utf16(plain.substr(0, in_line_226 + 24), true);
    const std::string why = refusal_of(cut);
    EXPECT_NE(why.find("line 226"), std::string::npos) << why;
    EXPECT_NE(why.find("--salvage"), std::string::npos) << why;
    EXPECT_NE(refusal_of(poses(
                             " ", [](int) { return std::string{"1.30503e+09"}; }, 0, ""))
                  .find("--rate HZ"),
              std::string::npos);

    const auto samples = turning(n, 1403636579758555392, 5000000);
    const auto imu = [&](const std::string& header, std::int64_t per_unit, const std::string& sep,
                         bool accel_first, const std::string& after) {
        std::string text = header + "\n";
        for (const Sample& s : samples) {
            text += std::to_string(per_unit == 1 ? s.t_ns
                                                 : 1000000 + (s.t_ns - samples[0].t_ns) / per_unit);
            for (const Vec3& v : {accel_first ? s.accel_m_s2 : s.gyro_rad_s,
                                  accel_first ? s.gyro_rad_s : s.accel_m_s2})
                for (const float x : {v.x, v.y, v.z}) text += sep + digits(static_cast<double>(x));
            text += after + "\n";
        }
        return text;
    };
    const auto sensed = [&](const std::string& text, const char* note, float temperature = 0) {
        const Recording r = parse_recording(text, "x");
        ASSERT_EQ(r.samples.size(), samples.size()) << text.substr(0, 80);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            ASSERT_EQ(r.samples[i].t_ns - r.samples[0].t_ns, samples[i].t_ns - samples[0].t_ns);
            ASSERT_LT(apart(r.samples[i].gyro_rad_s, samples[i].gyro_rad_s), 1e-5);
            ASSERT_LT(apart(r.samples[i].accel_m_s2, samples[i].accel_m_s2), 1e-4);
            if (temperature > 0) {
                ASSERT_EQ(r.samples[i].temperature_c, temperature);
            }
        }
        if (*note != 0) {
            EXPECT_TRUE(says(r.notes, note)) << text.substr(0, 80);
        }
    };
    sensed(imu("#time,ax,ay,az,gx,gy,gz", 1, ",", true, ""), "are taken as ns");
    sensed(imu("timestamp,omega_x,omega_y,omega_z,alpha_x,alpha_y,alpha_z", 1, ",", false, ""),
           "are taken as ns");
    sensed(imu("#timestamp ms,omega_x,omega_y,omega_z,alpha_x,alpha_y,alpha_z", 1000000, ",", false,
               ""),
           "");
    sensed(imu("#timestamp,omega_x,omega_y,omega_z,alpha_x,alpha_y,alpha_z", 1000, ",", false, ""),
           "are taken as us");
    sensed(imu("#timestamp;wx;wy;wz;ax;ay;az", 1, ";", false, ""), "are taken as ns");
    sensed(imu("#timestamp [ns],wx,wy,wz,ax,ay,az,temperature [degC]", 1, ",", false, ",31.5"), "",
           31.5f);
    // a spreadsheet's 15 digits: read, and what is left of the time is told
    std::string excel = "#timestamp [ns],w_RS_S_x [rad s^-1],w_y,w_z,a_x [m s^-2],a_y,a_z\n";
    for (const Sample& s : samples) {
        char stamp[40];
        std::snprintf(stamp, sizeof stamp, "%.14E", static_cast<double>(s.t_ns));
        excel += std::string(stamp) + ",0,0,0,0,0,9.8\n";
    }
    const Recording spread = parse_recording(excel, "x");
    ASSERT_EQ(spread.samples.size(), samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
        EXPECT_LE(std::llabs(spread.samples[i].t_ns - samples[i].t_ns), 5000);
    EXPECT_TRUE(says(spread.notes, "steps of 1e-5 s"));
}

TEST(FieldFiles, DatesOfTheCalendarAreTimes) {
    const auto first_ns = [](const std::string& stamp, const std::string& next) {
        const std::string rest = ",0.1,0.2,0.3,0,0,9.8\n";
        const std::string header = "time [ms],gx,gy,gz,ax,ay,az\n";  // a date is no millisecond
        const Recording read = parse_recording(header + stamp + rest + next + rest, "x");
        EXPECT_TRUE(says(read.notes, "dates of the calendar"));
        EXPECT_EQ(read.t_ns(1) - read.t_ns(0), 10000000) << stamp;
        return read.t_ns(0);
    };
    EXPECT_EQ(first_ns("2023-05-01T12:34:56.123456789Z", "2023-05-01T12:34:56.133456789Z"),
              1682944496123456789);
    EXPECT_EQ(first_ns("2023-05-01 14:34:56.5+02:00", "2023-05-01 14:34:56.510+02:00"),
              1682944496500000000);
    EXPECT_EQ(first_ns("\"2023-05-01T07:04:56.5-0530\"", "\"2023-05-01T07:04:56.51-0530\""),
              1682944496500000000);
    EXPECT_EQ(first_ns("2024-02-29T23:59:59.995", "2024-03-01T00:00:00.005"), 1709251199995000000);
    EXPECT_EQ(first_ns("1970/01/01 00:00:00", "1970/01/01 00:00:00.01"), 0);
    // blanks between the columns, a comma in the numbers, a file of times
    EXPECT_EQ(parse_recording("2023-05-01 12:34:56 1 2 3 0 0 0 1\n"
                              "2023-05-01 12:34:56.02 1 2 3 0 0 0 1\n",
                              "x")
                  .t_ns(1),
              1682944496020000000);
    EXPECT_EQ(parse_recording("time;gx;gy;gz;ax;ay;az\n"
                              "2023-05-01T12:34:56,5;0,1;0;0;0;0;9,8\n"
                              "2023-05-01T12:34:56,6;0,1;0;0;0;0;9,8\n",
                              "x")
                  .t_ns(0),
              1682944496500000000);
    // what is no date is refused in its place
    for (const char* bad : {"2023-02-29T00:00:00", "2023-13-01T00:00:00", "2023-05-01T24:00:00",
                            "2023-05-01T12:34:56+25:00", "1969-12-31T23:59:59", "2023-05-01"}) {
        const std::string why = refusal_of(
            "time,gx,gy,gz,ax,ay,az\n"
            "2023-05-01T12:34:56Z,0,0,0,0,0,9.8\n"
            "2023-05-01T12:34:57Z,0,0,0,0,0,9.8\n" +
            std::string(bad) + ",0,0,0,0,0,9.8\n");
        EXPECT_NE(why.find("line 4, column 1 (time): '" + std::string(bad)), std::string::npos)
            << why;
    }
}

TEST(FieldFiles, MissingReadingsAreNoMeasurement) {
    const Recording read = parse_recording(
        "t_ns,gx,gy,gz,mx "
        "[uT],my,mz\n0,1,2,3,,,\n10000000,1,2,3,nan,NaN,\n20000000,1,2,3,20,0,-40\n",
        "x");
    EXPECT_EQ(read.samples[0].flags, flag::gyro_valid);
    EXPECT_EQ(read.samples[1].flags, flag::gyro_valid);
    EXPECT_EQ(read.samples[2].flags, flag::gyro_valid | flag::mag_valid);
}

TEST(FieldFiles, SecondsAndNanosecondsAreOneTime) {
    const Recording read = parse_recording(
        "#sec,nsec,x,y,z,qx,qy,qz,qw\n1305031102,999999999,1,2,3,0,0,0,1\n"
        "1305031103,20000000,1,2,3,0,0,0,1\n",
        "x");
    EXPECT_EQ(read.t_ns(0), 1305031102999999999);
    EXPECT_EQ(read.t_ns(1), 1305031103020000000);
    EXPECT_EQ(read.poses[0].q_wb.w, 1);
}

/// What is read without an error and cannot be meant is told, with the option.
TEST(FieldFiles, DoubtsAreTold) {
    const auto samples = turning(300, 0, 10000000);
    const auto told = [&](void (*spoil)(Sample&), const char* what) {
        Recording r;
        r.samples = samples;
        for (Sample& s : r.samples) spoil(s);
        const auto all = doubts(r);
        EXPECT_TRUE(says(all, what)) << what << (all.empty() ? "" : all[0]);
    };
    Recording good;
    good.samples = samples;
    EXPECT_TRUE(doubts(good).empty());
    const auto scale = [](Vec3& v, float f) { v = {v.x * f, v.y * f, v.z * f}; };
    static const auto scaled = scale;
    told([](Sample& s) { scaled(s.accel_m_s2, 1 / 9.80665f); }, "--units accel=g");
    told([](Sample& s) { scaled(s.accel_m_s2, 1000 / 9.80665f); }, "--units accel=mg");
    told([](Sample& s) { scaled(s.accel_m_s2, 0.01f); }, "gravity has been taken out");
    told([](Sample& s) { scaled(s.gyro_rad_s, 57.2957795f); }, "it is in deg/s");
    told([](Sample& s) { scaled(s.gyro_rad_s, 1000); }, "--units gyro=");
    told([](Sample& s) { scaled(s.mag_uT, 0.01f); }, "--units mag=gauss");
    told([](Sample& s) { s.mag_uT = {}; }, "the magnetometer reads zero in all 300");
    told([](Sample& s) { s.gyro_rad_s = {}; }, "the gyroscope reads zero");
    told([](Sample& s) { s.t_ns /= 1000; }, "above 20 kHz");
    told([](Sample& s) { s.t_ns *= 10000; }, "below 0.1 Hz");
    Recording poses;
    for (int i = 0; i < 50; ++i) {
        Pose p;
        p.t_ns = i * 10000000;
        p.q_wb = {0.01f, 0, 0, 0.99995f};
        p.flags = flag::orientation_valid;
        poses.poses.push_back(p);
    }
    EXPECT_TRUE(says(doubts(poses), "qx,qy,qz,qw"));
}
