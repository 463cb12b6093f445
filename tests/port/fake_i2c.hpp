#pragma once
// Stands where the kernel's i2c-dev would: keeps the exact sequence of ioctls and their arguments,
// answers from a bank of registers, and fails on demand with any errno at any call.
#include <linux/i2c-dev.h>
#include <linux/i2c.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "port/linux/i2c.hpp"

namespace fairlead::port::test {

/// One call as it reached the kernel.
struct Call {
    unsigned long request{};
    unsigned long value{};  // of the plain ioctls
    int read_write{-1};     // of I2C_SMBUS, as are the next three
    int command{-1};
    int size{-1};
    std::vector<std::uint8_t> data{};  // the bytes that the kernel would look at
    struct Message {
        int address, flags;
        std::vector<std::uint8_t> bytes;  // what a write carries; as long as a read asks for
    };
    std::vector<Message> messages{};
};

class FakeI2c final : public I2cSystem {
  public:
    std::vector<Call> calls;
    std::vector<std::string> opened;
    std::vector<int> closed;
    std::array<std::uint8_t, 256> registers{};
    unsigned long funcs{I2C_FUNC_I2C | I2C_FUNC_SMBUS_EMUL | I2C_FUNC_SMBUS_PEC |
                        I2C_FUNC_SMBUS_BLOCK_DATA | I2C_FUNC_SMBUS_BLOCK_PROC_CALL |
                        I2C_FUNC_SMBUS_PROC_CALL};
    int next_fd{3};
    int open_error{0};
    int error{0};           // errno of the failing call
    int fail_after{-1};     // calls that still succeed before one fails; negative: none fails
    int messages_done{-1};  // what I2C_RDWR returns instead of the full count
    int block_length{-1};   // what the device claims as the length of a block

    int open(const char* path) noexcept override {
        opened.emplace_back(path);
        if (open_error == 0) return next_fd;
        errno = open_error;
        return -1;
    }
    int close(int fd) noexcept override {
        closed.push_back(fd);
        return 0;
    }
    int ioctl(int, unsigned long request, unsigned long argument) noexcept override {
        Call call;
        call.request = request;
        if (request == I2C_SMBUS)
            note(call, *reinterpret_cast<i2c_smbus_ioctl_data*>(argument));
        else if (request == I2C_RDWR)
            note(call, *reinterpret_cast<i2c_rdwr_ioctl_data*>(argument));
        else
            call.value = request == I2C_FUNCS ? 0 : argument;
        calls.push_back(call);
        if (fail_after == 0) {
            errno = error;
            return -1;
        }
        if (fail_after > 0) --fail_after;
        if (request == I2C_FUNCS) *reinterpret_cast<unsigned long*>(argument) = funcs;
        if (request == I2C_SMBUS) answer(*reinterpret_cast<i2c_smbus_ioctl_data*>(argument));
        if (request == I2C_RDWR) return answer(*reinterpret_cast<i2c_rdwr_ioctl_data*>(argument));
        return 0;
    }
    void fail_with(int why, int after = 0) {
        error = why;
        fail_after = after;
    }

  private:
    static void note(Call& call, const i2c_smbus_ioctl_data& d) {
        call.read_write = d.read_write;
        call.command = d.command;
        call.size = static_cast<int>(d.size);
        if (d.data == nullptr) return;
        const bool out = d.read_write == I2C_SMBUS_WRITE;
        if (d.size == I2C_SMBUS_BYTE_DATA && out) call.data = {d.data->byte};
        if ((d.size == I2C_SMBUS_WORD_DATA && out) || d.size == I2C_SMBUS_PROC_CALL)
            call.data = {static_cast<std::uint8_t>(d.data->word & 0xFF),
                         static_cast<std::uint8_t>(d.data->word >> 8)};
        const bool block = d.size == I2C_SMBUS_BLOCK_DATA || d.size == I2C_SMBUS_BLOCK_PROC_CALL ||
                           d.size == I2C_SMBUS_I2C_BLOCK_DATA;
        if (block && out) call.data.assign(d.data->block, d.data->block + 1 + d.data->block[0]);
        if (d.size == I2C_SMBUS_I2C_BLOCK_DATA && !out) call.data = {d.data->block[0]};
    }
    static void note(Call& call, const i2c_rdwr_ioctl_data& d) {
        for (std::uint32_t i = 0; i < d.nmsgs; ++i) {
            const i2c_msg& m = d.msgs[i];
            Call::Message seen{m.addr, m.flags, {}};
            if (m.flags & I2C_M_RD)
                seen.bytes.assign(m.len, 0);
            else
                seen.bytes.assign(m.buf, m.buf + m.len);
            call.messages.push_back(seen);
        }
    }
    void answer(const i2c_smbus_ioctl_data& d) {
        const bool read = d.read_write == I2C_SMBUS_READ;
        switch (d.size) {
            case I2C_SMBUS_BYTE:
                if (read) d.data->byte = registers[pointer_];
                pointer_ = d.command;
                break;
            case I2C_SMBUS_BYTE_DATA:
                if (read) d.data->byte = registers[d.command];
                if (!read) registers[d.command] = d.data->byte;
                break;
            case I2C_SMBUS_WORD_DATA:
                if (read)
                    d.data->word = static_cast<std::uint16_t>(
                        registers[d.command] | registers[(d.command + 1u) & 255u] << 8);
                break;
            case I2C_SMBUS_PROC_CALL:  // the device swaps the bytes
                d.data->word = static_cast<std::uint16_t>(d.data->word << 8 | d.data->word >> 8);
                break;
            case I2C_SMBUS_BLOCK_DATA:
                if (read) fill(*d.data, d.command, block_length < 0 ? 5 : block_length);
                break;
            case I2C_SMBUS_BLOCK_PROC_CALL:  // the device gives its bytes back in reverse
                for (int i = 1, j = d.data->block[0]; i < j; ++i, --j)
                    std::swap(d.data->block[i], d.data->block[j]);
                break;
            case I2C_SMBUS_I2C_BLOCK_DATA:
                if (read)
                    fill(*d.data, d.command, block_length < 0 ? d.data->block[0] : block_length);
                else
                    for (unsigned i = 0; i < d.data->block[0]; ++i)
                        registers[(d.command + i) & 255u] = d.data->block[1 + i];
                break;
            default: break;
        }
    }
    void fill(i2c_smbus_data& data, unsigned reg, int length) const {
        data.block[0] = static_cast<std::uint8_t>(length);
        for (unsigned i = 0; i < 32 && static_cast<int>(i) < length; ++i)
            data.block[1 + i] = registers[(reg + i) & 255u];
    }
    int answer(const i2c_rdwr_ioctl_data& d) {
        for (std::uint32_t i = 0; i < d.nmsgs; ++i) {
            const i2c_msg& m = d.msgs[i];
            for (unsigned k = 0; k < m.len; ++k) {
                if (m.flags & I2C_M_RD)
                    m.buf[k] = registers[pointer_++];
                else if (k == 0)
                    pointer_ = m.buf[0];
                else
                    registers[pointer_++] = m.buf[k];
            }
        }
        return messages_done < 0 ? static_cast<int>(d.nmsgs) : messages_done;
    }

    std::uint8_t pointer_{0};
};

}  // namespace fairlead::port::test
