// Every SMBus call against the kernel's own i2c-stub, one line of answer each; stub.py makes the
// same calls with smbus2 on another address of the same adapter, and the lines must be equal.
// usage: stub /dev/i2c-N ADDRESS
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "port/linux/i2c.hpp"

using namespace fairlead;
using namespace fairlead::port;

namespace {

I2c bus;

void say(const char* call, Status s) {
    if (s == Status::ok)
        std::printf("%s -> ok\n", call);
    else if (s == Status::bad_argument)
        std::printf("%s -> refused\n", call);
    else
        std::printf("%s -> errno %d\n", call, bus.last_errno());
}
template <class T>
void say(const char* call, const Result<T>& r) {
    if (r)
        std::printf("%s -> %d\n", call, static_cast<int>(*r));
    else
        say(call, r.status());
}
void say(const char* call, const Result<Block>& r) {
    if (!r) return say(call, r.status());
    std::printf("%s ->", call);
    for (std::size_t i = 0; i < r->size; ++i) std::printf(" %d", r->bytes[i]);
    std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3 || bus.open(argv[1]) != Status::ok) return 1;
    const int a = static_cast<int>(std::strtol(argv[2], nullptr, 0));
    std::vector<std::uint8_t> bytes(33);
    std::iota(bytes.begin(), bytes.end(), std::uint8_t{100});
    std::printf("funcs %08lx\n", bus.funcs());
    say("write_quick", bus.write_quick(a));
    say("write_byte_data 0x75 0x68", bus.write_byte_data(a, 0x75, 0x68));
    say("read_byte_data 0x75", bus.read_byte_data(a, 0x75));
    say("write_word_data 0x40 0xBEEF", bus.write_word_data(a, 0x40, 0xBEEF));
    say("read_word_data 0x40", bus.read_word_data(a, 0x40));
    say("read_byte_data 0x40", bus.read_byte_data(a, 0x40));
    say("write_byte 0x75", bus.write_byte(a, 0x75));
    say("read_byte", bus.read_byte(a));
    say("write_i2c_block_data 14", bus.write_i2c_block_data(a, 0x3B, bytes.data(), 14));
    say("read_i2c_block_data 14", bus.read_i2c_block_data(a, 0x3B, 14));
    say("read_i2c_block_data 32", bus.read_i2c_block_data(a, 0x30, 32));
    say("read_i2c_block_data 33", bus.read_i2c_block_data(a, 0x30, 33));
    say("write_i2c_block_data 33", bus.write_i2c_block_data(a, 0x30, bytes.data(), 33));
    say("write_block_data 33", bus.write_block_data(a, 0x30, bytes.data(), 33));
    say("read_block_data", bus.read_block_data(a, 0x3B));
    say("write_block_data 3", bus.write_block_data(a, 0x60, bytes.data(), 3));
    say("process_call", bus.process_call(a, 0x10, 0x1234));
    say("block_process_call", bus.block_process_call(a, 0x10, bytes.data(), 4));
    say("absent read_byte_data", bus.read_byte_data(0x22, 0));
    say("absent write_quick", bus.write_quick(0x22));
    std::uint8_t in[2] = {};
    i2c_msg message = i2c_read(a, in, 2);
    // smbus2 asks the kernel, which has the last word; ours says so before asking
    bus.i2c_rdwr(&message, 1) == Status::not_supported ? std::puts("i2c_rdwr -> unsupported")
                                                       : std::puts("i2c_rdwr -> ?");
    // the same registers by the longer ways, which smbus2 does not have
    std::uint8_t many[40] = {};
    const std::uint8_t reg = 0x3B;
    const Transfer transfer{static_cast<std::uint8_t>(a), &reg, 1, many, 14};
    const bool long_read =
        bus.read_registers(a, 0x20, many, 40) == Status::ok && many[0x3B - 0x20] == 100;
    const bool as_transfer = bus.transfer(&transfer, 1) == Status::ok && many[13] == 113;
    std::fprintf(stderr, "%s linux_vm.registers-of-40-bytes-in-blocks\n",
                 long_read ? "ok" : "FAIL");
    std::fprintf(stderr, "%s linux_vm.transfer-over-smbus\n", as_transfer ? "ok" : "FAIL");
    return long_read && as_transfer ? 0 : 1;
}
