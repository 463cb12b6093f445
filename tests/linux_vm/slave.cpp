// The sensors of the test machine: chip models that answer the transfers of the kernel's adapter
// and pull its GPIO lines. usage: slave RECORDING|-|still CHIP...
//   CHIP: kind@address[,pull=FILE][,nack=P][,miss=P][,reset=SECONDS]...
// Ends on SIGTERM and says what it did.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "host_sim/chip_models/ak8963_model.hpp"
#include "host_sim/chip_models/bmi_model.hpp"
#include "host_sim/chip_models/icm42688_model.hpp"
#include "host_sim/chip_models/iis2mdc_model.hpp"
#include "host_sim/chip_models/lsm6_model.hpp"
#include "host_sim/chip_models/magnetometer_models.hpp"
#include "host_sim/chip_models/mpu6xxx_model.hpp"
#include "port/linux/clock.hpp"
#include "tests/linux_vm/source.hpp"

namespace fairlead::vm {
namespace {

volatile std::sig_atomic_t ended = 0;
void end(int) { ended = 1; }

struct Chip {
    std::unique_ptr<sim::ChipModel> model;
    std::string name;
    int pull{-1};
    double nack{0}, miss{0};
    std::vector<double> resets;  // seconds after the first sample, soonest first
    std::uint64_t nacks{0}, missed{0}, done_resets{0};
    std::int64_t first_ns{0};
};

std::unique_ptr<sim::ChipModel> make(const std::string& kind, std::uint8_t address,
                                     const Source& source) {
    using Kind = sim::Lsm6Model::Kind;
    const double dso_ns = 16e9 / 6667;
    if (kind == "lsm6dso")
        return std::make_unique<sim::Lsm6Model>(Kind::dso, source.motion(dso_ns), address);
    if (kind == "lsm6dsv")
        return std::make_unique<sim::Lsm6Model>(Kind::dsv, source.motion(1e9 / 480), address);
    if (kind == "icm42688")
        return std::make_unique<sim::Icm42688Model>(source.motion(2e6), address);
    if (kind == "icm42605")  // the relative that the kernel's driver knows
        return std::make_unique<sim::Icm42688Model>(source.motion(2e6), address, 0x42);
    if (kind == "mpu6050")
        return std::make_unique<sim::Mpu6xxxModel>(source.motion(2e6), 0x68, address);
    if (kind == "mpu6500")
        return std::make_unique<sim::Mpu6xxxModel>(source.motion(2e6), 0x70, address);
    if (kind == "lis3mdl")
        return std::make_unique<sim::Lis3mdlModel>(source.motion(1e9 / 155), address);
    if (kind == "bmi160")
        return std::make_unique<sim::BmiModel>(sim::BmiModel::Kind::bmi160, source.motion(2.5e6));
    if (kind == "ak8963") return std::make_unique<sim::Ak8963Model>(source.motion(1e7));
    if (kind == "iis2mdc") return std::make_unique<sim::Iis2mdcModel>(source.motion(1e7));
    if (kind == "ak09916") return std::make_unique<sim::Ak09916Model>(source.motion(1e7));
    std::fprintf(stderr, "slave: no chip is called %s\n", kind.c_str());
    std::exit(2);
}

Chip parse(const std::string& text, const Source& source) {
    Chip chip;
    const std::size_t at = text.find('@'), comma = text.find(',');
    chip.name = text.substr(0, comma);
    const auto address = std::strtoul(text.c_str() + at + 1, nullptr, 0);
    chip.model = make(text.substr(0, at), static_cast<std::uint8_t>(address), source);
    for (std::size_t from = comma; from != std::string::npos;) {
        const std::size_t next = text.find(',', from + 1);
        const std::string item = text.substr(from + 1, next - from - 1);
        const std::size_t equals = item.find('=');
        const std::string key = item.substr(0, equals), value = item.substr(equals + 1);
        if (key == "pull") chip.pull = ::open(value.c_str(), O_WRONLY | O_CLOEXEC);
        if (key == "nack") chip.nack = std::atof(value.c_str());
        if (key == "miss") chip.miss = std::atof(value.c_str());
        if (key == "reset") chip.resets.push_back(std::atof(value.c_str()));
        from = next;
    }
    return chip;
}

class Slave {
  public:
    Slave(int fd, std::vector<Chip> chips) : fd_{fd}, chips_{std::move(chips)} {}

    void run() {
        while (!ended) {
            std::int64_t next = port::now_ns() + port::second;
            for (const Chip& c : chips_) next = std::min(next, c.model->next_ns());
            pollfd p{fd_, POLLIN, 0};
            const timespec left = port::remaining(next);
            const int ready = ::ppoll(&p, 1, &left, nullptr);
            advance();
            if (ready > 0) answer();
            advance();
        }
    }
    void report() const {
        for (const Chip& c : chips_)
            std::printf("slave %s samples %llu nacks %llu missed-edges %llu resets %llu\n",
                        c.name.c_str(), static_cast<unsigned long long>(c.model->produced),
                        static_cast<unsigned long long>(c.nacks),
                        static_cast<unsigned long long>(c.missed),
                        static_cast<unsigned long long>(c.done_resets));
    }

  private:
    void advance() {
        const std::int64_t now = port::now_ns();
        for (Chip& c : chips_) {
            c.model->advance(now);
            if (c.first_ns == 0 && c.model->produced > 0) c.first_ns = now;
            for (; !c.model->edges.empty(); c.model->edges.pop_front()) raise(c);
            const bool due = c.first_ns != 0 && !c.resets.empty() &&
                             static_cast<double>(now - c.first_ns) * 1e-9 > c.resets.front();
            if (!due) continue;
            c.resets.erase(c.resets.begin());
            ++c.done_resets;
            c.model->power_cycle();
        }
    }
    void raise(Chip& c) {
        if (c.pull < 0) return;
        if (c.miss > 0 && chance_(random_) < c.miss) {
            ++c.missed;
            return;
        }
        static_cast<void>(!::pwrite(c.pull, "pull-up", 7, 0));
        static_cast<void>(!::pwrite(c.pull, "pull-down", 9, 0));
    }
    Chip* find(unsigned address) {
        for (Chip& c : chips_)
            if (c.model->address() == address && c.model->answers()) return &c;
        return nullptr;
    }
    void answer() {
        struct Head {
            std::uint16_t address, flags, length, zero;
        };
        const ssize_t size = ::read(fd_, request_.data(), request_.size());
        if (size < 8) return;
        std::uint32_t number = 0, n = 0;
        std::memcpy(&number, request_.data(), 4);
        std::memcpy(&n, request_.data() + 4, 4);
        std::size_t from = 8 + n * sizeof(Head), to = 8;
        auto status = static_cast<std::int32_t>(n);
        for (std::uint32_t i = 0; i < n && status >= 0; ++i) {
            Head h{};
            std::memcpy(&h, request_.data() + 8 + i * sizeof h, sizeof h);
            Chip* const chip = find(h.address);
            if (chip == nullptr) {
                status = -ENXIO;
                break;
            }
            if (i == 0 && chip->nack > 0 && chance_(random_) < chip->nack) {
                ++chip->nacks;
                status = -ENXIO;
                break;
            }
            if (h.flags & 1) {
                for (unsigned k = 0; k < h.length; ++k) reply_[to++] = chip->model->read();
            } else {
                chip->model->begin_write();
                for (unsigned k = 0; k < h.length; ++k) chip->model->write(request_[from++]);
            }
        }
        std::memcpy(reply_.data(), &number, 4);
        std::memcpy(reply_.data() + 4, &status, 4);
        static_cast<void>(!::write(fd_, reply_.data(), to));
    }

    int fd_;
    std::vector<Chip> chips_;
    std::vector<std::uint8_t> request_ = std::vector<std::uint8_t>(32768);
    std::vector<std::uint8_t> reply_ = std::vector<std::uint8_t>(32768);
    std::mt19937 random_{20240611};
    std::uniform_real_distribution<double> chance_{0, 1};
};

}  // namespace
}  // namespace fairlead::vm

int main(int argc, char** argv) {
    using namespace fairlead::vm;
    if (argc < 3) return 2;
    std::signal(SIGTERM, end);
    const int fd = ::open("/dev/fairlead-i2c", O_RDWR | O_CLOEXEC);
    if (fd < 0) {
        std::perror("/dev/fairlead-i2c");
        return 1;
    }
    const std::string recording = argv[1];
    const Source source{recording};
    std::vector<Chip> chips;
    for (int i = 2; i < argc; ++i) chips.push_back(parse(argv[i], source));
    Slave slave{fd, std::move(chips)};
    slave.run();
    slave.report();
    return 0;
}
