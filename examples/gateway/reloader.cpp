#include "examples/gateway/reloader.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace fairlead::gateway {

Reloader::Reloader(std::function<ConfigResult()> load)
    : load_{std::move(load)}, fd_{eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)} {
    if (fd_ < 0) throw std::system_error{errno, std::generic_category(), "eventfd"};
    thread_ = std::thread{[this] { run(); }};
}

Reloader::~Reloader() {
    {
        const std::lock_guard<std::mutex> lock{mutex_};
        state_ = State::ended;
    }
    changed_.notify_all();
    thread_.join();
    close(fd_);
}

void Reloader::begin(std::vector<UnitConfig> running) {
    const std::lock_guard<std::mutex> lock{mutex_};
    if (state_ != State::idle) {
        again_ = true;
        return;
    }
    running_ = std::move(running);
    state_ = State::wanted;
    changed_.notify_all();
}

std::optional<Reloader::Loaded> Reloader::take() {
    std::uint64_t ignored = 0;
    if (read(fd_, &ignored, sizeof ignored) < 0) return std::nullopt;
    const std::lock_guard<std::mutex> lock{mutex_};
    if (state_ != State::loaded) return std::nullopt;
    return std::move(loaded_);
}

void Reloader::finish(Service::Change change, std::vector<UnitConfig> running) {
    const std::lock_guard<std::mutex> lock{mutex_};
    change_ = std::move(change);
    running_ = std::move(running);
    state_ = State::finishing;
    changed_.notify_all();
}

bool Reloader::is_busy() const {
    const std::lock_guard<std::mutex> lock{mutex_};
    return state_ == State::loading;
}

void Reloader::run() {
    std::unique_lock<std::mutex> lock{mutex_};
    for (;;) {
        changed_.wait(lock, [this] {
            return state_ == State::wanted || state_ == State::finishing || state_ == State::ended;
        });
        if (state_ == State::ended) return;
        if (state_ == State::wanted) {
            load_once(lock);
            continue;
        }
        Service::Change change = std::move(change_);
        lock.unlock();
        change.finish();
        lock.lock();
        if (state_ == State::finishing) state_ = again_ ? State::wanted : State::idle;
        again_ = false;
    }
}

void Reloader::load_once(std::unique_lock<std::mutex>& lock) {
    state_ = State::loading;
    const std::vector<UnitConfig> running = running_;
    lock.unlock();
    Loaded out;
    try {
        ConfigResult next = load_();
        if (next.errors.empty()) {
            out.plan = Service::plan(next.config, running);
            out.config = std::move(next.config);
        } else {
            out.error = next.errors.front();
        }
    } catch (const StartError& error) {
        out.error = error.text;
    } catch (const std::exception& error) {
        out.error = error.what();
    }
    lock.lock();
    if (state_ == State::ended) return;
    loaded_ = std::move(out);
    state_ = State::loaded;
    const std::uint64_t one = 1;
    if (write(fd_, &one, sizeof one) < 0) return;  // it counts: never full
}

}  // namespace fairlead::gateway
