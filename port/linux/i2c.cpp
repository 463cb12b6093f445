#include "port/linux/i2c.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <utility>

#include "port/linux/clock.hpp"

namespace fairlead::port {
namespace {

class KernelI2c final : public I2cSystem {
  public:
    int open(const char* path) noexcept override { return ::open(path, O_RDWR | O_CLOEXEC); }
    int close(int fd) noexcept override { return ::close(fd); }
    int ioctl(int fd, unsigned long request, unsigned long argument) noexcept override {
        return ::ioctl(fd, request, argument);
    }
};

unsigned long as_argument(const void* p) noexcept { return reinterpret_cast<unsigned long>(p); }

bool fits_seven_bits(int address) noexcept { return address >= 0 && address <= 0x7F; }

/// The adapter functions that a message's flags need.
unsigned long needed_functions(std::uint16_t flags) noexcept {
    unsigned long need = I2C_FUNC_I2C;
    if (flags & I2C_M_TEN) need |= I2C_FUNC_10BIT_ADDR;
    if (flags & I2C_M_NOSTART) need |= I2C_FUNC_NOSTART;
    if (flags & I2C_M_RECV_LEN) need |= I2C_FUNC_SMBUS_READ_BLOCK_DATA;
    if (flags & (I2C_M_STOP | I2C_M_IGNORE_NAK | I2C_M_NO_RD_ACK | I2C_M_REV_DIR_ADDR))
        need |= I2C_FUNC_PROTOCOL_MANGLING;
    return need;
}

}  // namespace

I2cSystem& I2cSystem::kernel() noexcept {
    static KernelI2c kernel;
    return kernel;
}

Status i2c_status(int error) noexcept {
    switch (error) {
        case 0: return Status::ok;
        case ENXIO:
        case EREMOTEIO: return Status::no_acknowledge;
        case EAGAIN: return Status::arbitration_lost;
        case EBADMSG: return Status::checksum;
        case EBUSY: return Status::busy;
        case ETIMEDOUT: return Status::timeout;
        case EPROTO: return Status::protocol_error;
        case EOPNOTSUPP:
        case ENOSYS:
        case ENOTTY: return Status::not_supported;
        case EINVAL:
        case EMSGSIZE:
        case EFAULT: return Status::bad_argument;
        case EBADF: return Status::closed;
        case ENOENT:
        case ENODEV: return Status::not_found;
        case EACCES:
        case EPERM: return Status::no_permission;
        case ESHUTDOWN: return Status::disconnected;
        default: return Status::io_error;
    }
}

I2c::I2c(I2c&& other) noexcept : system_{other.system_} { *this = std::move(other); }

I2c& I2c::operator=(I2c&& other) noexcept {
    if (this == &other) return *this;
    close();
    system_ = other.system_;
    fd_ = std::exchange(other.fd_, -1);
    errno_ = other.errno_;
    funcs_ = std::exchange(other.funcs_, 0);
    pec_ = std::exchange(other.pec_, false);
    force_ = other.force_;
    address_ = std::exchange(other.address_, -1);
    address_forced_ = other.address_forced_;
    return *this;
}

Status I2c::open(int bus, bool force) noexcept {
    if (bus < 0) return fail(EINVAL);
    char path[32] = {};
    std::snprintf(path, sizeof path, "/dev/i2c-%d", bus);
    return open(path, force);
}

Status I2c::open(const char* path, bool force) noexcept {
    close();
    force_ = force;
    fd_ = system_->open(path);
    if (fd_ < 0) return fail(errno);
    if (const Status s = call(I2C_FUNCS, as_argument(&funcs_)); s != Status::ok) {
        close();
        return s;
    }
    return Status::ok;
}

void I2c::close() noexcept {
    if (fd_ >= 0) system_->close(fd_);
    fd_ = -1;
    funcs_ = 0;
    pec_ = false;
    address_ = -1;
}

Status I2c::fail(int error) noexcept {
    errno_ = error;
    return i2c_status(error);
}

Status I2c::call(unsigned long request, unsigned long argument) noexcept {
    if (fd_ < 0) return fail(EBADF);
    return system_->ioctl(fd_, request, argument) < 0 ? fail(errno) : Status::ok;
}

Status I2c::enable_pec(bool on) noexcept {
    if (fd_ < 0) return fail(EBADF);
    if (!has(I2C_FUNC_SMBUS_PEC)) return fail(EOPNOTSUPP);  // the kernel would silently accept it
    if (const Status s = call(I2C_PEC, on ? 1 : 0); s != Status::ok) return s;
    pec_ = on;
    return Status::ok;
}

Status I2c::set_timeout_ms(unsigned timeout_ms) noexcept {
    return call(I2C_TIMEOUT, timeout_ms / 10 + (timeout_ms % 10 != 0 ? 1 : 0));
}

Status I2c::set_retries(unsigned retries) noexcept { return call(I2C_RETRIES, retries); }

Status I2c::enable_ten_bit(bool on) noexcept { return on ? fail(EOPNOTSUPP) : Status::ok; }

Status I2c::select(int address, Force force) noexcept {
    if (!fits_seven_bits(address)) return fail(EINVAL);
    const bool forced = force == Force::as_opened ? force_ : force == Force::yes;
    if (address == address_ && forced == address_forced_) return Status::ok;
    const Status s =
        call(forced ? I2C_SLAVE_FORCE : I2C_SLAVE, static_cast<unsigned long>(address));
    if (s == Status::busy) return Status::address_in_use;
    if (s != Status::ok) return s;
    address_ = address;
    address_forced_ = forced;
    return Status::ok;
}

Status I2c::i2c_rdwr(i2c_msg* messages, std::size_t count) noexcept {
    if (fd_ < 0) return fail(EBADF);
    if (count == 0 || count > message_max) return fail(EINVAL);
    for (std::size_t i = 0; i < count; ++i) {
        const i2c_msg& m = messages[i];
        const bool ten_bit = (m.flags & I2C_M_TEN) != 0;
        if (m.len > message_size_max || m.addr > (ten_bit ? 0x3FF : 0x7F)) return fail(EINVAL);
        if (!has(needed_functions(m.flags))) return fail(EOPNOTSUPP);
    }
    i2c_rdwr_ioctl_data request{};
    request.msgs = messages;
    request.nmsgs = static_cast<__u32>(count);
    const int done = system_->ioctl(fd_, I2C_RDWR, as_argument(&request));
    if (done < 0) return fail(errno);
    return static_cast<std::size_t>(done) == count ? Status::ok : fail(EIO);  // cut short
}

Status I2c::read_registers(int address, std::uint8_t reg, std::uint8_t* data,
                           std::size_t size) noexcept {
    if (size == 0) return fail(EINVAL);
    if (has(I2C_FUNC_I2C)) {
        if (size > message_size_max) return fail(EINVAL);
        i2c_msg messages[2] = {i2c_write(address, &reg, 1), i2c_read(address, data, size)};
        return i2c_rdwr(messages, 2);
    }
    if (size > 256u - reg) return fail(EINVAL);
    for (std::size_t at = 0; at < size;) {
        const std::size_t chunk = std::min<std::size_t>(size - at, I2C_SMBUS_BLOCK_MAX);
        const auto block = read_i2c_block_data(address, static_cast<std::uint8_t>(reg + at), chunk);
        if (!block) return block.status();
        if (block->size != chunk) return fail(EPROTO);
        std::copy_n(block->bytes.begin(), chunk, data + at);
        at += chunk;
    }
    return Status::ok;
}

Status I2c::transfer(const Transfer* list, std::size_t count) noexcept {
    if (fd_ < 0) return fail(EBADF);
    if (count == 0 || count > message_max / 2) return fail(EINVAL);
    if (!has(I2C_FUNC_I2C)) {
        for (std::size_t i = 0; i < count; ++i)
            if (const Status s = transfer_smbus(list[i]); s != Status::ok) return s;
        return Status::ok;
    }
    std::array<i2c_msg, message_max> messages{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Transfer& t = list[i];
        if (t.out_size > 0) messages[n++] = i2c_write(t.address, t.out, t.out_size);
        if (t.in_size > 0) messages[n++] = i2c_read(t.address, t.in, t.in_size);
    }
    return i2c_rdwr(messages.data(), n);
}

/// The shapes that SMBus can say. A list loses its repeated starts there, not its order.
Status I2c::transfer_smbus(const Transfer& t) noexcept {
    if (t.out_size == 1 && t.in_size == 1) {
        const auto byte = read_byte_data(t.address, t.out[0]);
        if (byte) t.in[0] = *byte;
        return byte.status();
    }
    if (t.out_size == 1 && t.in_size > 0)
        return read_registers(t.address, t.out[0], t.in, t.in_size);
    if (t.out_size == 0 && t.in_size == 1) {
        const auto byte = read_byte(t.address);
        if (byte) t.in[0] = *byte;
        return byte.status();
    }
    if (t.in_size > 0 || t.out_size == 0) return fail(EOPNOTSUPP);
    if (t.out_size == 1) return write_byte(t.address, t.out[0]);
    if (t.out_size == 2) return write_byte_data(t.address, t.out[0], t.out[1]);
    return write_i2c_block_data(t.address, t.out[0], t.out + 1, t.out_size - 1u);
}

std::size_t I2c::read_max() const noexcept {
    return has(I2C_FUNC_I2C) ? message_size_max : I2C_SMBUS_BLOCK_MAX;
}

void I2c::pause_us(std::uint32_t microseconds) noexcept {
    sleep_until(now_ns() + static_cast<std::int64_t>(microseconds) * us);
}

i2c_msg i2c_read(int address, std::uint8_t* data, std::size_t size) noexcept {
    i2c_msg m{};
    m.addr = static_cast<__u16>(address);
    m.flags = I2C_M_RD;
    m.len = static_cast<__u16>(std::min<std::size_t>(size, 0xFFFF));
    m.buf = data;
    return m;
}

i2c_msg i2c_write(int address, const std::uint8_t* data, std::size_t size) noexcept {
    i2c_msg m{};
    m.addr = static_cast<__u16>(address);
    m.len = static_cast<__u16>(std::min<std::size_t>(size, 0xFFFF));
    m.buf = const_cast<std::uint8_t*>(data);  // the kernel only reads it; its struct has one type
    return m;
}

}  // namespace fairlead::port
