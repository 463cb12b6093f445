#pragma once
// A read-only Modbus server on libmodbus that one misbehaving client cannot slow down for others.
//
// libmodbus's own receive loop blocks the whole server for half a second per malformed request and
// as long as a client cares to dribble (measured: 0.5 s to 4.5 s). Here every byte is framed by
// this code under poll(), and libmodbus sees complete, checked requests only: it builds and sends
// the answer from a static table. Client slots, buffers and counters are fixed when the program is
// compiled; nothing is allocated after open.
//
// Bound: one request per client and turn, so a flood delays others by its share of a turn at most.
#include <array>
#include <cstddef>
#include <cstdint>

struct _modbus;

namespace fairlead::port {

/// A unit's table: register `address` is first[address].
struct RegisterTable {
    std::uint16_t* first{};
    std::uint16_t count{};
};

/// Who knows the values. Called in the server's thread, just before an answer is built.
class RegisterBank {
  public:
    /// Brings registers [address, address + quantity) of a unit up to date; the answer to one
    /// request is sent before the next call, so it is never torn. No such unit: {nullptr, 0}.
    virtual RegisterTable prepare(std::uint8_t unit, std::uint16_t address,
                                  std::uint16_t quantity) noexcept = 0;

  protected:
    ~RegisterBank() = default;
};

/// Everything that was answered and everything that was refused. They only ever grow.
struct ModbusCounters {
    std::uint64_t requests{};            // complete requests, whatever the answer
    std::uint64_t illegal_function{};    // exception 01; every write is among them
    std::uint64_t illegal_address{};     // exception 02
    std::uint64_t illegal_value{};       // exception 03: wrong quantity or length
    std::uint64_t unknown_unit{};        // exception 0B (TCP); silence (RTU)
    std::uint64_t accepted{};            // connections
    std::uint64_t refused_network{};     // not in an allowed network
    std::uint64_t refused_full{};        // no free slot, or the host holds its share
    std::uint64_t closed_protocol{};     // bytes that are not Modbus
    std::uint64_t closed_deadline{};     // a frame begun but not finished in time
    std::uint64_t closed_idle{};         // no request for too long
    std::uint64_t closed_slow_reader{};  // did not take its answers
    std::uint64_t rtu_damaged{};         // CRC wrong, cut or overlong
    std::uint64_t rtu_foreign{};         // valid frames for other units, or broadcast
    std::uint64_t rtu_lost_line{};       // the line went away
};

/// libmodbus, reduced to the part that builds and sends one answer.
class ModbusReply {
  public:
    ModbusReply() = default;
    ~ModbusReply();
    ModbusReply(const ModbusReply&) = delete;
    ModbusReply& operator=(const ModbusReply&) = delete;

    /// Takes over a libmodbus context and the descriptor in it; null (out of memory) is refused.
    bool adopt(_modbus* context) noexcept;
    _modbus* context() const noexcept { return context_; }

    /// Answers the complete request `adu` whose PDU of pdu_size bytes starts at pdu. False: the
    /// peer did not take the whole answer. In: the socket is set; unknown units are the caller's.
    bool answer(const std::uint8_t* adu, std::size_t size, const std::uint8_t* pdu,
                std::size_t pdu_size, std::uint8_t unit, RegisterBank& bank,
                ModbusCounters& counters) noexcept;
    bool refuse(const std::uint8_t* adu, std::uint8_t exception, int sent_size) noexcept;

  private:
    void release() noexcept;

    _modbus* context_{};
};

}  // namespace fairlead::port
