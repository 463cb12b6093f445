// Edges and buttons over a fake line; built twice, against libgpiod 1's header and against
// declarations of version 2.
#include <gpiod.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <utility>
#include <vector>

#include "port/linux/button.hpp"
#include "port/linux/clock.hpp"
#include "port/linux/gpio.hpp"
#include "tests/port/gpio/fake.hpp"

namespace fairlead::port {
namespace {

using test::line;

#ifdef GPIOD_LINE_BULK_MAX_LINES
constexpr bool version_one = true;
#else
constexpr bool version_one = false;
#endif

class Gpio : public ::testing::Test {
  protected:
    Gpio() {
        line().events.clear();
        line().made_empty();
        line().sequence = 0;
        line().open_error = line().line_error = line().read_error = 0;
    }
    ~Gpio() override {
        edges.close();
        EXPECT_EQ(line().chips, 0);
        EXPECT_EQ(line().requests, 0);
    }
    static std::int64_t soon() { return now_ns() + 20 * ms; }
    GpioEdges edges;
};

TEST_F(Gpio, EdgesComeInOrderWithTheKernelsTimes) {
    ASSERT_EQ(edges.open("/dev/gpiochip0", 3), Status::ok);
    EXPECT_EQ(line().edges, 1);
    EXPECT_TRUE(line().monotonic);
    line().pull(1000000005, true);
    line().pull(2000000007, true);
    EXPECT_EQ(edges.wait(soon())->t_ns, 1000000005);
    EXPECT_EQ(edges.wait(0)->t_ns, 2000000007) << "one that has come is not delayed by a deadline";
    EXPECT_EQ(edges.dropped(), 0u);
}

TEST_F(Gpio, WaitEndsAtItsDeadline) {
    ASSERT_EQ(edges.open("/dev/gpiochip0", 3), Status::ok);
    const std::int64_t start = now_ns();
    EXPECT_EQ(edges.wait(start + 30 * ms).status(), Status::timeout);
    EXPECT_GE(now_ns() - start, 30 * ms);
    EXPECT_EQ(edges.wait(start).status(), Status::timeout);
}

TEST_F(Gpio, KindsOfEdges) {
    ASSERT_EQ(edges.open("/dev/gpiochip0", 3, EdgeKind::falling), Status::ok);
    EXPECT_EQ(line().edges, 2);
    ASSERT_EQ(edges.open("/dev/gpiochip0", 3, EdgeKind::both), Status::ok);
    EXPECT_EQ(line().edges, 3);
    line().pull(1, true);
    line().pull(2, false);
    EXPECT_TRUE(edges.wait(soon())->rising);
    EXPECT_FALSE(edges.wait(soon())->rising);
}

TEST_F(Gpio, FailuresAreSaidAndLeaveNothingOpen) {
    line().open_error = ENOENT;
    EXPECT_EQ(edges.open("/dev/gpiochip9", 3), Status::not_found);
    EXPECT_EQ(edges.last_errno(), ENOENT);
    line().open_error = EACCES;
    EXPECT_EQ(edges.open("/dev/gpiochip0", 3), Status::no_permission);
    line().open_error = 0;
    line().line_error = EBUSY;
    EXPECT_EQ(edges.open("/dev/gpiochip0", 3), Status::busy);
    line().line_error = 0;
    EXPECT_EQ(edges.open("/dev/gpiochip0", 99), Status::bad_argument);
    EXPECT_FALSE(edges.is_open());
    EXPECT_EQ(line().chips, 0);
    EXPECT_EQ(edges.wait(soon()).status(), Status::closed);
    ASSERT_EQ(edges.open("/dev/gpiochip0", 3), Status::ok);
    line().read_error = EIO;
    line().pull(1, true);
    EXPECT_EQ(edges.wait(soon()).status(), Status::io_error);
}

TEST_F(Gpio, DroppedEdgesAreCounted) {
    ASSERT_EQ(edges.open("/dev/gpiochip0", 3), Status::ok);
    for (int i = 0; i < 16; ++i) line().pull(i, true);
    for (int i = 0; i < 24; ++i) line().pull(100 + i, true, true);  // the kernel drops these
    for (int i = 0; i < 16; ++i) EXPECT_TRUE(edges.wait(soon()));
    line().pull(200, true);
    EXPECT_TRUE(edges.wait(soon()));
    EXPECT_EQ(edges.dropped(), version_one ? 1u : 24u);
}

TEST_F(Gpio, OwnershipMoves) {
    ASSERT_EQ(edges.open("/dev/gpiochip0", 3), Status::ok);
    GpioEdges other{std::move(edges)};
    EXPECT_FALSE(edges.is_open());
    line().pull(5, true);
    EXPECT_EQ(other.wait(soon())->t_ns, 5);
}

TEST_F(Gpio, DataReadyGivesBareTimes) {
    DataReady ready;
    ASSERT_EQ(ready.open("/dev/gpiochip0", 3), Status::ok);
    line().pull(42, true);
    EXPECT_EQ(*ready.wait(soon()), 42);
}

TEST(Button, TellsTheFirstEdgeOfABounce) {
    Debounce button{10 * ms};
    const auto press = button.push({100 * ms, true});
    ASSERT_TRUE(press);
    EXPECT_EQ(press->t_ns, 100 * ms);
    EXPECT_TRUE(press->on);
    EXPECT_FALSE(button.push({101 * ms, false}));
    EXPECT_FALSE(button.push({102 * ms, true}));
    EXPECT_FALSE(button.poll(120 * ms)) << "it came to rest where it was told";
    const auto release = button.push({500 * ms, false});
    ASSERT_TRUE(release);
    EXPECT_FALSE(release->on);
}

TEST(Button, ASpikeEndsInBothStatesTold) {
    Debounce button{10 * ms};
    EXPECT_TRUE(button.push({100 * ms, true}));
    EXPECT_FALSE(button.push({103 * ms, false}));
    EXPECT_FALSE(button.poll(105 * ms));
    const auto release = button.poll(111 * ms);
    ASSERT_TRUE(release);
    EXPECT_EQ(release->t_ns, 103 * ms);
    EXPECT_FALSE(release->on);
    EXPECT_FALSE(button.poll(200 * ms));
}

TEST(Button, ActiveLowContacts) {
    Debounce button{10 * ms, true};
    const auto press = button.push({100 * ms, false});
    ASSERT_TRUE(press);
    EXPECT_TRUE(press->on);
}

TEST_F(Gpio, AContactIsADiscreteChannel) {
    ASSERT_EQ(edges.open("/dev/gpiochip0", 3, EdgeKind::both), Status::ok);
    Contact contact{edges, 6, Debounce{10 * ms}};
    std::vector<fairlead::Event> told;
    const auto tell = [&](const fairlead::Event& event) { told.push_back(event); };
    contact.step(90 * ms, tell);
    EXPECT_TRUE(told.empty());
    line().pull(100 * ms, true);
    line().pull(101 * ms, false);
    line().pull(102 * ms, true);
    line().pull(150 * ms, false);
    line().pull(151 * ms, true);  // pressed again within the bounce of the release
    contact.step(155 * ms, tell);
    contact.step(170 * ms, tell);
    ASSERT_EQ(told.size(), 3u);
    const std::int64_t times[] = {100 * ms, 150 * ms, 151 * ms};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(told[i].t_ns, times[i]);
        EXPECT_EQ(told[i].channel, 6);
        EXPECT_EQ(told[i].value, i != 1);
        EXPECT_EQ(told[i].flags, 0u);
    }
    for (int i = 0; i < 16; ++i) line().pull(200 * ms + i, i % 2 != 0);
    for (int i = 0; i < 24; ++i) line().pull(201 * ms + i, false, true);  // the kernel drops these
    contact.step(202 * ms, tell);
    line().pull(300 * ms, false);
    contact.step(300 * ms, tell);
    line().pull(400 * ms, true);
    contact.step(400 * ms, tell);
    std::size_t gaps = 0;
    for (const auto& event : told) gaps += (event.flags & flag::gap_before) != 0;
    EXPECT_EQ(gaps, 1u);
    EXPECT_EQ(told.back().t_ns, 400 * ms);
}

}  // namespace
}  // namespace fairlead::port
