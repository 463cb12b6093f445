#pragma once
// What the drivers' tests share: a motion that tells the time, a chip with its bus and driver, and
// operations with a failure at transfer k, for all k.
#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "tests/port/model_bus.hpp"

namespace fairlead::port::test {

using sim::Truth;

/// A motion whose value tells the time: a slow ramp on each axis.
inline Truth ramp(std::int64_t t_ns) {
    const auto t = static_cast<float>(static_cast<double>(t_ns) * 1e-9);
    Truth truth;
    truth.gyro_rad_s = {0.5f * t, -0.25f * t, 0.125f * t};
    truth.accel_m_s2 = {t, -2 * t, 9.80665f};
    truth.mag_uT = {20 + t, -30 + t, 40 - t};
    truth.temperature_c = 31.5f;
    return truth;
}

/// Runs one operation with a failure at transfer k, for every k that it has. Looks at a chip that
/// is resetting may fail: at most so many as stated.
template <class Make>
void fail_at_every_transfer(Make make, int looks) {
    int transfers = 0;
    {
        auto run = make();
        const int before = run.bus->transfers;
        EXPECT_EQ(run.operation(), Status::ok);
        transfers = run.bus->transfers - before;
    }
    EXPECT_GT(transfers, 0);
    for (int k = 0; k < transfers; ++k) {
        for (const Status why : {Status::no_acknowledge, Status::timeout, Status::bus_error}) {
            auto run = make();
            const int before = run.bus->transfers;
            run.bus->fail_at = before + k;
            run.bus->failure = why;
            const Status s = run.operation();
            if (s == Status::ok && why == Status::timeout) --looks;
            if (s != Status::ok) {
                EXPECT_EQ(s, why) << "transfer " << k;
            }
            EXPECT_LE(run.bus->transfers - before, transfers + 1) << "nothing retries";
            run.bus->fail_at = -1;
            EXPECT_EQ(run.recover(), Status::ok) << "after a failure at transfer " << k;
        }
    }
    EXPECT_GE(looks, 0) << "other failures were not told";
}

template <class Chip>
struct Rig {
    std::unique_ptr<typename Chip::Model> model = Chip::model();
    std::unique_ptr<ModelBus> bus = std::make_unique<ModelBus>();
    std::unique_ptr<typename Chip::Driver> driver;
    std::function<Status()> operation, recover;

    Rig() {
        bus->chips = {model.get()};
        driver = std::make_unique<typename Chip::Driver>(*bus);
        recover = [this] {
            const Status s = driver->start(Chip::config(8));
            return s == Status::ok ? driver->check() : s;
        };
    }
    Rig(Rig&&) = delete;
};

template <class Chip, class Operation>
void fail_everywhere(Operation operation, bool started, int looks = 0) {
    fail_at_every_transfer(
        [&] {
            struct Run {
                std::unique_ptr<Rig<Chip>> rig = std::make_unique<Rig<Chip>>();
                ModelBus* bus = rig->bus.get();
                std::function<Status()> operation, recover = rig->recover;
            } run;
            if (started) {
                EXPECT_EQ(run.recover(), Status::ok);
                run.bus->pass(static_cast<std::int64_t>(Chip::period_ns * 12));
            }
            auto* rig = run.rig.get();
            run.operation = [rig, operation] { return operation(*rig); };
            return run;
        },
        looks);
}

}  // namespace fairlead::port::test
