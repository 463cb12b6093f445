// The SMBus half of I2c: every method is one I2C_SMBUS ioctl, after I2C_SLAVE where the address is
// new.
#include <algorithm>
#include <cerrno>

#include "port/linux/i2c.hpp"

namespace fairlead::port {
namespace {

unsigned long as_argument(const void* p) noexcept { return reinterpret_cast<unsigned long>(p); }

}  // namespace

Status I2c::smbus(int address, Force force, std::uint8_t read_write, std::uint8_t command,
                  std::uint32_t size, i2c_smbus_data* data) noexcept {
    if (const Status s = select(address, force); s != Status::ok) return s;
    i2c_smbus_ioctl_data request{};
    request.read_write = read_write;
    request.command = command;
    request.size = size;
    request.data = data;
    return call(I2C_SMBUS, as_argument(&request));
}

Status I2c::write_quick(int address, Force force) noexcept {
    return smbus(address, force, I2C_SMBUS_WRITE, 0, I2C_SMBUS_QUICK, nullptr);
}

Result<std::uint8_t> I2c::read_byte(int address, Force force) noexcept {
    i2c_smbus_data data{};
    const Status s = smbus(address, force, I2C_SMBUS_READ, 0, I2C_SMBUS_BYTE, &data);
    if (s != Status::ok) return s;
    return data.byte;
}

Status I2c::write_byte(int address, std::uint8_t value, Force force) noexcept {
    return smbus(address, force, I2C_SMBUS_WRITE, value, I2C_SMBUS_BYTE, nullptr);
}

Result<std::uint8_t> I2c::read_byte_data(int address, std::uint8_t reg, Force force) noexcept {
    i2c_smbus_data data{};
    const Status s = smbus(address, force, I2C_SMBUS_READ, reg, I2C_SMBUS_BYTE_DATA, &data);
    if (s != Status::ok) return s;
    return data.byte;
}

Status I2c::write_byte_data(int address, std::uint8_t reg, std::uint8_t value,
                            Force force) noexcept {
    i2c_smbus_data data{};
    data.byte = value;
    return smbus(address, force, I2C_SMBUS_WRITE, reg, I2C_SMBUS_BYTE_DATA, &data);
}

Result<std::uint16_t> I2c::read_word_data(int address, std::uint8_t reg, Force force) noexcept {
    i2c_smbus_data data{};
    const Status s = smbus(address, force, I2C_SMBUS_READ, reg, I2C_SMBUS_WORD_DATA, &data);
    if (s != Status::ok) return s;
    return data.word;
}

Status I2c::write_word_data(int address, std::uint8_t reg, std::uint16_t value,
                            Force force) noexcept {
    i2c_smbus_data data{};
    data.word = value;
    return smbus(address, force, I2C_SMBUS_WRITE, reg, I2C_SMBUS_WORD_DATA, &data);
}

Result<std::uint16_t> I2c::process_call(int address, std::uint8_t reg, std::uint16_t value,
                                        Force force) noexcept {
    i2c_smbus_data data{};
    data.word = value;
    const Status s = smbus(address, force, I2C_SMBUS_WRITE, reg, I2C_SMBUS_PROC_CALL, &data);
    if (s != Status::ok) return s;
    return data.word;
}

Status I2c::block_out(i2c_smbus_data& data, const std::uint8_t* bytes, std::size_t size) noexcept {
    if (size > I2C_SMBUS_BLOCK_MAX) return fail(EINVAL);
    data.block[0] = static_cast<std::uint8_t>(size);
    std::copy_n(bytes, size, data.block + 1);
    return Status::ok;
}

Result<Block> I2c::block_in(const i2c_smbus_data& data, std::size_t size_max) noexcept {
    if (data.block[0] > I2C_SMBUS_BLOCK_MAX) return fail(EPROTO);
    Block block;
    block.size = std::min<std::size_t>(data.block[0], size_max);
    std::copy_n(data.block + 1, block.size, block.bytes.begin());
    return block;
}

Result<Block> I2c::read_block_data(int address, std::uint8_t reg, Force force) noexcept {
    i2c_smbus_data data{};
    const Status s = smbus(address, force, I2C_SMBUS_READ, reg, I2C_SMBUS_BLOCK_DATA, &data);
    if (s != Status::ok) return s;
    return block_in(data, I2C_SMBUS_BLOCK_MAX);
}

Status I2c::write_block_data(int address, std::uint8_t reg, const std::uint8_t* bytes,
                             std::size_t size, Force force) noexcept {
    i2c_smbus_data data{};
    if (const Status s = block_out(data, bytes, size); s != Status::ok) return s;
    return smbus(address, force, I2C_SMBUS_WRITE, reg, I2C_SMBUS_BLOCK_DATA, &data);
}

Result<Block> I2c::block_process_call(int address, std::uint8_t reg, const std::uint8_t* bytes,
                                      std::size_t size, Force force) noexcept {
    i2c_smbus_data data{};
    if (const Status s = block_out(data, bytes, size); s != Status::ok) return s;
    const Status s = smbus(address, force, I2C_SMBUS_WRITE, reg, I2C_SMBUS_BLOCK_PROC_CALL, &data);
    if (s != Status::ok) return s;
    return block_in(data, I2C_SMBUS_BLOCK_MAX);
}

Result<Block> I2c::read_i2c_block_data(int address, std::uint8_t reg, std::size_t size,
                                       Force force) noexcept {
    if (size == 0 || size > I2C_SMBUS_BLOCK_MAX) return fail(EINVAL);
    i2c_smbus_data data{};
    data.block[0] = static_cast<std::uint8_t>(size);
    const Status s = smbus(address, force, I2C_SMBUS_READ, reg, I2C_SMBUS_I2C_BLOCK_DATA, &data);
    if (s != Status::ok) return s;
    return block_in(data, size);
}

Status I2c::write_i2c_block_data(int address, std::uint8_t reg, const std::uint8_t* bytes,
                                 std::size_t size, Force force) noexcept {
    i2c_smbus_data data{};
    if (const Status s = block_out(data, bytes, size); s != Status::ok) return s;
    return smbus(address, force, I2C_SMBUS_WRITE, reg, I2C_SMBUS_I2C_BLOCK_DATA, &data);
}

}  // namespace fairlead::port
