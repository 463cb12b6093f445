#include "port/linux/serial.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace fairlead::port {
namespace {

struct Rate {
    int baud;
    speed_t code;
};
constexpr std::array<Rate, 17> rates{{
    {9600, B9600},
    {19200, B19200},
    {38400, B38400},
    {57600, B57600},
    {115200, B115200},
    {230400, B230400},
    {460800, B460800},
    {500000, B500000},
    {576000, B576000},
    {921600, B921600},
    {1000000, B1000000},
    {1500000, B1500000},
    {2000000, B2000000},
    {2500000, B2500000},
    {3000000, B3000000},
    {3500000, B3500000},
    {4000000, B4000000},
}};

const Rate* find_rate(int baud) noexcept {
    for (const Rate& rate : rates) {
        if (rate.baud == baud) return &rate;
    }
    return nullptr;
}

Status status_of(int error) noexcept {
    switch (error) {
        case ENOENT:
        case ENODEV:
        case ENXIO: return Status::not_found;
        case EACCES:
        case EPERM: return Status::no_permission;
        case EBUSY: return Status::busy;
        case ENOTTY: return Status::not_supported;
        default: return Status::io_error;
    }
}

bool make_raw(int fd, const SerialConfig& config, speed_t speed) noexcept {
    termios line{};
    if (tcgetattr(fd, &line) != 0) return false;
    cfmakeraw(&line);
    line.c_cflag |= CLOCAL | CREAD;
    line.c_cflag &= ~static_cast<tcflag_t>(PARENB | PARODD | CSTOPB | CRTSCTS);
    if (config.parity != Parity::none) line.c_cflag |= PARENB;
    if (config.parity == Parity::odd) line.c_cflag |= PARODD;
    if (config.stop_bits == 2) line.c_cflag |= CSTOPB;
    line.c_cc[VMIN] = 0;
    line.c_cc[VTIME] = 0;
    if (cfsetispeed(&line, speed) != 0 || cfsetospeed(&line, speed) != 0) return false;
    return tcsetattr(fd, TCSANOW, &line) == 0 && tcflush(fd, TCIOFLUSH) == 0;
}

}  // namespace

bool is_baud_rate(int baud) noexcept { return find_rate(baud) != nullptr; }

SerialPort& SerialPort::operator=(SerialPort&& other) noexcept {
    if (this != &other) {
        close();
        fd_ = other.fd_;
        other.fd_ = -1;
    }
    return *this;
}

void SerialPort::close() noexcept {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
}

Status SerialPort::open(const char* device, const SerialConfig& config) noexcept {
    close();
    const Rate* rate = find_rate(config.baud);
    if (rate == nullptr || config.stop_bits < 1 || config.stop_bits > 2) {
        return Status::bad_argument;
    }
    fd_ = ::open(device, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd_ >= 0 && ioctl(fd_, TIOCEXCL) == 0 && make_raw(fd_, config, rate->code)) {
        return Status::ok;
    }
    errno_ = errno;
    close();
    return status_of(errno_);
}

Result<std::size_t> SerialPort::read(std::uint8_t* out, std::size_t size) noexcept {
    const ssize_t got = ::read(fd_, out, size);
    if (got > 0) return static_cast<std::size_t>(got);
    errno_ = errno;
    if (got < 0 && (errno_ == EAGAIN || errno_ == EINTR)) return Status::timeout;
    if (got == 0) return Status::timeout;  // VMIN 0: a raw line has no end of file, only silence
    return Status::disconnected;
}

Result<std::size_t> SerialPort::write(const std::uint8_t* bytes, std::size_t size) noexcept {
    const ssize_t put = ::write(fd_, bytes, size);
    if (put >= 0) return static_cast<std::size_t>(put);
    errno_ = errno;
    if (errno_ == EAGAIN || errno_ == EINTR) return Status::timeout;
    return Status::disconnected;
}

}  // namespace fairlead::port
