#pragma once
// A unit of a gateway as a source of the live view: its live and health registers, asked for
// twenty times a second.
#include <memory>
#include <string>

#include "examples/gateway/source.hpp"

namespace fairlead::live {

struct ModbusAddress {
    std::string host{"127.0.0.1"};
    int port{1502};
    int unit{1};
};

std::unique_ptr<gateway::Source> make_modbus_unit(const ModbusAddress& address);

}  // namespace fairlead::live
