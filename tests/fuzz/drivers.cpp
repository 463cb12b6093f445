// Every driver and the sampling loop on a bus that lies: registers that remember what was written,
// and reads, edges and times that may be anything. Held: each turn ends within a bounded number of
// transfers, batches fit, and what passes the intake is finite, flagged and in order.
#include <cmath>

#include "port/linux/imu_loop.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::port;

/// Registers of all addresses in one file; the fuzzer decides when an answer is another one.
class LyingBus {
  public:
    explicit LyingBus(fuzz::Input& in) : in_{&in} {}
    std::int64_t now_ns{1'000'000'000};
    int transfers{0};

    void set(std::uint8_t reg, std::uint8_t value) { registers_[reg] = value; }
    Status transfer(const Transfer* list, std::size_t count) noexcept {
        ++transfers;
        const std::uint8_t mood = in_->empty() ? std::uint8_t{0} : in_->byte();
        now_ns += 50'000 + 1'000 * mood;
        if (mood >= 248) return mood % 2 == 0 ? Status::no_acknowledge : Status::timeout;
        for (std::size_t i = 0; i < count; ++i) {
            const Transfer& t = list[i];
            if (t.out_size > 0) at_ = t.out[0];
            for (std::size_t k = 1; k < t.out_size; ++k)
                registers_[static_cast<std::uint8_t>(at_ + k - 1)] = t.out[k];
            for (std::size_t k = 0; k < t.in_size; ++k) {
                const auto reg = static_cast<std::uint8_t>(at_ + k);
                t.in[k] = mood >= 160 && !in_->empty() ? in_->byte() : registers_[reg];
            }
        }
        return Status::ok;
    }
    std::size_t read_max() const noexcept { return 512; }
    void pause_us(std::uint32_t us) noexcept { now_ns += std::int64_t{us} * 1000; }

  private:
    fuzz::Input* in_;
    std::array<std::uint8_t, 256> registers_{};
    std::uint8_t at_{0};
};

struct LyingEdges {
    LyingBus* bus;
    fuzz::Input* in;
    Result<std::int64_t> wait(std::int64_t deadline_ns) noexcept {
        const std::uint8_t k = in->empty() ? std::uint8_t{200} : in->byte();
        if (k >= 200) {
            bus->now_ns = deadline_ns > bus->now_ns ? deadline_ns : bus->now_ns + 1;
            return Status::timeout;
        }
        bus->now_ns += k * 100'000LL;
        return k >= 190 ? in->time_after(bus->now_ns, 5'000'000) : bus->now_ns;
    }
};

struct Clock {
    LyingBus* bus;
    std::int64_t now() const noexcept { return bus->now_ns; }
};

void check(const Batch& batch, std::int64_t& last_ns, bool& any) {
    FUZZ_EXPECT(batch.count <= Batch::capacity);
    for (std::size_t i = 0; i < batch.count; ++i) {
        const Sample& s = batch.samples[i];
        if ((s.flags & flag::gyro_valid) != 0) FUZZ_EXPECT(is_finite(s.gyro_rad_s));
        if ((s.flags & flag::accel_valid) != 0) FUZZ_EXPECT(is_finite(s.accel_m_s2));
        if ((s.flags & flag::mag_valid) != 0) FUZZ_EXPECT(is_finite(s.mag_uT));
        if ((s.flags & flag::temperature_valid) != 0) FUZZ_EXPECT(std::isfinite(s.temperature_c));
        if (any && (s.flags & flag::new_run) == 0) FUZZ_EXPECT(s.t_ns > last_ns);
        last_ns = s.t_ns;
        any = true;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in{data, size};
    ImuSetup setup;
    const ChipInfo& chip = ImuChips::infos[in.byte() % ImuChips::infos.size()];
    setup.sensor = chip.name;
    const std::size_t mag = in.byte() % (MagChips::infos.size() + 1);
    if (mag < MagChips::infos.size()) setup.mag = MagChips::infos[mag].name;
    setup.watermark = in.byte() % 33u;
    setup.accept_unknown = in.flag();
    setup.blob = std::string(8192, 'b');
    LyingBus bus{in};
    LyingEdges edges{&bus, &in};
    bus.set(chip.id_reg, chip.ids[0]);
    const auto loop = make_imu_loop(setup, bus, edges, Clock{&bus});
    FUZZ_EXPECT(loop != nullptr);
    static_cast<void>(loop->probe());
    static_cast<void>(loop->start());
    FUZZ_EXPECT(bus.transfers < 20'000);
    Batch batch;
    std::int64_t last_ns = 0;
    bool any = false;
    for (int turn = 0; turn < 200 && !in.empty(); ++turn) {
        const int before = bus.transfers;
        static_cast<void>(loop->step(batch));
        FUZZ_EXPECT(bus.transfers - before < 20'000);
        check(batch, last_ns, any);
    }
    return 0;
}
