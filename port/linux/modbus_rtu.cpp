#include "port/linux/modbus_rtu.hpp"

#include <modbus/modbus.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace fairlead::port {
namespace {

constexpr std::size_t read_request_size = 1 + modbus::read_pdu_size + 2;
constexpr std::int64_t retry_every_ns = 1'000'000'000;
constexpr std::int64_t margin_ns = 2'000'000;  // what a kernel may add between two bytes
constexpr std::int64_t shortest_gap_ns = 1'750'000;

/// 3.5 characters of 11 bits, and never below what the specification sets for fast lines.
std::int64_t frame_gap_ns(int baud) noexcept {
    return std::max(shortest_gap_ns, 38'500'000'000 / baud) + margin_ns;
}

}  // namespace

Status ModbusRtuServer::open(const ModbusRtuConfig& config, std::int64_t now_ns) noexcept {
    config_ = config;
    if (!is_baud_rate(config.line.baud)) return Status::bad_argument;
    gap_ns_ = config.gap_ns > 0 ? config.gap_ns : frame_gap_ns(config.line.baud);
    if (!reply_.adopt(modbus_new_rtu(config.device, config.line.baud,
                                     static_cast<char>(config.line.parity), 8,
                                     config.line.stop_bits))) {
        return Status::bad_argument;
    }
    retry_ns_ = now_ns + retry_every_ns;
    return connect();
}

Status ModbusRtuServer::connect() noexcept {
    used_ = 0;
    overlong_ = false;
    if (modbus_connect(reply_.context()) != 0) {
        fd_ = -1;
        return errno == EACCES ? Status::no_permission : Status::not_found;
    }
    if (config_.rs485) modbus_rtu_set_serial_mode(reply_.context(), MODBUS_RTU_RS485);
    fd_ = modbus_get_socket(reply_.context());
    return Status::ok;
}

std::size_t ModbusRtuServer::prepare(pollfd* out, std::int64_t now_ns,
                                     std::int64_t* wake_ns) noexcept {
    if (fd_ < 0 && now_ns >= retry_ns_) {
        retry_ns_ = now_ns + retry_every_ns;
        static_cast<void>(connect());  // not there yet: the next try is due in a second
    }
    if (fd_ < 0) {
        *wake_ns = std::min(*wake_ns, retry_ns_);
    } else if (used_ > 0) {
        *wake_ns = std::min(*wake_ns, last_byte_ns_ + gap_ns_);
    }
    out[0] = {fd_, POLLIN, 0};
    return 1;
}

void ModbusRtuServer::serve(const pollfd* polled, std::int64_t now_ns) noexcept {
    if (fd_ < 0) return;
    // what came after a silence begins a new frame, even when this thread saw both late
    if (used_ > 0 && now_ns - last_byte_ns_ >= gap_ns_) judge(true);
    if ((polled[0].revents & (POLLIN | POLLHUP | POLLERR)) == 0) return;
    std::array<std::uint8_t, modbus::rtu_adu_max> bytes{};
    const ssize_t got = ::read(fd_, bytes.data(), bytes.size());
    if (got <= 0) {
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
        ++counters_.rtu_lost_line;
        modbus_close(reply_.context());
        fd_ = -1;
        return;
    }
    const std::size_t taken = std::min(static_cast<std::size_t>(got), buffer_.size() - used_);
    std::copy_n(bytes.begin(), taken, buffer_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ += taken;
    overlong_ = overlong_ || taken < static_cast<std::size_t>(got);
    last_byte_ns_ = now_ns;
    if (used_ == read_request_size) judge(false);
}

bool ModbusRtuServer::is_our_read(const std::uint8_t* adu) noexcept {
    return (adu[1] == 0x03 || adu[1] == 0x04) && modbus::crc_matches(adu, read_request_size) &&
           is_ours(adu[0]);
}

bool ModbusRtuServer::is_ours(std::uint8_t unit) noexcept {
    return unit != 0 && bank_.prepare(unit, 0, 1).first != nullptr;  // 0: to all, answered by none
}

void ModbusRtuServer::judge(bool silent) noexcept {
    const std::uint8_t* last =
        buffer_.data() + (used_ < read_request_size ? 0 : used_ - read_request_size);
    if (used_ >= read_request_size && !overlong_ && is_our_read(last)) {
        if (used_ > read_request_size) ++counters_.rtu_damaged;  // what stood before it
        answer(last, read_request_size);
    } else if (!silent) {
        return;  // a longer frame, perhaps
    } else if (overlong_ || !modbus::crc_matches(buffer_.data(), used_)) {
        ++counters_.rtu_damaged;
    } else if (buffer_[1] == 0 || buffer_[1] >= 0x80 || !is_ours(buffer_[0])) {
        ++counters_.rtu_foreign;
    } else {
        answer(buffer_.data(), used_);
    }
    used_ = 0;
    overlong_ = false;
}

void ModbusRtuServer::answer(const std::uint8_t* adu, std::size_t size) noexcept {
    // a line that does not take the answer is noticed by the next read
    static_cast<void>(reply_.answer(adu, size, adu + 1, size - 3, adu[0], bank_, counters_));
}

}  // namespace fairlead::port
