// The Modbus TCP server against raw peers: right answers, right refusals, peers that misbehave.
#include <gtest/gtest.h>

#include <random>

#include "tests/gateway/modbus_peer.hpp"

namespace fairlead::port {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

/// The PDU of the answer; its header is checked.
Bytes ask(ServerUnderTest& s, const Peer& peer, const Bytes& pdu, std::uint8_t unit = 7) {
    peer.send(request(unit, pdu));
    s.until_requests(s.counters.requests + 1);
    const Bytes got = peer.receive(9);
    if (got.size() < 9) return {};
    EXPECT_EQ(modbus::word_at(&got[0]), 0x1234);
    EXPECT_EQ(modbus::word_at(&got[2]), 0);
    EXPECT_EQ(modbus::word_at(&got[4]) + 6u, got.size());
    EXPECT_EQ(got[6], unit);
    return {got.begin() + 7, got.end()};
}

TEST(ModbusTcp, FunctionsThreeAndFourReadTheSameTable) {
    ServerUnderTest s;
    const Peer peer{s.port};
    s.until_clients(1);
    for (const int function : {3, 4}) {
        const Bytes pdu = ask(s, peer, read_pdu(function, 100, 125));
        ASSERT_EQ(pdu.size(), 2u + 250u);
        EXPECT_EQ(pdu[0], function);
        EXPECT_EQ(pdu[1], 250);
        for (std::size_t i = 0; i < 125; ++i) {
            EXPECT_EQ(modbus::word_at(&pdu[2 + 2 * i]), 1100 + i);
        }
    }
    EXPECT_EQ(s.counters.requests, 2u);
}

TEST(ModbusTcp, EveryRefusalHasItsExceptionAndIsCounted) {
    ServerUnderTest s;
    const Peer peer{s.port};
    s.until_clients(1);
    struct Case {
        Bytes pdu;
        std::uint8_t unit;
        std::uint8_t exception;
    };
    const std::vector<Case> cases{
        {read_pdu(3, 0, 0), 7, 0x03},
        {read_pdu(3, 0, 126), 7, 0x03},
        {read_pdu(4, 0, 0xFFFF), 7, 0x03},
        {read_pdu(3, 299, 2), 7, 0x02},
        {read_pdu(3, 300, 1), 7, 0x02},
        {read_pdu(3, 0xFFFF, 125), 7, 0x02},
        {read_pdu(3, 0, 1), 1, 0x0B},
        {read_pdu(1, 0, 1), 7, 0x01},
        {{6, 0, 0, 0, 1}, 7, 0x01},
        {{16, 0, 0, 0, 1, 2, 0, 9}, 7, 0x01},
        {{5, 0, 0, 0xFF, 0}, 7, 0x01},
        {{15, 0, 0, 0, 1, 1, 1}, 7, 0x01},
        {{22, 0, 0, 0, 0, 0, 0}, 7, 0x01},
        {{23, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 9}, 7, 0x01},
        {{0x41, 1, 2}, 7, 0x01},
        {{3, 0, 0, 0}, 7, 0x03},
        {{3}, 7, 0x03},
        {{3, 0, 0, 0, 1, 0}, 7, 0x03},
    };
    for (const Case& c : cases) {
        const Bytes pdu = ask(s, peer, c.pdu, c.unit);
        ASSERT_EQ(pdu.size(), 2u) << "function " << int{c.pdu[0]};
        EXPECT_EQ(pdu[0], c.pdu[0] | 0x80);
        EXPECT_EQ(pdu[1], c.exception) << "function " << int{c.pdu[0]};
    }
    EXPECT_EQ(s.counters.requests, cases.size());
    EXPECT_EQ(s.counters.illegal_function, 8u);
    EXPECT_EQ(s.counters.illegal_address, 3u);
    EXPECT_EQ(s.counters.illegal_value, 6u);
    EXPECT_EQ(s.counters.unknown_unit, 1u);
    EXPECT_EQ(ask(s, peer, read_pdu(3, 0, 1)), (Bytes{3, 2, 0x03, 0xE8}));
}

TEST(ModbusTcp, BytesThatAreNotModbusEndTheConnectionAtOnce) {
    const std::vector<Bytes> streams{
        {0, 1, 0, 1, 0, 6},                    // protocol 1
        {0, 1, 0, 0, 0, 1},                    // too short to hold a function
        {0, 1, 0, 0, 0, 255},                  // longer than any ADU
        {0, 1, 0, 0, 0, 6, 7, 0x83, 0, 0, 0},  // an answer, not a request
        {0, 1, 0, 0, 0, 6, 7, 0},              // function 0
        {'G', 'E', 'T', ' ', '/'},
    };
    for (const Bytes& stream : streams) {
        ServerUnderTest s;
        const Peer peer{s.port};
        s.until_clients(1);
        peer.send(stream);
        s.until_clients(0);
        EXPECT_TRUE(peer.closed_by_server());
        EXPECT_EQ(s.counters.closed_protocol, 1u);
        EXPECT_EQ(s.server.clients(), 0u);
    }
}

TEST(ModbusTcp, RequestsMayArriveInAnyPortionsAndInARow) {
    ServerUnderTest s;
    const Peer peer{s.port};
    s.until_clients(1);
    const Bytes one = request(7, read_pdu(3, 5, 1));
    for (const std::uint8_t byte : one) {
        EXPECT_TRUE(peer.receive(0).empty());
        peer.send({byte});
        s.turn(1);
    }
    s.until_requests(1);
    EXPECT_EQ(peer.receive(11).size(), 11u);
    Bytes forty;
    for (int i = 0; i < 40; ++i) forty.insert(forty.end(), one.begin(), one.end());
    peer.send(forty);
    s.until_requests(41);
    EXPECT_EQ(peer.receive(40 * 11).size(), 40u * 11u);
}

TEST(ModbusTcp, AFloodGetsOneAnswerPerTurn) {
    ModbusTcpLimits limits;
    limits.requests_per_second = 0;
    ServerUnderTest s{limits};
    const Peer flood{s.port};
    const Peer good{s.port};
    s.until_clients(2);
    Bytes many;
    for (int i = 0; i < 200; ++i) {
        const Bytes one = request(7, read_pdu(3, 0, 125));
        many.insert(many.end(), one.begin(), one.end());
    }
    flood.send(many);
    s.until_requests(1);
    good.send(request(7, read_pdu(3, 0, 1)));
    pollfd arrived{s.polled[2].fd, POLLIN, 0};  // listener, flood, good
    ASSERT_EQ(poll(&arrived, 1, 2000), 1);
    const std::uint64_t before = s.counters.requests;
    s.turn();
    EXPECT_EQ(good.receive(11).size(), 11u);
    EXPECT_EQ(s.counters.requests, before + 2);
}

TEST(ModbusTcp, FasterThanAgreedWaitsAndLosesNothing) {
    ModbusTcpLimits limits;
    limits.requests_per_second = 100;
    limits.burst = 5;
    ServerUnderTest s{limits};
    const Peer peer{s.port};
    s.until_clients(1);
    for (int i = 0; i < 20; ++i) peer.send(request(7, read_pdu(3, 0, 1)));
    s.until_requests(6);  // the burst, and the one that is due
    for (unsigned i = 1; i <= 14; ++i) {
        for (int turn = 0; turn < 3; ++turn) s.turn(1);
        EXPECT_EQ(s.counters.requests, 5u + i);
        s.now_ns += second_ns / 100;
        s.until_requests(6 + i);
    }
    EXPECT_EQ(peer.receive(20 * 11).size(), 20u * 11u);
}

TEST(ModbusTcp, HalfAFrameIsCutOffAtItsDeadlineHoweverItDribbles) {
    ServerUnderTest s;
    const Peer dribbler{s.port};
    const Peer good{s.port};
    s.until_clients(2);
    const Bytes adu = request(7, read_pdu(3, 0, 1));
    std::size_t sent = 0;
    for (int tenth = 0; tenth < 19; ++tenth) {
        if (tenth % 4 == 0) {
            dribbler.send({adu[sent++]});
            pollfd arrived{s.polled[1].fd, POLLIN, 0};  // listener, dribbler, good
            ASSERT_EQ(poll(&arrived, 1, 2000), 1);
            s.turn();
        }
        EXPECT_EQ(ask(s, good, read_pdu(3, 0, 1)).size(), 4u);
        s.now_ns += second_ns / 10;
    }
    EXPECT_TRUE(dribbler.still_open());
    s.now_ns += second_ns / 10;
    s.turn();
    EXPECT_TRUE(dribbler.closed_by_server());
    EXPECT_EQ(s.counters.closed_deadline, 1u);
    EXPECT_TRUE(good.still_open());
}

TEST(ModbusTcp, SilentConnectionsEndAndAskingOnesStay) {
    ServerUnderTest s;
    const Peer silent{s.port};
    const Peer asking{s.port};
    s.until_clients(2);
    EXPECT_EQ(ask(s, asking, read_pdu(3, 0, 1)).size(), 4u);
    s.now_ns += 6 * second_ns;
    s.turn();
    EXPECT_TRUE(silent.closed_by_server());
    EXPECT_TRUE(asking.still_open());
    s.now_ns += 120 * second_ns;
    s.turn();
    EXPECT_TRUE(asking.closed_by_server());
    EXPECT_EQ(s.counters.closed_idle, 2u);
}

TEST(ModbusTcp, NoHostTakesMoreThanItsShareAndSlotsAreUsedAgain) {
    ModbusTcpLimits limits;
    limits.clients = 6;
    limits.clients_per_host = 4;
    ServerUnderTest s{limits};
    std::vector<Peer> peers;
    for (int i = 0; i < 6; ++i) peers.emplace_back(s.port);
    s.until([&] { return s.counters.refused_full == 2; });
    EXPECT_EQ(s.server.clients(), 4u);
    EXPECT_TRUE(peers[5].closed_by_server());
    peers.clear();
    s.until_clients(0);
    for (int i = 0; i < 1000; ++i) {
        {
            const Peer passing{s.port};
            s.until_clients(1);
        }
        s.until_clients(0);
    }
    EXPECT_EQ(s.counters.accepted, 1004u);
}

TEST(ModbusTcp, OtherNetworksAreTurnedAway) {
    ServerUnderTest s{{}, "127.0.0.1:0", "10.1.0.0/16"};
    const Peer peer{s.port};
    s.until([&] { return s.counters.refused_network == 1; });
    EXPECT_TRUE(peer.closed_by_server());
}

TEST(ModbusTcp, AReaderThatTakesNoAnswersIsCutOff) {
    ModbusTcpLimits limits;
    limits.requests_per_second = 0;
    ServerUnderTest s{limits};
    const Peer peer{s.port};
    const int small = 4096;  // or its kernel would take some megabytes first
    setsockopt(peer.fd(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    s.until_clients(1);
    for (int i = 0; i < 5000 && s.server.clients() == 1; ++i) {
        peer.send(request(7, read_pdu(3, 0, 125)));
        s.turn();
    }
    EXPECT_EQ(s.server.clients(), 0u);
    EXPECT_EQ(s.counters.closed_slow_reader, 1u);
}

TEST(ModbusTcp, NoiseNeverStopsTheServer) {
    const unsigned seed = 20241;
    std::mt19937 random{seed};
    ServerUnderTest s;
    const Peer good{s.port};
    s.until_clients(1);
    for (int round = 0; round < 400; ++round) {
        const Peer noisy{s.port};
        Bytes bytes(random() % 300);
        for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
        if (round % 2 == 0 && bytes.size() > 8) {  // half of them with a header that passes
            bytes[2] = bytes[3] = bytes[4] = 0;
            bytes[5] = static_cast<std::uint8_t>(2 + random() % 253);
            bytes[7] &= 0x7F;
        }
        noisy.send(bytes);
        s.turn(1);
        good.send(request(7, read_pdu(3, 0, 1)));
        s.until_requests(s.counters.requests + 1);
        s.now_ns += 10'000'000;
        for (int turn = 0; turn < 3; ++turn) s.turn();
        ASSERT_EQ(good.receive(11).size(), 11u) << "seed " << seed << " round " << round;
    }
}

TEST(ModbusTcp, ServesIPv6) {
    const int fd = socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in6 to{};
    to.sin6_family = AF_INET6;
    to.sin6_addr = in6addr_loopback;
    int error = 0;
    const auto probe = listen_on(*parse_endpoint("[::1]:0"), &error);
    if (!probe) {
        GTEST_SKIP() << "skipped ServesIPv6: this machine has no ::1: " << std::strerror(error);
    }
    close(*probe);
    ServerUnderTest s{{}, "[::1]:0"};
    to.sin6_port = htons(s.port);
    ASSERT_EQ(connect(fd, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
    const Bytes adu = request(7, read_pdu(3, 0, 1));
    ASSERT_EQ(send(fd, adu.data(), adu.size(), 0), static_cast<ssize_t>(adu.size()));
    s.until_requests(1);
    std::array<std::uint8_t, 64> answer{};
    EXPECT_EQ(recv(fd, answer.data(), answer.size(), 0), 11);
    close(fd);
}

TEST(ModbusNet, ParsesAddressesAndNetworks) {
    EXPECT_TRUE(parse_endpoint("127.0.0.1:1502")->is_loopback());
    EXPECT_TRUE(parse_endpoint("[::1]:1502")->is_loopback());
    EXPECT_FALSE(parse_endpoint("0.0.0.0:502")->is_loopback());
    EXPECT_FALSE(parse_endpoint("[::]:502")->is_loopback());
    for (const char* bad : {"", "127.0.0.1", "::1:1502", "localhost:1502", "127.0.0.1:65536",
                            "127.0.0.1:-1", "127.0.0.1:", "[127.0.0.1]:1", "1.2.3:4", "[::1]1"}) {
        EXPECT_FALSE(parse_endpoint(bad)) << bad;
    }
    const auto net = parse_network("192.168.4.0/22");
    ASSERT_TRUE(net);
    EXPECT_TRUE(net->contains(parse_network("192.168.7.255")->address));
    EXPECT_FALSE(net->contains(parse_network("192.168.8.0")->address));
    EXPECT_FALSE(net->contains(parse_network("::1")->address));
    EXPECT_TRUE(parse_network("fd00::/7")->contains(parse_network("fc12::1")->address));
    for (const char* bad : {"", "10.0.0.0/33", "fd00::/129", "10.0.0.0/", "10.0.0/8", "any"}) {
        EXPECT_FALSE(parse_network(bad)) << bad;
    }
}

}  // namespace
}  // namespace fairlead::port
