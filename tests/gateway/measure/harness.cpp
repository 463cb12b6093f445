#include "tests/gateway/measure/harness.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <modbus/modbus.h>
#include <netinet/in.h>
#include <pty.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>

#include "fairlead/math/quat.hpp"
#include "fairlead/pipeline.hpp"
#include "port/linux/clock.hpp"

namespace fairlead::gateway::measure {
namespace {

[[noreturn]] void give_up(const char* what) {
    std::perror(what);
    std::exit(70);
}

int connect_to(int port) {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(fd, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0) return fd;
    close(fd);
    return -1;
}

bool send_all(int fd, const void* bytes, std::size_t size) {
    return send(fd, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT) == static_cast<ssize_t>(size);
}

}  // namespace

GatewayProcess::GatewayProcess(const std::string& program, std::vector<std::string> arguments) {
    std::array<int, 2> pipe_fds{};
    if (pipe2(pipe_fds.data(), O_CLOEXEC) != 0) give_up("pipe");
    pid_ = fork();
    if (pid_ == 0) {
        dup2(pipe_fds[1], STDERR_FILENO);
        std::vector<char*> argv{const_cast<char*>(program.c_str())};
        for (std::string& argument : arguments) argv.push_back(argument.data());
        argv.push_back(nullptr);
        execv(program.c_str(), argv.data());
        _exit(127);
    }
    close(pipe_fds[1]);
    log_fd_ = pipe_fds[0];
    std::string log;
    for (char letter = 0; port_ == 0 && read(log_fd_, &letter, 1) == 1; log += letter) {
        const std::size_t at = log.find("ready port=");
        if (letter == '\n' && at != std::string::npos) port_ = std::atoi(log.c_str() + at + 11);
    }
    if (port_ == 0) {
        std::fprintf(stderr, "the gateway did not start:\n%s", log.c_str());
        std::exit(70);
    }
    fcntl(log_fd_, F_SETFL, O_NONBLOCK);
}

GatewayProcess::~GatewayProcess() {
    end(SIGTERM);
    close(log_fd_);
}

void GatewayProcess::end(int signal) {
    if (pid_ < 0) return;
    kill(pid_, signal);
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
}
void GatewayProcess::kill_hard() { end(SIGKILL); }

long GatewayProcess::resident_kib() const {
    std::ifstream status{"/proc/" + std::to_string(pid_) + "/status"};
    for (std::string line; std::getline(status, line);) {
        if (line.compare(0, 6, "VmRSS:") == 0) return std::atol(line.c_str() + 6);
    }
    return 0;
}

BoardOnLine::BoardOnLine(const Settings& settings) : settings_{settings} {
    std::array<char, 128> name{};
    if (openpty(&line_, &held_, name.data(), nullptr, nullptr) != 0) give_up("openpty");
    termios raw{};
    tcgetattr(held_, &raw);
    cfmakeraw(&raw);
    tcsetattr(held_, TCSANOW, &raw);
    fcntl(line_, F_SETFL, O_NONBLOCK);
    device_ = name.data();
    poses_.reserve(1'000'000);
}
BoardOnLine::~BoardOnLine() {
    stop();
    close(held_);
    close(line_);
}
void BoardOnLine::start() {
    thread_ = std::thread{[this] { run(); }};
}
void BoardOnLine::stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
}

Pose motion_of(const BoardOnLine::Settings& settings, std::uint64_t i) {
    const double t = static_cast<double>(i) / settings.rate_hz;
    const double k = 1 + 0.1 * settings.seed;
    const double move = t - std::sin(0.7 * t) / 0.7;  // stands still whenever cos(0.7 t) is 1
    Pose pose;
    pose.t_ns = 3'600'000'000'000 +
                static_cast<std::int64_t>(i) * static_cast<std::int64_t>(1e9 / settings.rate_hz);
    pose.p_w_m = {static_cast<float>(std::sin(1.3 * k * move)),
                  static_cast<float>(0.4 * std::cos(2.1 * k * move)),
                  static_cast<float>(1 + 0.1 * std::sin(3 * k * move))};
    const double a = 1.5 * std::sin(0.9 * k * move);
    const double b = 0.6 * std::cos(1.7 * k * move);
    pose.q_wb = normalised(Quat{static_cast<float>(std::cos(a) * std::cos(b)),
                                static_cast<float>(std::sin(a) * std::cos(b)),
                                static_cast<float>(std::cos(a) * std::sin(b)),
                                static_cast<float>(std::sin(a) * std::sin(b))});
    pose.flags = flag::position_valid | flag::orientation_valid;
    return pose;
}

void BoardOnLine::run() {
    using Chain = Pipeline<MeasuredBoard>;
    Chain::Params params;
    params.sample_period_ns = period_ns();
    params.tolerance.position_m = tolerance_m;
    params.tolerance.orientation_rad = tolerance_rad;
    params.restart_interval_ns = static_cast<std::int64_t>(settings_.restart_s * 1e9);
    params.header_interval_ns = port::second;  // a gateway may come late
    const auto chain = std::make_unique<Chain>(params);
    std::mt19937 random{settings_.seed};
    std::uniform_real_distribution<double> uniform;
    const std::int64_t began_ns = port::now_ns();
    for (std::uint64_t i = 0; !stop_; ++i) {
        port::sleep_until(began_ns + static_cast<std::int64_t>(i) * period_ns());
        const Pose pose = motion_of(settings_, i);
        poses_.push_back(pose);
        const Bytes frames = chain->push(pose);
        std::vector<std::uint8_t> bytes{frames.data, frames.data + frames.size};
        for (auto& byte : bytes) {
            if (settings_.damaged_share > 0 && uniform(random) < settings_.damaged_share) {
                byte ^= static_cast<std::uint8_t>(1 + random() % 255);
                ++damaged_;
            }
        }
        // a full line loses bytes, as a UART does that nobody reads
        if (!bytes.empty() && write(line_, bytes.data(), bytes.size()) < 0) continue;
        bytes_ += bytes.size();
    }
}

Client::Client(int port, int unit) : context_{modbus_new_tcp("127.0.0.1", port)} {
    modbus_set_slave(context_, unit);
    modbus_set_response_timeout(context_, 10, 0);
    connected_ = modbus_connect(context_) == 0;
}
Client::~Client() {
    if (connected_) modbus_close(context_);
    modbus_free(context_);
}
bool Client::read(std::uint16_t address, std::uint16_t count, std::uint16_t* out) {
    return connected_ && modbus_read_registers(context_, address, count, out) == count;
}

void Latencies::add(const Latencies& other) {
    us.insert(us.end(), other.us.begin(), other.us.end());
    failed += other.failed;
}
float Latencies::at(double share) {
    if (us.empty()) return 0;
    std::sort(us.begin(), us.end());
    const auto i = static_cast<std::size_t>(share * static_cast<double>(us.size() - 1));
    return us[i];
}

Latencies poll_all(int port, int units, int clients, double rate_hz, double seconds) {
    std::vector<Latencies> each(static_cast<std::size_t>(clients));
    std::vector<std::thread> threads;
    for (int c = 0; c < clients; ++c) {
        threads.emplace_back([&, c] {
            Latencies& mine = each[static_cast<std::size_t>(c)];
            Client client{port, 1 + c % units};
            const std::int64_t began_ns = port::now_ns() + c * port::ms;
            const auto count = static_cast<int>(seconds * rate_hz);
            mine.us.reserve(static_cast<std::size_t>(count));
            for (int i = 0; i < count; ++i) {
                port::sleep_until(began_ns + static_cast<std::int64_t>(i * 1e9 / rate_hz));
                std::array<std::uint16_t, 44> registers{};
                const std::int64_t t = port::now_ns();
                if (t > began_ns + static_cast<std::int64_t>(seconds * 1e9)) break;  // far too slow
                if (!client.read(port::registers::live_begin, 44, registers.data())) ++mine.failed;
                mine.us.push_back(static_cast<float>(port::now_ns() - t) * 1e-3f);
            }
        });
    }
    Latencies all;
    for (std::size_t c = 0; c < threads.size(); ++c) {
        threads[c].join();
        all.add(each[c]);
    }
    return all;
}

Hostile::Hostile(int port, bool connections) {
    threads_.emplace_back([this, port] {  // wrong quantities, as fast as the peer answers
        constexpr std::array<std::uint8_t, 12> wrong{0, 1, 0, 0, 0, 6, 1, 3, 0, 32, 0, 126};
        while (!stop_) {
            const int fd = connect_to(port);
            const timeval patience{1, 0};
            setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
            std::array<std::uint8_t, 512> answer{};
            while (!stop_ && fd >= 0 && send_all(fd, wrong.data(), wrong.size()) &&
                   recv(fd, answer.data(), answer.size(), 0) > 0) {
            }
            close(fd);
            port::sleep_until(port::now_ns() + 10 * port::ms);
        }
    });
    threads_.emplace_back([this, port] {  // half headers, then one byte every 0.4 s
        constexpr std::array<std::uint8_t, 12> request{0, 1, 0, 0, 0, 6, 1, 3, 0, 32, 0, 44};
        while (!stop_) {
            const int fd = connect_to(port);
            send_all(fd, request.data(), 7);
            for (std::size_t i = 7; i < 12 && !stop_; ++i) {
                port::sleep_until(port::now_ns() + 400 * port::ms);
                if (!send_all(fd, &request[i], 1)) break;
            }
            close(fd);
        }
    });
    if (!connections) return;
    threads_.emplace_back([this, port] {  // a thousand connections a second, and noise on them
        std::mt19937 random{5};
        while (!stop_) {
            const int fd = connect_to(port);
            std::array<std::uint8_t, 40> noise{};
            for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
            if (fd >= 0) send_all(fd, noise.data(), noise.size());
            close(fd);
            port::sleep_until(port::now_ns() + port::ms);
        }
    });
}
Hostile::~Hostile() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
}

Deviation compare(const CurveReader& reader, const std::vector<Pose>& poses) {
    Deviation out;
    out.samples = poses.size();
    for (const Pose& pose : poses) {
        const auto* o = reader.covering(port::CurveChannel::orientation, pose.t_ns);
        const auto* p = reader.covering(port::CurveChannel::position, pose.t_ns);
        if (o != nullptr) {
            const float angle = rotation_angle(port::curve::orientation(*o, pose.t_ns), pose.q_wb);
            out.worst_rad = std::max(out.worst_rad, static_cast<double>(angle));
        }
        if (p != nullptr) {
            const Vec3 d = port::curve::position(*p, pose.t_ns) - pose.p_w_m;
            for (const float e : {d.x, d.y, d.z}) {
                out.worst_m = std::max(out.worst_m, static_cast<double>(std::abs(e)));
            }
        }
        out.covered += o != nullptr && p != nullptr ? 1u : 0u;
    }
    return out;
}

}  // namespace fairlead::gateway::measure
