// The Modbus RTU server on one end of a pseudo-terminal, raw frames on the other.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <random>
#include <string>

#include "port/linux/modbus_rtu.hpp"
#include "tests/gateway/modbus_peer.hpp"

namespace fairlead::port {
namespace {

Bytes with_crc(Bytes bytes) {
    const std::uint16_t crc = modbus::crc16(bytes.data(), bytes.size());
    bytes.push_back(static_cast<std::uint8_t>(crc & 0xFF));
    bytes.push_back(static_cast<std::uint8_t>(crc >> 8));
    return bytes;
}
Bytes frame(std::uint8_t unit, const Bytes& pdu) {
    Bytes bytes{unit};
    bytes.insert(bytes.end(), pdu.begin(), pdu.end());
    return with_crc(bytes);
}

class ModbusRtu : public ::testing::Test {
  protected:
    void SetUp() override {
        open_line();
        config_.device = path_.c_str();
        ASSERT_EQ(server_.open(config_, now_ns_), Status::ok);
    }
    void TearDown() override { close_line(); }

    void open_line() {
        std::array<char, 128> name{};
        ASSERT_EQ(openpty(&line_, &device_, name.data(), nullptr, nullptr), 0);
        fcntl(line_, F_SETFL, O_NONBLOCK);
        path_ = name.data();
    }
    void close_line() {
        if (line_ >= 0) close(line_);
        if (device_ >= 0) close(device_);
        line_ = device_ = -1;
    }
    void put(const Bytes& bytes) {
        ASSERT_EQ(write(line_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
        turn();
    }
    void turn() {
        std::int64_t wake_ns = now_ns_ + 1'000'000'000;
        pollfd polled{};
        server_.prepare(&polled, now_ns_, &wake_ns);
        poll(&polled, 1, 0);
        server_.serve(&polled, now_ns_);
    }
    void silence() {
        now_ns_ += 20'000'000;
        turn();
    }
    Bytes got() const {
        Bytes bytes(512);
        const ssize_t n = read(line_, bytes.data(), bytes.size());
        bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
        return bytes;
    }

    int line_{-1};
    int device_{-1};
    std::string path_;
    std::int64_t now_ns_{1'000'000'000'000};
    CountingBank bank_;
    ModbusCounters counters_;
    ModbusRtuConfig config_;
    ModbusRtuServer server_{bank_, counters_};
};

const Bytes answer_1005 = with_crc({7, 3, 2, 0x03, 0xED});

TEST(ModbusCrc, MatchesThePublishedExample) {
    // MODBUS over Serial Line V1.02, 6.2.2: the CRC of 02 07 is 0x1241, sent low byte first
    EXPECT_EQ(with_crc({0x02, 0x07}), (Bytes{0x02, 0x07, 0x41, 0x12}));
}

TEST_F(ModbusRtu, AnswersAWholeReadAtOnce) {
    put(frame(7, read_pdu(3, 5, 1)));
    EXPECT_EQ(got(), answer_1005);
    put(frame(7, read_pdu(4, 0, 125)));
    EXPECT_EQ(got().size(), 255u);
}

TEST_F(ModbusRtu, RefusesWritesAndBadReadsWithTheirExceptions) {
    put(frame(7, {6, 0, 0, 0, 1}));
    silence();
    EXPECT_EQ(got(), with_crc({7, 0x86, 0x01}));
    put(frame(7, {16, 0, 0, 0, 1, 2, 0, 9}));
    silence();
    EXPECT_EQ(got(), with_crc({7, 0x90, 0x01}));
    put(frame(7, read_pdu(3, 0, 126)));
    EXPECT_EQ(got(), with_crc({7, 0x83, 0x03}));
    put(frame(7, read_pdu(3, 300, 1)));
    EXPECT_EQ(got(), with_crc({7, 0x83, 0x02}));
}

TEST_F(ModbusRtu, IsSilentToOtherUnitsBroadcastsAndDamage) {
    put(frame(9, read_pdu(3, 5, 1)));
    silence();
    put(frame(0, read_pdu(3, 5, 1)));
    silence();
    EXPECT_EQ(counters_.rtu_foreign, 2u);
    Bytes damaged = frame(7, read_pdu(3, 5, 1));
    damaged[3] ^= 1;
    put(damaged);
    silence();
    put({7, 3, 0});
    silence();
    put(Bytes(300, 0x55));
    turn();
    silence();
    EXPECT_EQ(counters_.rtu_damaged, 3u);
    EXPECT_TRUE(got().empty());
    put(frame(7, read_pdu(3, 5, 1)));
    EXPECT_EQ(got(), answer_1005);
}

TEST_F(ModbusRtu, FindsARequestBehindNoiseOrBehindOthersTalk) {
    const Bytes ours = frame(7, read_pdu(3, 5, 1));
    for (Bytes before : {Bytes{0xFF, 0x00, 0xA5}, frame(9, {3, 4, 1, 2, 3, 4})}) {
        before.insert(before.end(), ours.begin(), ours.end());
        put(before);
        EXPECT_TRUE(got().empty());
        silence();
        EXPECT_EQ(got(), answer_1005);
    }
}

TEST_F(ModbusRtu, DribbledBytesMakeAFrameWithinTheGapAndNotBeyond) {
    const Bytes whole = frame(7, read_pdu(3, 5, 1));
    for (const std::uint8_t byte : whole) {
        put({byte});
        now_ns_ += 500'000;
    }
    EXPECT_EQ(got(), answer_1005);
    put({whole.begin(), whole.begin() + 4});
    now_ns_ += 20'000'000;
    put({whole.begin() + 4, whole.end()});
    silence();
    EXPECT_TRUE(got().empty());
    put(whole);
    EXPECT_EQ(got(), answer_1005);
}

TEST_F(ModbusRtu, NoiseIsNeverAnswered) {
    const unsigned seed = 77;
    std::mt19937 random{seed};
    for (int round = 0; round < 2000; ++round) {
        Bytes noise(1 + random() % 40);
        for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
        put(noise);
        silence();
    }
    EXPECT_TRUE(got().empty()) << "seed " << seed;
    put(frame(7, read_pdu(3, 5, 1)));
    EXPECT_EQ(got(), answer_1005);
}

TEST_F(ModbusRtu, ALostLineIsOpenedAgainWhenItIsBack) {
    const std::string before = path_;
    close_line();
    turn();
    EXPECT_FALSE(server_.is_open());
    EXPECT_EQ(counters_.rtu_lost_line, 1u);
    open_line();
    if (path_ != before) GTEST_SKIP() << "skipped: the system gave the terminal another name";
    now_ns_ += 2'000'000'000;
    turn();
    ASSERT_TRUE(server_.is_open());
    put(frame(7, read_pdu(3, 5, 1)));
    EXPECT_EQ(got(), answer_1005);
}

}  // namespace
}  // namespace fairlead::port
