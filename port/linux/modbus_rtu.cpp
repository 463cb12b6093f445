#include "port/linux/modbus_rtu.hpp"

#include <modbus/modbus.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace fairlead::port {
namespace {

constexpr std::int64_t retry_every_ns = 1'000'000'000;
constexpr std::int64_t margin_ns = 2'000'000;        // what a kernel may add between two bytes
constexpr std::int64_t shortest_gap_ns = 1'750'000;  // by the specification, above 19200 baud
constexpr std::int64_t late_max_ns = 1'000'000'000;  // from a request's first byte to its last

/// 3.5 characters of 11 bits.
std::int64_t character_gap_ns(int baud) noexcept {
    return std::max(shortest_gap_ns, 38'500'000'000 / baud);
}

}  // namespace

Status ModbusRtuServer::open(const ModbusRtuConfig& config, std::int64_t now_ns) noexcept {
    config_ = config;
    if (!is_baud_rate(config.line.baud) || config.gap_ns < 0) return Status::bad_argument;
    silence_ns_ = std::max(config.gap_ns, character_gap_ns(config.line.baud)) + margin_ns;
    if (!reply_.adopt(modbus_new_rtu(config.device, config.line.baud,
                                     static_cast<char>(config.line.parity), 8,
                                     config.line.stop_bits))) {
        return Status::bad_argument;
    }
    retry_ns_ = now_ns + retry_every_ns;
    return connect();
}

Status ModbusRtuServer::connect() noexcept {
    clear();
    late_used_ = 0;
    request_used_ = 0;
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
        *wake_ns = std::min(*wake_ns, last_byte_ns_ + silence_ns_);
    }
    out[0] = {fd_, POLLIN, 0};
    return 1;
}

void ModbusRtuServer::serve(const pollfd* polled, std::int64_t now_ns) noexcept {
    if (fd_ < 0) return;
    now_ns_ = now_ns;
    if (used_ > 0 && now_ns - last_byte_ns_ >= silence_ns_) silence();
    if ((polled[0].revents & (POLLIN | POLLHUP | POLLERR)) != 0) {
        std::array<std::uint8_t, modbus::rtu_adu_max> bytes{};
        const ssize_t got = ::read(fd_, bytes.data(), bytes.size());
        if (got <= 0 && !(got < 0 && (errno == EAGAIN || errno == EINTR))) {
            ++counters_.rtu_lost_line;
            modbus_close(reply_.context());
            fd_ = -1;
            return;
        }
        if (got > 0) last_byte_ns_ = now_ns;
        for (ssize_t i = 0; i < got; ++i) take(bytes[static_cast<std::size_t>(i)]);
    }
    if (request_used_ == 0) return;
    // a line that does not take the answer is noticed by the next read
    static_cast<void>(reply_.answer(request_.data(), request_used_, request_.data() + 1,
                                    request_used_ - 3, request_[0], bank_, counters_));
    request_used_ = 0;
}

void ModbusRtuServer::clear() noexcept {
    used_ = 0;
    lost_ = false;
}

void ModbusRtuServer::take(std::uint8_t byte) noexcept {
    if (used_ == buffer_.size()) {  // longer than any frame: only its last bytes can matter
        lost_ = true;
        std::copy(buffer_.end() - request_size + 1, buffer_.end(), buffer_.begin());
        used_ = request_size - 1;
    }
    if (used_ == 0) since_ns_ = now_ns_;
    buffer_[used_++] = byte;
    if (late_used_ > 0 && join_late()) return;
    if (lost_) return;
    const modbus::RtuFrame frame = modbus::find_rtu_frame(buffer_.data(), used_);
    if (frame.state == modbus::Framing::complete)
        take_frame(frame);
    else
        lost_ = frame.state == modbus::Framing::broken;
}

/// Whole, and the CRC is right. An answer from our own unit is the echo of what we have sent.
void ModbusRtuServer::take_frame(const modbus::RtuFrame& frame) noexcept {
    if (frame.is_request && is_ours(buffer_[0]))
        expect_answer(buffer_.data(), frame.size);
    else
        ++counters_.rtu_foreign;
    clear();
    late_used_ = 0;
}

/// The line has been silent for longer than the pieces of a frame are apart.
void ModbusRtuServer::silence() noexcept {
    const std::uint8_t* last = buffer_.data() + (used_ < request_size ? 0 : used_ - request_size);
    if (used_ >= request_size && is_our_read(last)) {
        if (used_ > request_size) ++counters_.rtu_damaged;  // what stood before it
        expect_answer(last, request_size);
        late_used_ = 0;
    } else if (modbus::crc_matches(buffer_.data(), used_) && buffer_[1] != 0 &&
               buffer_[1] < 0x80) {  // a function without a known length
        if (is_ours(buffer_[0]))
            expect_answer(buffer_.data(), used_);
        else
            ++counters_.rtu_foreign;
        late_used_ = 0;
    } else {
        keep_late();
        if (late_used_ == 0) ++counters_.rtu_damaged;
    }
    clear();
}

/// Do the late pieces and the bytes since the silence make one request?
bool ModbusRtuServer::join_late() noexcept {
    const std::size_t whole = late_used_ + used_;
    if (whole > request_size || now_ns_ - late_since_ns_ > late_max_ns) {
        late_used_ = 0;
        ++counters_.rtu_damaged;
        return false;
    }
    if (whole < request_size) return false;
    std::array<std::uint8_t, request_size> joined = late_;
    std::copy_n(buffer_.begin(), used_, joined.begin() + static_cast<std::ptrdiff_t>(late_used_));
    if (!is_our_read(joined.data())) return false;
    expect_answer(joined.data(), joined.size());
    clear();
    late_used_ = 0;
    return true;
}

/// Bytes before a silence that can be the first pieces of a read request for us.
void ModbusRtuServer::keep_late() noexcept {
    if (late_used_ + used_ >= request_size) {
        late_used_ = 0;
        return;
    }
    if (late_used_ == 0) late_since_ns_ = since_ns_;
    std::copy_n(buffer_.begin(), used_, late_.begin() + static_cast<std::ptrdiff_t>(late_used_));
    late_used_ += used_;
    const bool reads = late_used_ < 2 || late_[1] == 0x03 || late_[1] == 0x04;
    if (!reads || !is_ours(late_[0])) late_used_ = 0;
}

void ModbusRtuServer::expect_answer(const std::uint8_t* adu, std::size_t size) noexcept {
    // of several requests in one turn only the last one's sender still waits
    std::copy_n(adu, size, request_.begin());
    request_used_ = size;
}

bool ModbusRtuServer::is_our_read(const std::uint8_t* adu) noexcept {
    return (adu[1] == 0x03 || adu[1] == 0x04) && modbus::crc_matches(adu, request_size) &&
           is_ours(adu[0]);
}

bool ModbusRtuServer::is_ours(std::uint8_t unit) noexcept {
    return unit != 0 && bank_.prepare(unit, 0, 1).first != nullptr;  // 0: to all, answered by none
}

}  // namespace fairlead::port
