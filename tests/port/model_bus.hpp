#pragma once
// A bus of chip models in virtual time: each transfer takes what it would at 400 kHz, pauses pass
// at once, and any transfer can be made to fail.
#include <cstdint>
#include <vector>

#include "host_sim/chip_models/chip_model.hpp"
#include "port/sensors/bus.hpp"
#include "port/sensors/spi.hpp"

namespace fairlead::port::test {

class ModelBus {
  public:
    std::vector<sim::ChipModel*> chips;
    std::int64_t now_ns{1000000000};
    int transfers{0};
    int fail_at{-1};          // this transfer fails, counted from 0; negative: none
    bool stuck{false};        // every transfer times out
    bool fail_always{false};  // every transfer fails
    Status failure{Status::no_acknowledge};
    std::size_t longest_read{8192};
    std::int64_t paused_us{0};

    Status transfer(const Transfer* list, std::size_t count) noexcept {
        const int index = transfers++;
        if (stuck) {
            pass(10000000);
            return Status::timeout;
        }
        for (std::size_t i = 0; i < count; ++i) {
            const Transfer& t = list[i];
            if (index == fail_at || fail_always) {
                pass(byte_ns);
                return failure;
            }
            sim::ChipModel* chip = find(t.address);
            if (chip == nullptr) return Status::no_acknowledge;
            if (t.in_size > longest_read) return Status::bad_argument;
            chip->begin_write();
            pass(byte_ns * (1 + t.out_size));
            for (std::size_t k = 0; k < t.out_size; ++k) chip->write(t.out[k]);
            for (std::size_t k = 0; k < t.in_size; ++k) {
                t.in[k] = chip->read();
                pass(byte_ns);
            }
        }
        return Status::ok;
    }
    std::size_t read_max() const noexcept { return longest_read; }
    void pause_us(std::uint32_t microseconds) noexcept {
        paused_us += microseconds;
        pass(static_cast<std::int64_t>(microseconds) * 1000);
    }
    void pass(std::int64_t ns) noexcept { until(now_ns + ns); }
    void until(std::int64_t t_ns) noexcept {
        if (t_ns > now_ns) now_ns = t_ns;
        for (auto* chip : chips) {
            chip->advance(now_ns);
            if (chip->other_half() != nullptr) chip->other_half()->advance(now_ns);
        }
    }

  private:
    static constexpr std::int64_t byte_ns = 22500;  // nine clocks of 400 kHz

    sim::ChipModel* find(std::uint8_t address) const noexcept {
        for (auto* chip : chips)
            for (auto* half : {chip, chip->other_half()})
                if (half != nullptr && half->address() == address && half->answers()) return half;
        return nullptr;
    }
};

/// Waits for the chip's interrupt line in the same virtual time; can lose edges on purpose.
class ModelEdges {
  public:
    ModelEdges(ModelBus& bus, sim::ChipModel& chip) : bus_{&bus}, chip_{&chip} {}

    Result<std::int64_t> wait(std::int64_t deadline_ns) noexcept {
        while (chip_->edges.empty()) {
            if (bus_->now_ns >= deadline_ns) return Status::timeout;
            bus_->until(std::min(deadline_ns, std::max(chip_->next_ns(), bus_->now_ns + 1)));
            drop_lost();
        }
        const std::int64_t edge = chip_->edges.front();
        chip_->edges.pop_front();
        return edge + offset_ns;
    }
    std::uint64_t lose_every{0};  // every so many-th edge never arrives
    std::uint64_t seen{0};
    std::uint64_t lost{0};
    std::int64_t offset_ns{0};  // what the edges' clock is ahead of ours

  private:
    void drop_lost() {
        while (!chip_->edges.empty() && lose_every != 0 && ++seen % lose_every == 0) {
            chip_->edges.pop_front();
            ++lost;
        }
    }
    ModelBus* bus_;
    sim::ChipModel* chip_;
};

}  // namespace fairlead::port::test
