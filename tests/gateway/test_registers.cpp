// The map, the files that are printed from it, and a unit's table read back field by field.
#include <gtest/gtest.h>

#include <cstring>

#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>

#include "examples/gateway/map_text.hpp"
#include "examples/gateway/register_map.hpp"
#include "examples/gateway/toml_parser.hpp"
#include "examples/gateway/unit_table.hpp"
#include "port/linux/registers_curve.hpp"

namespace fairlead::gateway {
namespace {

namespace reg = register_map;
using port::CurveChannel;
using port::CurveSpan;

std::uint64_t word(const std::uint16_t* table, std::string_view name) {
    return reg::get_word(table, reg::field(name));
}
float real(const std::uint16_t* table, std::string_view name) {
    return reg::get_f32(table + reg::field(name).address);
}

CurveSpan span_number(unsigned n, CurveChannel channel) {
    CurveSpan span;
    span.channel = channel;
    span.t0_ns = -5'000'000'000 + std::int64_t{n} * 70'000'001;
    span.sub_ns = 100'000;
    span.cover = n + 1;
    const auto number = [n](unsigned m, unsigned d) {
        return 0.1f * static_cast<float>(n + 10 * m + d);
    };
    span.anchor = {number(9, 0), number(9, 1), number(9, 2), number(9, 3)};
    for (unsigned m = 0; m < 4; ++m) span.power[m] = {number(m, 0), number(m, 1), number(m, 2)};
    span.begins = n % 7 == 0;
    return span;
}

TEST(RegisterMap, NamesAreUniqueAndEveryFieldIsInsideTheMap) {
    std::set<std::string_view> names;
    for (const reg::Field& row : reg::fields) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_LE(row.address + width_of(row.type), reg::map_length) << row.name;
    }
    EXPECT_LE(reg::live_size, 125);
    EXPECT_LE(reg::map_length, 65535);
}

TEST(RegisterMap, GeneratedFilesAreNotStale) {
    for (const GeneratedFile& file : generated_files) {
        std::ifstream in{file.path, std::ios::binary};
        const std::string now{std::istreambuf_iterator<char>{in}, {}};
        EXPECT_EQ(now, file.text()) << file.path << " is stale: run `make registers`";
    }
}

TEST(RegisterMap, TelegrafConfigurationKeepsToItsDocumentedSchema) {
    const toml::table root = toml::parse(map_telegraf());
    const auto& plugin = *(*root["inputs"]["modbus"].as_array())[0].as_table();
    EXPECT_EQ(plugin["configuration_type"].value<std::string>(), "request");
    const std::set<std::string> types{"INT16",  "UINT16",  "INT32",   "UINT32", "INT64",
                                      "UINT64", "FLOAT32", "FLOAT64", "STRING"};
    for (const auto& node : *plugin["request"].as_array()) {
        const auto& request = *node.as_table();
        EXPECT_EQ(request["byte_order"].value<std::string>(), "ABCD");
        EXPECT_EQ(request["register"].value<std::string>(), "holding");
        std::int64_t first = -1;
        std::int64_t next = -1;
        for (const auto& item : *request["fields"].as_array()) {
            const auto& field = *item.as_table();
            const auto address = *field["address"].value<std::int64_t>();
            const reg::Field& row = reg::field(*field["name"].value<std::string>());
            EXPECT_EQ(address, row.address);
            EXPECT_EQ(types.count(*field["type"].value<std::string>()), 1u);
            if (first < 0) first = next = address;
            EXPECT_EQ(address, next) << "a hole would split the request";
            next = address + width_of(row.type);
        }
        EXPECT_LE(next - first, 125);
    }
}

/// Keys and values as homeassistant/components/modbus/__init__.py has them in its schema.
TEST(RegisterMap, HomeAssistantConfigurationKeepsToItsDocumentedSchema) {
    std::istringstream in{map_home_assistant()};
    const std::set<std::string> keys{"name",      "unique_id",     "slave",
                                     "address",   "input_type",    "data_type",
                                     "precision", "scan_interval", "unit_of_measurement"};
    const std::map<std::string, reg::Type> types{
        {"uint16", reg::Type::u16}, {"uint32", reg::Type::u32},  {"uint64", reg::Type::u64},
        {"int64", reg::Type::i64},  {"float32", reg::Type::f32}, {"string", reg::Type::text}};
    std::set<std::string> ids;
    std::map<std::string, std::string> sensor;
    std::size_t sensors = 0;
    const auto finish = [&] {
        if (sensor.empty()) return;
        ++sensors;
        const std::string name = sensor["name"].substr(sensor["name"].rfind(' ') + 1);
        const reg::Field& row = reg::field(name.substr(0, name.find('"')));
        EXPECT_EQ(std::stoi(sensor["address"]), row.address);
        ASSERT_EQ(types.count(sensor["data_type"]), 1u) << sensor["data_type"];
        EXPECT_EQ(types.at(sensor["data_type"]), row.type);
        EXPECT_EQ(sensor["input_type"], "holding");
        EXPECT_EQ(sensor["slave"], "1");
        EXPECT_GE(std::stoi(sensor["scan_interval"]), 1);
        EXPECT_TRUE(ids.insert(sensor["unique_id"]).second);
        sensor.clear();
    };
    std::set<std::string> hub;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#') continue;
        const std::size_t at = line.find_first_not_of(' ');
        const bool item = line.compare(at, 2, "- ") == 0;
        const std::size_t from = item ? at + 2 : at;
        const std::size_t colon = line.find(':', from);
        ASSERT_NE(colon, std::string::npos) << line;
        const std::string key = line.substr(from, colon - from);
        if (from < 8) {
            hub.insert(key);
            continue;
        }
        EXPECT_EQ(from, 8u) << line;
        if (item) finish();
        EXPECT_EQ(keys.count(key), 1u) << key;
        sensor[key] = line.substr(std::min(line.size(), colon + 2));
    }
    finish();
    EXPECT_GT(sensors, 20u);
    EXPECT_EQ(hub, (std::set<std::string>{"modbus", "name", "type", "host", "port", "sensors"}));
}

class UnitTableTest : public ::testing::Test {
  protected:
    UnitTableTest() {
        table_->begin(9, "crane hook, north side", SourceKind::serial, 0xDEADBEEF, 2'000'000'000);
        server_.counters = &counters_;
        server_.started_ns = now_ns_ - 61'000'000'000;
    }
    const std::uint16_t* refreshed() {
        table_->collect(*feed_);
        table_->refresh(server_, now_ns_);
        return table_->registers();
    }
    void add(CurveChannel channel, unsigned n) {
        ASSERT_TRUE(feed_->spans.push({span_number(n, channel), SpanKind::append, 0}));
        table_->collect(*feed_);
    }

    std::int64_t now_ns_{1'000'000'000'000};
    port::ModbusCounters counters_{};
    ServerState server_{};
    std::unique_ptr<UnitFeed> feed_ = std::make_unique<UnitFeed>();
    std::unique_ptr<UnitTable> table_ = std::make_unique<UnitTable>();
};

TEST_F(UnitTableTest, IdentityAndProbes) {
    const std::uint16_t* r = refreshed();
    EXPECT_EQ(word(r, "magic"), reg::magic);
    EXPECT_EQ(r[0], 'F' << 8 | 'L');
    EXPECT_EQ(r[20], 0x3F80);
    EXPECT_EQ(r[21], 0);
    EXPECT_EQ(real(r, "probe.f32"), 1.0f);
    EXPECT_EQ(word(r, "probe.u64"), 0x0102030405060708u);
    EXPECT_EQ(word(r, "unit.epoch"), 0xDEADBEEFu);
    EXPECT_EQ(word(r, "unit.id"), 9u);
    EXPECT_EQ(r[12], 'c' << 8 | 'r');
    EXPECT_EQ(r[19], 'r' << 8 | 't');  // cut at 16 characters
    EXPECT_EQ(word(r, "live.status"), reg::status_bit::no_data | reg::status_bit::stale);
    EXPECT_EQ(word(r, "live.age_ms"), 65535u);
}

TEST_F(UnitTableTest, EveryLiveFieldArrives) {
    UnitState s;
    s.sequence = 77;
    s.epoch = 0xDEADBEEF;
    s.t_ns = now_ns_ - 12'000'000;
    s.source_ns = -3;
    s.arrival_ns = now_ns_ - 2'000'000;
    s.q_wb = {0.5f, 0.5f, 0.5f, 0.5f};
    s.p_w_m = {1, -2, 3};
    s.rate_rad_s = {4, 5, -6};
    s.v_w_m_s = {7, 8, 9};
    s.status = reg::status_bit::valid_orientation;
    s.deadline_misses = 5;
    counters_.requests = 0x1'0000'0003;
    feed_->state.write(s);
    const std::uint16_t* r = refreshed();
    EXPECT_EQ(word(r, "live.seq_begin"), 77u);
    EXPECT_EQ(word(r, "live.seq_end"), 77u);
    EXPECT_EQ(static_cast<std::int64_t>(word(r, "live.t_ns")), s.t_ns);
    EXPECT_EQ(static_cast<std::int64_t>(word(r, "clock.source_ns")), -3);
    EXPECT_EQ(static_cast<std::int64_t>(word(r, "clock.offset_ns")), s.t_ns + 3);
    EXPECT_EQ(real(r, "live.q_w"), 0.5f);
    EXPECT_EQ(real(r, "live.p_y"), -2.0f);
    EXPECT_EQ(real(r, "live.rate_z"), -6.0f);
    EXPECT_EQ(real(r, "live.v_x"), 7.0f);
    EXPECT_NEAR(real(r, "live.roll_deg"), 90, 1e-3);
    EXPECT_NEAR(real(r, "live.pitch_deg"), 0, 1e-3);
    EXPECT_NEAR(real(r, "live.yaw_deg"), 90, 1e-3);
    EXPECT_EQ(word(r, "live.age_ms"), 12u);
    EXPECT_EQ(word(r, "live.status"), reg::status_bit::valid_orientation);
    EXPECT_EQ(word(r, "health.deadline_misses"), 5u);
    EXPECT_EQ(word(r, "server.requests"), 3u);  // the low half, as any 32-bit counter
    EXPECT_EQ(word(r, "server.uptime_s"), 61u);
    now_ns_ += 3'000'000'000;
    EXPECT_NE(word(refreshed(), "live.status") & reg::status_bit::stale, 0u);
}

TEST_F(UnitTableTest, HistoryPagesSayWhereTheyBelongAndCarryEveryBit) {
    constexpr unsigned count = 3 * 128 + 5;  // the ring has gone round
    for (unsigned n = 0; n < count; ++n) {
        add(CurveChannel::orientation, n);
        if (n % 2 == 0) add(CurveChannel::position, n / 2);
    }
    const std::uint16_t* r = refreshed();
    EXPECT_EQ(word(r, "orientation.next"), count);
    EXPECT_EQ(word(r, "position.next"), (count + 1) / 2);
    for (unsigned n = count - 3 * 127; n < count; ++n) {
        const std::uint16_t* page = r + reg::page_address(reg::orientation_begin, n,
                                                          reg::spans_per_page, reg::history_pages);
        const reg::PageHeader header = reg::get_page_header(page);
        ASSERT_EQ(header.epoch, 0xDEADBEEFu);
        ASSERT_EQ(header.first, n / 3 * 3);
        ASSERT_LT(n - header.first, header.count);
        const CurveSpan got =
            reg::get_span(page + reg::page_header + (n - header.first) * reg::span_size,
                          CurveChannel::orientation, header.sub_ns);
        const CurveSpan put = span_number(n, CurveChannel::orientation);
        EXPECT_EQ(got.t0_ns, put.t0_ns);
        EXPECT_EQ(got.sub_ns, put.sub_ns);
        EXPECT_EQ(got.cover, put.cover);
        EXPECT_EQ(std::memcmp(&got.anchor, &put.anchor, sizeof put.anchor), 0);
        EXPECT_EQ(std::memcmp(&got.power, &put.power, sizeof put.power), 0);
        EXPECT_EQ(got.begins, put.begins);
    }
}

TEST_F(UnitTableTest, ARestartOfTheSourceLeavesNothingOfTheRunBefore) {
    for (unsigned n = 0; n < 10; ++n) add(CurveChannel::orientation, n);
    ASSERT_TRUE(feed_->spans.push({{}, SpanKind::restart, 0xFEED}));
    ASSERT_TRUE(
        feed_->spans.push({span_number(0, CurveChannel::orientation), SpanKind::append, 0}));
    const std::uint16_t* r = refreshed();
    EXPECT_EQ(word(r, "unit.epoch"), 0xFEEDu);
    EXPECT_EQ(word(r, "orientation.next"), 1u);
    EXPECT_EQ(reg::get_page_header(r + reg::orientation_begin).epoch, 0xFEEDu);
    EXPECT_EQ(reg::get_page_header(r + reg::orientation_begin + reg::page_size).epoch, 0u);
    EXPECT_EQ(word(r, "probe.u32"), 0x01020304u);
}

TEST_F(UnitTableTest, EventsKeepTheirExactTimes) {
    for (std::uint16_t n = 0; n < 45; ++n) {
        ASSERT_TRUE(feed_->events.push({std::int64_t{n} * 1'000'000'007, 3, n}));
    }
    const std::uint16_t* r = refreshed();
    EXPECT_EQ(word(r, "events.next"), 45u);
    const std::uint16_t* page = r + reg::events_begin + 2 * reg::page_size;
    EXPECT_EQ(reg::get_page_header(page).first, 38u);
    EXPECT_EQ(reg::get_page_header(page).count, 7u);
    const std::uint16_t* record = page + reg::page_header + 6 * reg::event_size;
    EXPECT_EQ(reg::get(record, 4), std::uint64_t{44} * 1'000'000'007);
    EXPECT_EQ(record[4], 3);
    EXPECT_EQ(record[5], 44);
}

}  // namespace
}  // namespace fairlead::gateway
