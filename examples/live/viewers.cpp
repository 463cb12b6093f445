#include "examples/live/viewers.hpp"

#include <httplib.h>

#include <chrono>
#include <utility>

namespace fairlead::live {
namespace {

constexpr time_t patience_s = 5;

/// Text that a page of this program alone may use; no other site can show or read it.
void protect(httplib::Response& response) {
    response.set_header("Cache-Control", "no-store");
    response.set_header("X-Content-Type-Options", "nosniff");
    response.set_header("X-Frame-Options", "DENY");
    response.set_header("Content-Security-Policy",
                        "default-src 'none'; script-src 'unsafe-inline'; style-src "
                        "'unsafe-inline'; img-src data: blob:; connect-src 'self'");
}

bool is_loopback(const std::string& host) {
    return host == "127.0.0.1" || host == "localhost" || host == "[::1]" || host == "::1";
}

}  // namespace

Viewers::Viewers(std::string page)
    : server_{std::make_unique<httplib::Server>()}, page_{std::move(page)} {
    server_->new_task_queue = [] { return new httplib::ThreadPool(most + 4); };
    server_->set_write_timeout(patience_s);
    server_->set_socket_options([](socket_t s) {
        const int yes = 1,
                  few = 8192;  // else megabytes wait in the kernel for a viewer that sleeps
        setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        setsockopt(s, SOL_SOCKET, SO_SNDBUF, &few, sizeof few);
    });
    server_->set_read_timeout(patience_s);
    server_->set_keep_alive_max_count(20);
    server_->set_payload_max_length(4096);
    server_->Get("/", [this](const httplib::Request&, httplib::Response& response) {
        protect(response);
        response.set_content(page_, "text/html; charset=utf-8");
    });
    server_->Get("/values", [this](const httplib::Request&, httplib::Response& response) {
        protect(response);
        const auto newest = newest_;
        {
            const std::lock_guard lock{newest->mutex};
            if (newest->viewers >= most) {
                response.status = 503;
                response.set_content("16 viewers are connected already\n", "text/plain");
                return;
            }
            ++newest->viewers;
        }
        auto seen = std::make_shared<std::uint64_t>(0);
        response.set_chunked_content_provider(
            "text/event-stream",
            [newest, seen](std::size_t, httplib::DataSink& sink) {
                std::string event;
                {
                    std::unique_lock lock{newest->mutex};
                    newest->changed.wait_for(lock, std::chrono::seconds(2), [&] {
                        return newest->ended || newest->number != *seen;
                    });
                    if (newest->ended) return false;
                    // a source that says nothing: still, a viewer that has gone is noticed
                    event = newest->number != *seen ? "data: " + newest->line + "\n\n" : ": \n\n";
                    *seen = newest->number;
                }
                return sink.write(event.data(), event.size());
            },
            [newest](bool) {
                const std::lock_guard lock{newest->mutex};
                --newest->viewers;
            });
    });
}

Viewers::~Viewers() {
    {
        const std::lock_guard lock{newest_->mutex};
        newest_->ended = true;
    }
    newest_->changed.notify_all();
    server_->stop();
    if (thread_.joinable()) thread_.join();
}

int Viewers::open(const std::string& host, int port) {
    if (is_loopback(host))  // a name of another site that leads here is not ours
        server_->set_pre_routing_handler(
            [](const httplib::Request& request, httplib::Response& response) {
                const std::string name = request.get_header_value("Host");
                if (is_loopback(name.substr(0, name.rfind(':'))))
                    return httplib::Server::HandlerResponse::Unhandled;
                response.status = 403;
                return httplib::Server::HandlerResponse::Handled;
            });
    if (port == 0)
        port = server_->bind_to_any_port(host.c_str());
    else if (!server_->bind_to_port(host.c_str(), port))
        return 0;
    if (port <= 0) return 0;
    thread_ = std::thread{[this] { server_->listen_after_bind(); }};
    for (int i = 0; i < 200 && !server_->is_running(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return port;
}

void Viewers::show(std::string line) {
    {
        const std::lock_guard lock{newest_->mutex};
        newest_->line = std::move(line);
        ++newest_->number;
    }
    newest_->changed.notify_all();
}

int Viewers::count() const {
    const std::lock_guard lock{newest_->mutex};
    return newest_->viewers;
}

}  // namespace fairlead::live
