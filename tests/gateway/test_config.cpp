// The configuration: what it understands, and that every mistake is told with its line.
#include <gtest/gtest.h>

#include <algorithm>

#include "examples/gateway/config.hpp"

namespace fairlead::gateway {
namespace {

TEST(Config, TheCommentedExampleIsValidAndSaysTheDefaults) {
    const ConfigResult got = read_config("examples/gateway/gateway.toml");
    for (const auto& error : got.errors) ADD_FAILURE() << error;
    const Config fallback = default_config();
    EXPECT_TRUE(same_server(got.config, fallback));
    ASSERT_EQ(got.config.units.size(), 3u);
    const UnitConfig unit;
    EXPECT_EQ(got.config.units[0].file, "examples/gateway/motion.trk");
    EXPECT_EQ(got.config.units[0].speed, unit.speed);
    EXPECT_EQ(got.config.units[0].tolerance_m, unit.tolerance_m);
    EXPECT_EQ(got.config.units[0].tolerance_deg, unit.tolerance_deg);
    EXPECT_EQ(got.config.units[0].stale_s, unit.stale_s);
    EXPECT_EQ(got.config.units[1].line.baud, unit.line.baud);
    EXPECT_EQ(got.config.units[1].line.parity, unit.line.parity);
    EXPECT_EQ(got.config.units[1].source, SourceKind::serial);
    const UnitConfig& sensor = got.config.units[2];
    EXPECT_EQ(sensor.source, SourceKind::sensor);
    EXPECT_EQ(sensor.imu.sensor, unit.imu.sensor);
    EXPECT_EQ(sensor.imu.watermark, unit.imu.watermark);
    EXPECT_EQ(sensor.imu.address, 0x6A);
    EXPECT_EQ(sensor.bus, unit.bus);
    EXPECT_EQ(sensor.chip, unit.chip);
    EXPECT_EQ(sensor.line_number, 17u);
    ASSERT_EQ(sensor.buttons.size(), 1u);
    EXPECT_EQ(sensor.buttons[0].line, 22u);
    EXPECT_TRUE(sensor.buttons[0].active_low);
    EXPECT_EQ(got.config.log_level, Level::info);
}

TEST(Config, MistakesAreToldWithTheirLines) {
    const std::string unit = "[[unit]]\nid = 1\nsource = \"serial\"\ndevice = \"/dev/null\"\n";
    struct Case {
        std::string text;
        std::string error;
    };
    const std::vector<Case> cases{
        {"x = ", "c:1: "},
        {unit + "baud = 115201\n", "c:5: unit.baud is no usual rate"},
        {unit + "baud = \"fast\"\n", "c:5: unit.baud must be a whole number"},
        {unit + "boud = 9600\n", "c:5: unit.boud is not known here"},
        {unit + "parity = \"maybe\"\n", "c:5: unit.parity must be none, even or odd"},
        {unit + "speed = 2\n", "c:5: unit.speed is not known here"},
        {"[[unit]]\nid = 248\nsource = \"replay\"\nfile = \"a\"\n",
         "c:2: unit.id must be a whole number from 1 to 247"},
        {"[[unit]]\nid = 1\n", "c:1: unit.source is missing"},
        {"[[unit]]\nid = 1\nsource = \"radio\"\n", "c:3: unit.source must be"},
        {"unit = 3\n", "c:1: unit must be written as [[unit]]"},
        {unit + "[server]\nlisten = [\"127.0.0.1\"]\n", "c:6: server.listen must be like"},
        {unit + "[server]\nlisten = \"127.0.0.1:1\"\n", "c:6: server.listen must be a list"},
        {unit + "[server]\nallow = [\"all\"]\n", "c:6: server.allow must be like"},
        {unit + "[server]\nidle_s = 0\n", "c:6: server.idle_s must be a number from 1 to 86400"},
        {unit + "[server]\nexpose = 1\n", "c:6: server.expose must be true or false"},
        {unit + "[rtu]\nbaud = 9600\n", "c:5: rtu.device is missing"},
        {unit + "[rtu]\ndevice = \"/dev/null\"\n", "c: two users of the line /dev/null"},
        {unit + unit, "c: two units have the id 1"},
        {"log = \"loud\"\n" + unit, "c:1: log must be"},
        {"", "c: there is no [[unit]]"},
        {unit + "[server]\nlisten = [\"0.0.0.0:1502\"]\n", "c: server.listen leaves this machine"},
        {unit + "[server]\nlisten = [\"[::]:1502\"]\n", "c: server.listen leaves this machine"},
    };
    for (const Case& c : cases) {
        const ConfigResult got = parse_config(c.text, "c");
        const bool told = std::any_of(got.errors.begin(), got.errors.end(), [&](const auto& e) {
            return e.compare(0, c.error.size(), c.error) == 0;
        });
        EXPECT_TRUE(told) << c.text << "\nexpected: " << c.error
                          << "\ngot: " << (got.errors.empty() ? "nothing" : got.errors[0]);
    }
    EXPECT_TRUE(parse_config(unit, "c").errors.empty());
    EXPECT_TRUE(parse_config(unit + "[server]\nexpose = true\nlisten = [\"0.0.0.0:1502\"]\n", "c")
                    .errors.empty());
}

TEST(Config, AllMistakesAreToldAtOnce) {
    const ConfigResult got = parse_config(
        "log = 3\n[[unit]]\nid = 0\nsource = \"replay\"\n[server]\nclients = 1000\nfoo = 1\n", "c");
    EXPECT_EQ(got.errors.size(), 5u);  // log, id, file, clients, foo
}

}  // namespace
}  // namespace fairlead::gateway
