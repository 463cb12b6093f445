#include "port/linux/spidev.hpp"

#include <linux/spi/spidev.h>

#include <cerrno>
#include <cstdio>

#include "port/linux/clock.hpp"

namespace fairlead::port {
namespace {

std::size_t buffer_size() noexcept {
    std::FILE* const file = std::fopen("/sys/module/spidev/parameters/bufsiz", "re");
    unsigned size = 0;
    if (file != nullptr) {
        if (std::fscanf(file, "%u", &size) != 1) size = 0;
        std::fclose(file);
    }
    return size >= 64 ? size : Spidev::buffer_default;
}

unsigned long as_argument(const void* p) noexcept { return reinterpret_cast<unsigned long>(p); }

}  // namespace

Status Spidev::call(unsigned long request, const void* argument) noexcept {
    if (system_->ioctl(fd_, request, as_argument(argument)) >= 0) return Status::ok;
    errno_ = errno;
    return i2c_status(errno_);
}

Status Spidev::open(const char* path, std::uint32_t hz) noexcept {
    close();
    if (hz == 0) return Status::bad_argument;
    fd_ = system_->open(path);
    if (fd_ < 0) {
        errno_ = errno;
        return i2c_status(errno_);
    }
    const std::uint8_t mode = SPI_MODE_3, bits = 8;
    Status s = call(SPI_IOC_WR_MODE, &mode);
    if (s == Status::ok) s = call(SPI_IOC_WR_BITS_PER_WORD, &bits);
    if (s == Status::ok) s = call(SPI_IOC_WR_MAX_SPEED_HZ, &hz);
    if (s != Status::ok) {
        close();
        return s == Status::bad_argument ? Status::not_supported : s;
    }
    hz_ = hz;
    read_max_ = buffer_size();
    return Status::ok;
}

void Spidev::close() noexcept {
    if (fd_ >= 0) system_->close(fd_);
    fd_ = -1;
}

Status Spidev::exchange(const std::uint8_t* out, std::size_t out_size, std::uint8_t* in,
                        std::size_t in_size) noexcept {
    if (fd_ < 0) {
        errno_ = EBADF;
        return Status::closed;
    }
    if (out_size == 0 || out_size > read_max_ || in_size > read_max_) return Status::bad_argument;
    spi_ioc_transfer parts[2] = {};
    parts[0].tx_buf = as_argument(out);
    parts[0].len = static_cast<std::uint32_t>(out_size);
    parts[0].speed_hz = hz_;
    parts[1].rx_buf = as_argument(in);
    parts[1].len = static_cast<std::uint32_t>(in_size);
    parts[1].speed_hz = hz_;
    return call(in_size > 0 ? SPI_IOC_MESSAGE(2) : SPI_IOC_MESSAGE(1), parts);
}

void Spidev::pause_us(std::uint32_t microseconds) noexcept {
    sleep_until(now_ns() + static_cast<std::int64_t>(microseconds) * us);
}

}  // namespace fairlead::port
