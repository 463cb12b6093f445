#include "port/linux/modbus.hpp"

#include <modbus/modbus.h>

#include "port/linux/modbus_adu.hpp"

namespace fairlead::port {

ModbusReply::~ModbusReply() { release(); }

void ModbusReply::release() noexcept {
    if (context_ != nullptr) modbus_close(context_);  // modbus_free() leaves the descriptor open
    modbus_free(context_);
    context_ = nullptr;
}

bool ModbusReply::adopt(_modbus* context) noexcept {
    release();
    context_ = context;
    // libmodbus sleeps for this long before some exceptions: never
    return context_ != nullptr && modbus_set_response_timeout(context_, 0, 1) == 0;
}

bool ModbusReply::refuse(const std::uint8_t* adu, std::uint8_t exception, int sent_size) noexcept {
    return modbus_reply_exception(context_, adu, exception) == sent_size;
}

bool ModbusReply::answer(const std::uint8_t* adu, std::size_t size, const std::uint8_t* pdu,
                         std::size_t pdu_size, std::uint8_t unit, RegisterBank& bank,
                         ModbusCounters& counters) noexcept {
    using modbus::Exception;
    // what surrounds a PDU: unit and CRC on a line, the MBAP header on TCP
    const int envelope = static_cast<int>(size - pdu_size);
    const int exception_size = envelope + 2;
    ++counters.requests;
    modbus::ReadRequest request = modbus::parse_pdu(pdu, pdu_size);
    RegisterTable registers{};
    if (request.exception == Exception::none) {
        registers = bank.prepare(unit, request.address, request.quantity);
        if (registers.first == nullptr) {
            request.exception = Exception::target_failed;
        } else if (request.address + request.quantity > registers.count) {
            request.exception = Exception::illegal_address;
        }
    }
    switch (request.exception) {
        case Exception::none: break;
        case Exception::illegal_function: ++counters.illegal_function; break;
        case Exception::illegal_address: ++counters.illegal_address; break;
        case Exception::illegal_value: ++counters.illegal_value; break;
        case Exception::target_failed: ++counters.unknown_unit; break;
    }
    if (request.exception != Exception::none) {
        return refuse(adu, static_cast<std::uint8_t>(request.exception), exception_size);
    }
    modbus_mapping_t table{};  // functions 3 and 4 read the same registers
    table.nb_registers = table.nb_input_registers = registers.count;
    table.tab_registers = table.tab_input_registers = registers.first;
    const int reply_size = envelope + 2 + 2 * request.quantity;
    return modbus_reply(context_, adu, static_cast<int>(size), &table) == reply_size;
}

}  // namespace fairlead::port
