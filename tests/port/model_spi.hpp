#pragma once
// A chip model behind an SPI chip select: the Wire of port/sensors/spi.hpp in virtual time. It
// reads the bits of the address as the chip does, and holds the driver to them: a chip with dummy
// bytes that are not sent, or a burst without the increment bit, gives other data.
#include <cstdint>

#include "tests/port/model_bus.hpp"

namespace fairlead::port::test {

class ModelSpi {
  public:
    ModelSpi(ModelBus& world, sim::ChipModel& chip, const SpiStyle& style)
        : world_{&world}, chip_{&chip}, style_{style} {}

    bool needs_wake{false};  // deaf until the first rising edge of the select (Bosch parts)

    Status exchange(const std::uint8_t* out, std::size_t out_size, std::uint8_t* in,
                    std::size_t in_size) noexcept {
        const int index = world_->transfers++;
        if (world_->stuck) {
            world_->pass(10000000);
            return Status::timeout;
        }
        if (index == world_->fail_at || world_->fail_always) return world_->failure;
        const bool deaf = needs_wake && !awake_;
        awake_ = true;
        world_->pass(static_cast<std::int64_t>(800 * (out_size + in_size)));  // 10 MHz
        if (deaf || !chip_->answers()) {  // nobody drives the line: it floats high
            for (std::size_t i = 0; i < in_size; ++i) in[i] = 0xFF;
            return Status::ok;
        }
        const bool read = (out[0] & 0x80) != 0;
        if (read != (in_size > 0)) return Status::bad_argument;
        const bool steps = style_.increment == 0 || (out[0] & style_.increment) != 0;
        const auto address = static_cast<std::uint8_t>(out[0] & 0x7F & ~style_.increment);
        chip_->begin_write();
        // the model's own front end speaks I2C: there the increment is the top bit of the register
        chip_->write(style_.increment != 0 && steps ? address | 0x80 : address);
        if (!read) {
            for (std::size_t i = 1; i < out_size; ++i) chip_->write(out[i]);
            if (out_size > 1 && address == 0x7E && out[1] == 0xB6) awake_ = false;
            return Status::ok;
        }
        // what comes where the driver expects dummy bytes is none of its business
        const std::size_t sent = out_size - 1;
        for (std::size_t i = 0; i < in_size; ++i) {
            if (sent + i < style_.dummy)
                in[i] = 0xA5;
            else
                in[i] = chip_->read();
        }
        return Status::ok;
    }
    std::size_t read_max() const noexcept { return world_->longest_read; }
    void pause_us(std::uint32_t microseconds) noexcept { world_->pause_us(microseconds); }

  private:
    ModelBus* world_;
    sim::ChipModel* chip_;
    SpiStyle style_;
    bool awake_{false};
};

}  // namespace fairlead::port::test
