#pragma once
// An I2C or SMBus adapter through /dev/i2c-N: everything that python's smbus2 0.6 offers, plus
// timeout, retries, and register reads of any length. Also the Bus of the sensor drivers.
//
// Every call returns a Status or a Result; last_errno() keeps the kernel's own number of the last
// failure. Nothing retries unless set_retries() asks the kernel to. No heap.
// Source: linux/i2c-dev.h, linux/i2c.h, Documentation/i2c/{dev-interface,fault-codes}.rst.
#include <linux/i2c-dev.h>
#include <linux/i2c.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "port/sensors/bus.hpp"

namespace fairlead::port {

/// The three system calls underneath, so that tests can stand in for the kernel.
class I2cSystem {
  public:
    virtual ~I2cSystem() = default;
    virtual int open(const char* path) noexcept = 0;
    virtual int close(int fd) noexcept = 0;
    /// Like ioctl(2): negative and errno on failure.
    virtual int ioctl(int fd, unsigned long request, unsigned long argument) noexcept = 0;

    static I2cSystem& kernel() noexcept;
};

/// What an errno of an I2C transfer means; ENXIO and EREMOTEIO are both a missing acknowledge.
Status i2c_status(int error) noexcept;

/// Up to 32 bytes of an SMBus block.
struct Block {
    std::array<std::uint8_t, I2C_SMBUS_BLOCK_MAX> bytes{};
    std::size_t size{};
};

class I2c {
  public:
    static constexpr std::size_t message_max = I2C_RDWR_IOCTL_MAX_MSGS;  // 42 in one transaction
    static constexpr std::size_t message_size_max = 8192;  // bytes, i2c-dev's own limit
    /// Whether to talk to an address that a kernel driver owns; as_opened takes open()'s choice.
    enum class Force : std::uint8_t { as_opened, no, yes };

    I2c() noexcept : I2c{I2cSystem::kernel()} {}
    explicit I2c(I2cSystem& system) noexcept : system_{&system} {}
    I2c(I2c&& other) noexcept;
    I2c& operator=(I2c&& other) noexcept;
    I2c(const I2c&) = delete;
    I2c& operator=(const I2c&) = delete;
    ~I2c() { close(); }

    Status open(int bus, bool force = false) noexcept;  // /dev/i2c-<bus>
    Status open(const char* path, bool force = false) noexcept;
    void close() noexcept;
    bool is_open() const noexcept { return fd_ >= 0; }
    int last_errno() const noexcept { return errno_; }

    /// The adapter's I2C_FUNC_* bits, read once by open().
    unsigned long funcs() const noexcept { return funcs_; }
    bool has(unsigned long functions) const noexcept { return (funcs_ & functions) == functions; }

    /// Packet error codes on SMBus calls. not_supported where the adapter has none.
    Status enable_pec(bool on = true) noexcept;
    bool pec() const noexcept { return pec_; }
    /// Bounds each transfer; the kernel counts in 10 ms, rounded up here.
    Status set_timeout_ms(unsigned timeout_ms) noexcept;
    /// How often the kernel asks again when an address does not answer.
    Status set_retries(unsigned retries) noexcept;
    /// Always not_supported when asked for: i2c-dev documents 10-bit addressing as broken.
    Status enable_ten_bit(bool on = true) noexcept;

    // SMBus, one transaction each. Words travel low byte first.
    Status write_quick(int address, Force force = Force::as_opened) noexcept;
    Result<std::uint8_t> read_byte(int address, Force force = Force::as_opened) noexcept;
    Status write_byte(int address, std::uint8_t value, Force force = Force::as_opened) noexcept;
    Result<std::uint8_t> read_byte_data(int address, std::uint8_t reg,
                                        Force force = Force::as_opened) noexcept;
    Status write_byte_data(int address, std::uint8_t reg, std::uint8_t value,
                           Force force = Force::as_opened) noexcept;
    Result<std::uint16_t> read_word_data(int address, std::uint8_t reg,
                                         Force force = Force::as_opened) noexcept;
    Status write_word_data(int address, std::uint8_t reg, std::uint16_t value,
                           Force force = Force::as_opened) noexcept;
    Result<std::uint16_t> process_call(int address, std::uint8_t reg, std::uint16_t value,
                                       Force force = Force::as_opened) noexcept;
    Result<Block> read_block_data(int address, std::uint8_t reg,
                                  Force force = Force::as_opened) noexcept;
    Status write_block_data(int address, std::uint8_t reg, const std::uint8_t* data,
                            std::size_t size, Force force = Force::as_opened) noexcept;
    Result<Block> block_process_call(int address, std::uint8_t reg, const std::uint8_t* data,
                                     std::size_t size, Force force = Force::as_opened) noexcept;
    /// 1 to 32 bytes; the block holds what the adapter delivered, never more than asked for.
    Result<Block> read_i2c_block_data(int address, std::uint8_t reg, std::size_t size,
                                      Force force = Force::as_opened) noexcept;
    Status write_i2c_block_data(int address, std::uint8_t reg, const std::uint8_t* data,
                                std::size_t size, Force force = Force::as_opened) noexcept;

    /// Up to 42 messages, repeated starts between them, one stop. Flags beyond I2C_M_RD pass only
    /// where the adapter claims them. Does not touch the address that SMBus calls have set.
    Status i2c_rdwr(i2c_msg* messages, std::size_t count) noexcept;

    /// Reads consecutive registers: one I2C_RDWR, or blocks of 32 where the adapter has only those.
    Status read_registers(int address, std::uint8_t reg, std::uint8_t* data,
                          std::size_t size) noexcept;

    // The Bus of port/sensors.
    Status transfer(const Transfer* list, std::size_t count) noexcept;
    std::size_t read_max() const noexcept;
    void pause_us(std::uint32_t microseconds) noexcept;

  private:
    Status fail(int error) noexcept;
    Status call(unsigned long request, unsigned long argument) noexcept;
    Status select(int address, Force force) noexcept;
    Status smbus(int address, Force force, std::uint8_t read_write, std::uint8_t command,
                 std::uint32_t size, i2c_smbus_data* data) noexcept;
    Status block_out(i2c_smbus_data& data, const std::uint8_t* bytes, std::size_t size) noexcept;
    Result<Block> block_in(const i2c_smbus_data& data, std::size_t size_max) noexcept;
    Status transfer_smbus(const Transfer& t) noexcept;

    I2cSystem* system_;
    int fd_{-1};
    int errno_{0};
    unsigned long funcs_{0};
    bool pec_{false};
    bool force_{false};
    int address_{-1};  // what I2C_SLAVE was last told, with which force
    bool address_forced_{false};
};

/// The two ordinary messages. The buffers stay the caller's.
i2c_msg i2c_read(int address, std::uint8_t* data, std::size_t size) noexcept;
i2c_msg i2c_write(int address, const std::uint8_t* data, std::size_t size) noexcept;

}  // namespace fairlead::port
