// The whole table of smbus2 methods against a fake kernel: the exact ioctl sequence of each, every
// errno, and what smbus2's own tests leave out: lengths 0 and 33, force, address caching, 42
// messages, short transfers, descriptor 0.
#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <utility>

#include "tests/port/fake_i2c.hpp"

namespace fairlead::port {
namespace {

using test::Call;
using test::FakeI2c;
using Bytes = std::vector<std::uint8_t>;

class I2cTest : public ::testing::Test {
  protected:
    I2cTest() {
        std::iota(kernel.registers.begin(), kernel.registers.end(), std::uint8_t{0});
        EXPECT_EQ(bus.open(1), Status::ok);
        kernel.calls.clear();
    }
    /// The call's own ioctl is the last; before it stands one I2C_SLAVE with the address.
    const Call& smbus_call(int address, int read_write, int command, int size) {
        EXPECT_EQ(kernel.calls.size(), 2u);
        EXPECT_EQ(kernel.calls.front().request, static_cast<unsigned long>(I2C_SLAVE));
        EXPECT_EQ(kernel.calls.front().value, static_cast<unsigned long>(address));
        const Call& call = kernel.calls.back();
        EXPECT_EQ(call.request, static_cast<unsigned long>(I2C_SMBUS));
        EXPECT_EQ(call.read_write, read_write);
        EXPECT_EQ(call.command, command);
        EXPECT_EQ(call.size, size);
        return call;
    }
    Bytes reg_bytes(std::size_t from, std::size_t n) const {
        return {kernel.registers.begin() + static_cast<std::ptrdiff_t>(from),
                kernel.registers.begin() + static_cast<std::ptrdiff_t>(from + n)};
    }
    static Bytes bytes_of(const Block& b) {
        return {b.bytes.begin(), b.bytes.begin() + static_cast<std::ptrdiff_t>(b.size)};
    }

    FakeI2c kernel;
    I2c bus{kernel};
};

TEST_F(I2cTest, OpenNamesTheDeviceAndReadsTheFunctionsOnce) {
    EXPECT_EQ(kernel.opened, std::vector<std::string>{"/dev/i2c-1"});
    EXPECT_EQ(bus.funcs(), kernel.funcs);
    EXPECT_TRUE(bus.has(I2C_FUNC_I2C | I2C_FUNC_SMBUS_PEC));
    EXPECT_FALSE(bus.has(I2C_FUNC_10BIT_ADDR));
    EXPECT_TRUE(kernel.calls.empty());
    EXPECT_EQ(bus.open("/dev/i2c-by-name"), Status::ok);  // reopening closes first
    EXPECT_EQ(kernel.closed, std::vector<int>{3});
    ASSERT_EQ(kernel.calls.size(), 1u);
    EXPECT_EQ(kernel.calls[0].request, static_cast<unsigned long>(I2C_FUNCS));
    EXPECT_EQ(bus.open(-1), Status::bad_argument);
}

TEST_F(I2cTest, OpenReportsWhyItFailed) {
    const std::pair<int, Status> cases[] = {{ENOENT, Status::not_found},
                                            {EACCES, Status::no_permission},
                                            {ENODEV, Status::not_found},
                                            {EBUSY, Status::busy},
                                            {ENOMEM, Status::io_error}};
    for (const auto& [error, status] : cases) {
        kernel.open_error = error;
        EXPECT_EQ(bus.open(1), status);
        EXPECT_EQ(bus.last_errno(), error);
        EXPECT_FALSE(bus.is_open());
    }
}

TEST_F(I2cTest, OpenClosesAgainWhenTheFunctionsCannotBeRead) {
    kernel.closed.clear();
    kernel.fail_with(ENOTTY);
    I2c other{kernel};
    EXPECT_EQ(other.open(7), Status::not_supported);
    EXPECT_FALSE(other.is_open());
    EXPECT_EQ(kernel.closed, std::vector<int>{3});
}

TEST_F(I2cTest, DescriptorZeroIsADescriptor) {
    bus.close();
    kernel.closed.clear();
    kernel.next_fd = 0;
    EXPECT_EQ(bus.open(1), Status::ok);
    EXPECT_TRUE(bus.is_open());
    bus.close();
    EXPECT_EQ(kernel.closed, std::vector<int>{0});
    bus.close();
    EXPECT_EQ(kernel.closed.size(), 1u);  // closing twice is closing once
}

TEST_F(I2cTest, OwnershipMoves) {
    {
        I2c other{std::move(bus)};
        EXPECT_TRUE(other.is_open());
        EXPECT_FALSE(bus.is_open());
        I2c third{kernel};
        third = std::move(other);
        EXPECT_TRUE(third.read_byte_data(0x10, 4));
        EXPECT_TRUE(kernel.closed.empty());
    }
    EXPECT_EQ(kernel.closed, std::vector<int>{3});
}

TEST_F(I2cTest, EveryCallOnAClosedBusSaysClosed) {
    bus.close();
    std::uint8_t byte = 0;
    i2c_msg message = i2c_read(1, &byte, 1);
    const Transfer transfer{1, &byte, 1, &byte, 1};
    EXPECT_EQ(bus.write_quick(1), Status::closed);
    EXPECT_EQ(bus.read_byte(1).status(), Status::closed);
    EXPECT_EQ(bus.i2c_rdwr(&message, 1), Status::closed);
    EXPECT_EQ(bus.transfer(&transfer, 1), Status::closed);
    EXPECT_EQ(bus.enable_pec(), Status::closed);
    EXPECT_EQ(bus.set_retries(1), Status::closed);
    EXPECT_EQ(bus.last_errno(), EBADF);
    EXPECT_TRUE(kernel.calls.empty());
}

TEST_F(I2cTest, WriteQuick) {
    EXPECT_EQ(bus.write_quick(0x42), Status::ok);
    EXPECT_TRUE(smbus_call(0x42, I2C_SMBUS_WRITE, 0, I2C_SMBUS_QUICK).data.empty());
}

TEST_F(I2cTest, ReadByteSendsNoRegister) {
    const auto byte = bus.read_byte(0x42);
    ASSERT_TRUE(byte);
    EXPECT_EQ(*byte, 0);
    smbus_call(0x42, I2C_SMBUS_READ, 0, I2C_SMBUS_BYTE);
}

TEST_F(I2cTest, WriteByteTravelsAsTheCommand) {
    EXPECT_EQ(bus.write_byte(0x42, 0xA5), Status::ok);
    EXPECT_TRUE(smbus_call(0x42, I2C_SMBUS_WRITE, 0xA5, I2C_SMBUS_BYTE).data.empty());
}

TEST_F(I2cTest, ReadByteData) {
    const auto byte = bus.read_byte_data(0x42, 0x75);
    ASSERT_TRUE(byte);
    EXPECT_EQ(*byte, 0x75);
    smbus_call(0x42, I2C_SMBUS_READ, 0x75, I2C_SMBUS_BYTE_DATA);
}

TEST_F(I2cTest, WriteByteData) {
    EXPECT_EQ(bus.write_byte_data(0x42, 0x10, 0xEE), Status::ok);
    EXPECT_EQ(smbus_call(0x42, I2C_SMBUS_WRITE, 0x10, I2C_SMBUS_BYTE_DATA).data, Bytes{0xEE});
    EXPECT_EQ(kernel.registers[0x10], 0xEE);
}

TEST_F(I2cTest, ReadWordDataIsLowByteFirst) {
    const auto word = bus.read_word_data(0x42, 0x20);
    ASSERT_TRUE(word);
    EXPECT_EQ(*word, 0x2120);
    smbus_call(0x42, I2C_SMBUS_READ, 0x20, I2C_SMBUS_WORD_DATA);
}

TEST_F(I2cTest, WriteWordDataIsLowByteFirst) {
    EXPECT_EQ(bus.write_word_data(0x42, 0x20, 0xBEEF), Status::ok);
    EXPECT_EQ(smbus_call(0x42, I2C_SMBUS_WRITE, 0x20, I2C_SMBUS_WORD_DATA).data,
              (Bytes{0xEF, 0xBE}));
}

TEST_F(I2cTest, ProcessCall) {
    const auto word = bus.process_call(0x42, 0x33, 0x1234);
    ASSERT_TRUE(word);
    EXPECT_EQ(*word, 0x3412);
    EXPECT_EQ(smbus_call(0x42, I2C_SMBUS_WRITE, 0x33, I2C_SMBUS_PROC_CALL).data,
              (Bytes{0x34, 0x12}));
}

TEST_F(I2cTest, ReadBlockDataTakesTheLengthFromTheDevice) {
    const auto block = bus.read_block_data(0x42, 0x40);
    ASSERT_TRUE(block);
    EXPECT_EQ(bytes_of(*block), reg_bytes(0x40, 5));
    smbus_call(0x42, I2C_SMBUS_READ, 0x40, I2C_SMBUS_BLOCK_DATA);
    kernel.block_length = 32;
    EXPECT_EQ(bus.read_block_data(0x42, 0x40)->size, 32u);
    kernel.block_length = 33;
    EXPECT_EQ(bus.read_block_data(0x42, 0x40).status(), Status::protocol_error);
    EXPECT_EQ(bus.last_errno(), EPROTO);
}

TEST_F(I2cTest, WriteBlockData) {
    const Bytes bytes{7, 8, 9};
    EXPECT_EQ(bus.write_block_data(0x42, 0x50, bytes.data(), bytes.size()), Status::ok);
    EXPECT_EQ(smbus_call(0x42, I2C_SMBUS_WRITE, 0x50, I2C_SMBUS_BLOCK_DATA).data,
              (Bytes{3, 7, 8, 9}));
}

TEST_F(I2cTest, BlockProcessCall) {
    const Bytes bytes{1, 2, 3, 4};
    const auto block = bus.block_process_call(0x42, 0x60, bytes.data(), bytes.size());
    ASSERT_TRUE(block);
    EXPECT_EQ(bytes_of(*block), (Bytes{4, 3, 2, 1}));
    EXPECT_EQ(smbus_call(0x42, I2C_SMBUS_WRITE, 0x60, I2C_SMBUS_BLOCK_PROC_CALL).data,
              (Bytes{4, 1, 2, 3, 4}));
}

TEST_F(I2cTest, ReadI2cBlockData) {
    const auto block = bus.read_i2c_block_data(0x42, 0x3B, 14);
    ASSERT_TRUE(block);
    EXPECT_EQ(bytes_of(*block), reg_bytes(0x3B, 14));
    EXPECT_EQ(smbus_call(0x42, I2C_SMBUS_READ, 0x3B, I2C_SMBUS_I2C_BLOCK_DATA).data, Bytes{14});
}

TEST_F(I2cTest, ReadI2cBlockDataReportsWhatTheAdapterDelivered) {
    kernel.block_length = 6;
    EXPECT_EQ(bytes_of(*bus.read_i2c_block_data(0x42, 0x3B, 14)), reg_bytes(0x3B, 6));
    kernel.block_length = 20;  // never more than asked for
    EXPECT_EQ(bus.read_i2c_block_data(0x42, 0x3B, 14)->size, 14u);
}

TEST_F(I2cTest, WriteI2cBlockData) {
    const Bytes bytes{0xA0, 0xA1};
    EXPECT_EQ(bus.write_i2c_block_data(0x42, 0x3B, bytes.data(), bytes.size()), Status::ok);
    EXPECT_EQ(smbus_call(0x42, I2C_SMBUS_WRITE, 0x3B, I2C_SMBUS_I2C_BLOCK_DATA).data,
              (Bytes{2, 0xA0, 0xA1}));
    EXPECT_EQ(reg_bytes(0x3B, 2), bytes);
}

TEST_F(I2cTest, BlockLengthsAreCheckedBeforeTheKernelIsAsked) {
    const Bytes bytes(33, 0);
    EXPECT_EQ(bus.write_block_data(1, 0, bytes.data(), 33), Status::bad_argument);
    EXPECT_EQ(bus.block_process_call(1, 0, bytes.data(), 33).status(), Status::bad_argument);
    EXPECT_EQ(bus.write_i2c_block_data(1, 0, bytes.data(), 33), Status::bad_argument);
    EXPECT_EQ(bus.read_i2c_block_data(1, 0, 33).status(), Status::bad_argument);
    EXPECT_EQ(bus.read_i2c_block_data(1, 0, 0).status(), Status::bad_argument);
    EXPECT_EQ(bus.last_errno(), EINVAL);
    EXPECT_TRUE(kernel.calls.empty());
    EXPECT_EQ(bus.write_i2c_block_data(1, 0, bytes.data(), 32), Status::ok);
    EXPECT_EQ(bus.write_block_data(1, 0, bytes.data(), 0), Status::ok);  // the kernel's to judge
}

TEST_F(I2cTest, TheAddressIsSetOnceAndAgainWhenItOrTheForceChanges) {
    const auto set_calls = [&] {
        std::size_t n = 0;
        for (const Call& c : kernel.calls) n += c.request != I2C_SMBUS ? 1 : 0;
        return n;
    };
    EXPECT_TRUE(bus.read_byte(0x10));
    EXPECT_TRUE(bus.read_byte(0x10));
    EXPECT_EQ(set_calls(), 1u);
    EXPECT_TRUE(bus.read_byte(0x11));
    EXPECT_EQ(set_calls(), 2u);
    EXPECT_TRUE(bus.read_byte(0x11, I2c::Force::yes));
    EXPECT_EQ(set_calls(), 3u);
    EXPECT_EQ(kernel.calls[kernel.calls.size() - 2].request,
              static_cast<unsigned long>(I2C_SLAVE_FORCE));
    EXPECT_TRUE(bus.read_byte(0x11, I2c::Force::no));
    EXPECT_EQ(set_calls(), 4u);
    EXPECT_TRUE(bus.read_byte(0x11, I2c::Force::as_opened));
    EXPECT_EQ(set_calls(), 4u);
}

TEST_F(I2cTest, ForceAtOpenHoldsForEveryCall) {
    EXPECT_EQ(bus.open(1, true), Status::ok);
    kernel.calls.clear();
    EXPECT_TRUE(bus.read_byte(0x10));
    EXPECT_EQ(kernel.calls[0].request, static_cast<unsigned long>(I2C_SLAVE_FORCE));
    EXPECT_TRUE(bus.read_byte(0x10, I2c::Force::no));
    EXPECT_EQ(kernel.calls[2].request, static_cast<unsigned long>(I2C_SLAVE));
}

TEST_F(I2cTest, AnAddressThatADriverOwnsIsNotABusyBus) {
    kernel.fail_with(EBUSY);
    EXPECT_EQ(bus.read_byte(0x10).status(), Status::address_in_use);
    EXPECT_EQ(bus.last_errno(), EBUSY);
    kernel.fail_after = -1;
    EXPECT_TRUE(bus.read_byte(0x10));  // the failure was not cached as success
    EXPECT_EQ(kernel.calls[1].request, static_cast<unsigned long>(I2C_SLAVE));
    kernel.fail_with(EBUSY);
    EXPECT_EQ(bus.read_byte(0x10).status(), Status::busy);
}

TEST_F(I2cTest, AddressesBeyondSevenBitsAreRefused) {
    for (const int address : {-1, 0x80, 0x3FF}) {
        EXPECT_EQ(bus.read_byte(address).status(), Status::bad_argument);
        EXPECT_EQ(bus.last_errno(), EINVAL);
    }
    EXPECT_EQ(bus.enable_ten_bit(), Status::not_supported);
    EXPECT_EQ(bus.enable_ten_bit(false), Status::ok);
    EXPECT_TRUE(kernel.calls.empty());
}

TEST_F(I2cTest, PecNeedsAnAdapterThatHasIt) {
    EXPECT_EQ(bus.enable_pec(), Status::ok);
    EXPECT_TRUE(bus.pec());
    EXPECT_EQ(kernel.calls.back().request, static_cast<unsigned long>(I2C_PEC));
    EXPECT_EQ(kernel.calls.back().value, 1u);
    EXPECT_EQ(bus.enable_pec(false), Status::ok);
    EXPECT_EQ(kernel.calls.back().value, 0u);
    EXPECT_EQ(bus.enable_pec(), Status::ok);
    bus.close();
    EXPECT_FALSE(bus.pec());
    kernel.funcs &= ~static_cast<unsigned long>(I2C_FUNC_SMBUS_PEC);
    EXPECT_EQ(bus.open(1), Status::ok);
    kernel.calls.clear();
    EXPECT_EQ(bus.enable_pec(), Status::not_supported);
    EXPECT_FALSE(bus.pec());
    EXPECT_TRUE(kernel.calls.empty());
}

TEST_F(I2cTest, TimeoutAndRetries) {
    EXPECT_EQ(bus.set_timeout_ms(25), Status::ok);
    EXPECT_EQ(kernel.calls.back().request, static_cast<unsigned long>(I2C_TIMEOUT));
    EXPECT_EQ(kernel.calls.back().value, 3u);  // tens of milliseconds, rounded up
    EXPECT_EQ(bus.set_retries(2), Status::ok);
    EXPECT_EQ(kernel.calls.back().request, static_cast<unsigned long>(I2C_RETRIES));
    EXPECT_EQ(kernel.calls.back().value, 2u);
}

TEST_F(I2cTest, RdwrPassesMessagesAndLeavesTheAddressAlone) {
    const Bytes out{0x3B};
    Bytes in(6);
    i2c_msg messages[2] = {i2c_write(0x42, out.data(), 1), i2c_read(0x43, in.data(), in.size())};
    EXPECT_EQ(bus.i2c_rdwr(messages, 2), Status::ok);
    ASSERT_EQ(kernel.calls.size(), 1u);
    EXPECT_EQ(kernel.calls[0].request, static_cast<unsigned long>(I2C_RDWR));
    ASSERT_EQ(kernel.calls[0].messages.size(), 2u);
    EXPECT_EQ(kernel.calls[0].messages[0].address, 0x42);
    EXPECT_EQ(kernel.calls[0].messages[0].flags, 0);
    EXPECT_EQ(kernel.calls[0].messages[0].bytes, out);
    EXPECT_EQ(kernel.calls[0].messages[1].address, 0x43);
    EXPECT_EQ(kernel.calls[0].messages[1].flags, I2C_M_RD);
    EXPECT_EQ(in, reg_bytes(0x3B, 6));
}

TEST_F(I2cTest, RdwrTakesFortyTwoMessages) {
    std::uint8_t byte = 0;
    std::vector<i2c_msg> messages(43, i2c_read(0x42, &byte, 1));
    EXPECT_EQ(bus.i2c_rdwr(messages.data(), 42), Status::ok);
    EXPECT_EQ(kernel.calls.back().messages.size(), 42u);
    EXPECT_EQ(bus.i2c_rdwr(messages.data(), 43), Status::bad_argument);
    EXPECT_EQ(bus.i2c_rdwr(messages.data(), 0), Status::bad_argument);
    EXPECT_EQ(kernel.calls.size(), 1u);
}

TEST_F(I2cTest, RdwrChecksSizesAddressesAndFlags) {
    Bytes buffer(9000);
    i2c_msg message = i2c_read(0x42, buffer.data(), 8192);
    EXPECT_EQ(bus.i2c_rdwr(&message, 1), Status::ok);
    message.len = 8193;
    EXPECT_EQ(bus.i2c_rdwr(&message, 1), Status::bad_argument);
    message = i2c_read(0x80, buffer.data(), 1);
    EXPECT_EQ(bus.i2c_rdwr(&message, 1), Status::bad_argument);
    message = i2c_read(0x42, buffer.data(), 1);
    message.flags = I2C_M_RD | I2C_M_TEN;
    EXPECT_EQ(bus.i2c_rdwr(&message, 1), Status::not_supported);
    for (const int f :
         {I2C_M_STOP, I2C_M_IGNORE_NAK, I2C_M_NO_RD_ACK, I2C_M_REV_DIR_ADDR, I2C_M_NOSTART}) {
        message.flags = static_cast<__u16>(f);
        EXPECT_EQ(bus.i2c_rdwr(&message, 1), Status::not_supported) << f;
    }
    kernel.funcs |= I2C_FUNC_PROTOCOL_MANGLING | I2C_FUNC_10BIT_ADDR | I2C_FUNC_NOSTART;
    EXPECT_EQ(bus.open(1), Status::ok);
    message.flags = I2C_M_RD | I2C_M_TEN | I2C_M_IGNORE_NAK;
    message.addr = 0x3FF;
    EXPECT_EQ(bus.i2c_rdwr(&message, 1), Status::ok);
    EXPECT_EQ(kernel.calls.back().messages[0].flags, I2C_M_RD | I2C_M_TEN | I2C_M_IGNORE_NAK);
}

TEST_F(I2cTest, AShortTransactionIsAFailure) {
    std::uint8_t bytes[2] = {};
    i2c_msg messages[2] = {i2c_read(0x42, bytes, 1), i2c_read(0x42, bytes + 1, 1)};
    kernel.messages_done = 1;
    EXPECT_EQ(bus.i2c_rdwr(messages, 2), Status::io_error);
}

TEST_F(I2cTest, RegistersOfAnyLengthInOneTransaction) {
    Bytes in(200);
    EXPECT_EQ(bus.read_registers(0x42, 0x10, in.data(), in.size()), Status::ok);
    EXPECT_EQ(in, reg_bytes(0x10, 200));
    EXPECT_EQ(kernel.calls.size(), 1u);
}

TEST_F(I2cTest, RegistersInBlocksOf32WhereTheAdapterHasNothingElse) {
    kernel.funcs = I2C_FUNC_SMBUS_EMUL;
    EXPECT_EQ(bus.open(1), Status::ok);
    kernel.calls.clear();
    Bytes in(70);
    EXPECT_EQ(bus.read_registers(0x42, 0x10, in.data(), in.size()), Status::ok);
    EXPECT_EQ(in, reg_bytes(0x10, 70));
    ASSERT_EQ(kernel.calls.size(), 4u);  // the address, then 32 + 32 + 6
    EXPECT_EQ(kernel.calls[1].command, 0x10);
    EXPECT_EQ(kernel.calls[2].command, 0x30);
    EXPECT_EQ(kernel.calls[3].command, 0x50);
    EXPECT_EQ(kernel.calls[3].data, Bytes{6});
    kernel.block_length = 3;
    EXPECT_EQ(bus.read_registers(0x42, 0x10, in.data(), in.size()), Status::protocol_error);
    EXPECT_EQ(bus.read_registers(0x42, 0xF0, in.data(), 17), Status::bad_argument);
    i2c_msg message = i2c_read(0x42, in.data(), 1);
    EXPECT_EQ(bus.i2c_rdwr(&message, 1), Status::not_supported);
}

TEST_F(I2cTest, ATransferListIsOneTransaction) {
    const Bytes pointer{0x20}, setting{0x30, 0x99};
    Bytes in(4);
    const Transfer list[2] = {{0x42, setting.data(), 2, nullptr, 0},
                              {0x42, pointer.data(), 1, in.data(), 4}};
    EXPECT_EQ(bus.transfer(list, 2), Status::ok);
    ASSERT_EQ(kernel.calls.size(), 1u);
    EXPECT_EQ(kernel.calls[0].messages.size(), 3u);
    EXPECT_EQ(in, reg_bytes(0x20, 4));
    EXPECT_EQ(kernel.registers[0x30], 0x99);
    EXPECT_EQ(bus.transfer(list, 0), Status::bad_argument);
}

TEST_F(I2cTest, TransfersInSmbusWordsWhereTheAdapterHasNothingElse) {
    kernel.funcs = I2C_FUNC_SMBUS_EMUL;
    EXPECT_EQ(bus.open(1), Status::ok);
    EXPECT_EQ(bus.read_max(), 32u);
    const Bytes out{0x20, 1, 2, 3};
    Bytes in(40);
    const auto size_of = [&](std::uint16_t out_size, std::uint16_t in_size) {
        const Transfer t{0x42, out.data(), out_size, in.data(), in_size};
        const Status s = bus.transfer(&t, 1);
        return s == Status::ok ? kernel.calls.back().size : -1;
    };
    EXPECT_EQ(size_of(1, 0), I2C_SMBUS_BYTE);
    EXPECT_EQ(size_of(2, 0), I2C_SMBUS_BYTE_DATA);
    EXPECT_EQ(size_of(4, 0), I2C_SMBUS_I2C_BLOCK_DATA);
    EXPECT_EQ(size_of(0, 1), I2C_SMBUS_BYTE);
    EXPECT_EQ(size_of(1, 1), I2C_SMBUS_BYTE_DATA);
    EXPECT_EQ(size_of(1, 40), I2C_SMBUS_I2C_BLOCK_DATA);
    EXPECT_EQ(size_of(0, 2), -1);
    EXPECT_EQ(size_of(2, 2), -1);
    EXPECT_EQ(size_of(0, 0), -1);
    EXPECT_EQ(bus.last_errno(), EOPNOTSUPP);
}

/// Every method that asks the kernel, as one list.
std::vector<std::pair<const char*, std::function<Status(I2c&)>>> methods() {
    static Bytes b(8, 1);
    static i2c_msg message;
    message = i2c_read(0x42, b.data(), 1);
    static const Transfer transfer{0x42, b.data(), 1, b.data(), 2};
    return {
        {"write_quick", [](I2c& i) { return i.write_quick(0x42); }},
        {"read_byte", [](I2c& i) { return i.read_byte(0x42).status(); }},
        {"write_byte", [](I2c& i) { return i.write_byte(0x42, 1); }},
        {"read_byte_data", [](I2c& i) { return i.read_byte_data(0x42, 1).status(); }},
        {"write_byte_data", [](I2c& i) { return i.write_byte_data(0x42, 1, 2); }},
        {"read_word_data", [](I2c& i) { return i.read_word_data(0x42, 1).status(); }},
        {"write_word_data", [](I2c& i) { return i.write_word_data(0x42, 1, 2); }},
        {"process_call", [](I2c& i) { return i.process_call(0x42, 1, 2).status(); }},
        {"read_block_data", [](I2c& i) { return i.read_block_data(0x42, 1).status(); }},
        {"write_block_data", [](I2c& i) { return i.write_block_data(0x42, 1, b.data(), 3); }},
        {"block_process_call",
         [](I2c& i) { return i.block_process_call(0x42, 1, b.data(), 3).status(); }},
        {"read_i2c_block_data", [](I2c& i) { return i.read_i2c_block_data(0x42, 1, 4).status(); }},
        {"write_i2c_block_data",
         [](I2c& i) { return i.write_i2c_block_data(0x42, 1, b.data(), 3); }},
        {"i2c_rdwr", [](I2c& i) { return i.i2c_rdwr(&message, 1); }},
        {"read_registers", [](I2c& i) { return i.read_registers(0x42, 1, b.data(), 4); }},
        {"transfer", [](I2c& i) { return i.transfer(&transfer, 1); }},
        {"enable_pec", [](I2c& i) { return i.enable_pec(); }},
        {"set_timeout_ms", [](I2c& i) { return i.set_timeout_ms(10); }},
        {"set_retries", [](I2c& i) { return i.set_retries(1); }},
    };
}

TEST_F(I2cTest, EveryErrnoOfEveryMethodIsKeptAndTranslated) {
    for (const auto& [name, method] : methods()) {
        for (int error = 1; error < 134; ++error) {
            EXPECT_EQ(bus.open(1), Status::ok);
            EXPECT_TRUE(bus.read_byte(0x42));  // the address is set: the method's own call fails
            kernel.fail_with(error);
            EXPECT_EQ(method(bus), i2c_status(error)) << name << " errno " << error;
            EXPECT_EQ(bus.last_errno(), error) << name;
            kernel.fail_after = -1;
            EXPECT_EQ(method(bus), Status::ok) << name << " after errno " << error;
        }
    }
}

TEST(I2cStatus, FollowsTheKernelsFaultCodes) {
    EXPECT_EQ(i2c_status(0), Status::ok);
    EXPECT_EQ(i2c_status(ENXIO), Status::no_acknowledge);
    EXPECT_EQ(i2c_status(EREMOTEIO), Status::no_acknowledge);
    EXPECT_EQ(i2c_status(EAGAIN), Status::arbitration_lost);
    EXPECT_EQ(i2c_status(EBADMSG), Status::checksum);
    EXPECT_EQ(i2c_status(EBUSY), Status::busy);
    EXPECT_EQ(i2c_status(EOPNOTSUPP), Status::not_supported);
    EXPECT_EQ(i2c_status(ETIMEDOUT), Status::timeout);
    EXPECT_EQ(i2c_status(EPROTO), Status::protocol_error);
    EXPECT_EQ(i2c_status(EINVAL), Status::bad_argument);
    EXPECT_EQ(i2c_status(EIO), Status::io_error);
    EXPECT_EQ(i2c_status(EBADF), Status::closed);
    EXPECT_EQ(i2c_status(ENODEV), Status::not_found);
    EXPECT_EQ(i2c_status(ESHUTDOWN), Status::disconnected);
    EXPECT_EQ(i2c_status(ENOMEM), Status::io_error);
}

}  // namespace
}  // namespace fairlead::port
