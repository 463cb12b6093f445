#include "examples/live/modbus_unit.hpp"

#include <modbus/modbus.h>

#include <array>

#include "examples/gateway/register_map.hpp"
#include "port/linux/clock.hpp"

namespace fairlead::live {
namespace {

using namespace gateway;
namespace map = gateway::register_map;

constexpr std::uint16_t block = 125;  // one request
constexpr std::uint16_t registers_read = 2 * block;
using Registers = std::array<std::uint16_t, registers_read>;

class ModbusUnit : public Source {
  public:
    explicit ModbusUnit(const ModbusAddress& address)
        : context_{modbus_new_tcp_pi(address.host.c_str(), std::to_string(address.port).c_str())} {
        modbus_set_slave(context_, address.unit);
        modbus_set_response_timeout(context_, 1, 0);
    }
    ~ModbusUnit() override {
        stop();
        close();
        modbus_free(context_);
    }

  protected:
    void run(UnitFeed& feed, UnitState& state) override {
        Registers table{};
        std::uint32_t last = 0;
        while (sleep_until(port::now_ns() + 50 * port::ms)) {
            if (!read(table)) {
                state.status = port::registers::status_bit::source_lost;
                feed.state.write(state);
                if (!sleep_until(port::now_ns() + port::second)) return;
                continue;
            }
            take(table, state);
            if (state.sequence != last) state.arrival_ns = port::now_ns();
            last = state.sequence;
            feed.state.write(state);
        }
    }

  private:
    bool read(Registers& table) {
        if (!connected_) {
            connected_ = modbus_connect(context_) == 0;
            if (!connected_) return false;
        }
        for (int at = 0; at < registers_read; at += block)
            if (modbus_read_registers(context_, at, block, table.data() + at) != block) {
                close();
                return false;
            }
        constexpr auto& magic = port::registers::find(map::fields, "magic");
        return port::registers::get_word(table.data(), magic) == port::registers::magic;
    }
    void close() {
        if (connected_) modbus_close(context_);
        connected_ = false;
    }

    static void take(const Registers& table, UnitState& s) {
        const auto f32 = [&](const port::registers::Field& f) {
            return port::registers::get_f32(table.data() + f.address);
        };
        const auto u32 = [&](const port::registers::Field& f) {
            return static_cast<std::uint32_t>(port::registers::get_word(table.data(), f));
        };
#define FAIRLEAD_ROW(name) port::registers::find(map::fields, name)
        s.sequence = u32(FAIRLEAD_ROW("live.seq_begin"));
        s.t_ns = static_cast<std::int64_t>(
            port::registers::get_word(table.data(), FAIRLEAD_ROW("live.t_ns")));
        s.q_wb = {f32(FAIRLEAD_ROW("live.q_w")), f32(FAIRLEAD_ROW("live.q_x")),
                  f32(FAIRLEAD_ROW("live.q_y")), f32(FAIRLEAD_ROW("live.q_z"))};
        s.p_w_m = {f32(FAIRLEAD_ROW("live.p_x")), f32(FAIRLEAD_ROW("live.p_y")),
                   f32(FAIRLEAD_ROW("live.p_z"))};
        s.rate_rad_s = {f32(FAIRLEAD_ROW("live.rate_x")), f32(FAIRLEAD_ROW("live.rate_y")),
                        f32(FAIRLEAD_ROW("live.rate_z"))};
        s.status = static_cast<std::uint16_t>(u32(FAIRLEAD_ROW("live.status")));
        s.samples = u32(FAIRLEAD_ROW("health.samples"));
        s.sample_faults = u32(FAIRLEAD_ROW("health.sample_faults"));
        s.gaps = u32(FAIRLEAD_ROW("health.gaps"));
        s.bytes = u32(FAIRLEAD_ROW("health.bytes"));
        s.frames = u32(FAIRLEAD_ROW("health.frames"));
        s.frames_damaged = u32(FAIRLEAD_ROW("health.frames_damaged"));
        s.breaks = u32(FAIRLEAD_ROW("health.breaks"));
        s.publications = u32(FAIRLEAD_ROW("health.publications"));
        s.publish_us = u32(FAIRLEAD_ROW("health.publish_us"));
        s.publish_max_us = u32(FAIRLEAD_ROW("health.publish_max_us"));
        take_calibration(table, s.calibration);
#undef FAIRLEAD_ROW
    }

    /// A gateway of an earlier map has zeros there: no sensor is watched.
    static void take_calibration(const Registers& table, CalibrationState& c) {
        const auto word = [&](const char* name) {
            return static_cast<std::uint16_t>(
                port::registers::get_word(table.data(), map::field(name)));
        };
        const auto vector = [&](const char* first) {
            const std::uint16_t* at = table.data() + map::field(first).address;
            return Vec3{port::registers::get_f32(at), port::registers::get_f32(at + 2),
                        port::registers::get_f32(at + 4)};
        };
        c.sensors = word("calibration.sensors");
        c.done = word("calibration.done");
        c.gyro_percent = word("calibration.gyro_percent");
        c.accel_faces = word("calibration.accel_faces");
        c.mag_percent = word("calibration.mag_percent");
        c.gyro_offset_rad_s = vector("calibration.gyro_offset_x");
        c.accel.offset = vector("calibration.accel_offset_x");
        c.accel.matrix = {vector("calibration.accel_matrix_11"),
                          vector("calibration.accel_matrix_21"),
                          vector("calibration.accel_matrix_31")};
        c.mag.offset = vector("calibration.mag_offset_x");
        c.mag.matrix = {vector("calibration.mag_matrix_11"), vector("calibration.mag_matrix_21"),
                        vector("calibration.mag_matrix_31")};
    }

    modbus_t* context_;
    bool connected_{};
};

}  // namespace

std::unique_ptr<Source> make_modbus_unit(const ModbusAddress& address) {
    return std::make_unique<ModbusUnit>(address);
}

}  // namespace fairlead::live
