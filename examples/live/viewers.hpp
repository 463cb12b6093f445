#pragma once
// The page and its stream of values over HTTP, by cpp-httplib. Read-only: there is nothing that a
// viewer can change. At most 16 viewers; one that does not take its bytes for five seconds is
// dropped, and never holds up another or the source.
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace httplib {
class Server;
}

namespace fairlead::live {

class Viewers {
  public:
    static constexpr int most = 16;

    explicit Viewers(std::string page);
    ~Viewers();
    Viewers(const Viewers&) = delete;
    Viewers& operator=(const Viewers&) = delete;

    /// Port 0: any that is free. @return the port, or 0 where the address cannot be had.
    int open(const std::string& host, int port);
    /// The newest values, as one line of JSON. A viewer that is behind gets the newest only.
    void show(std::string line);
    int count() const;

  private:
    struct Newest {
        std::mutex mutex;
        std::condition_variable changed;
        std::string line;
        std::uint64_t number{0};
        int viewers{0};
        bool ended{false};
    };

    std::unique_ptr<httplib::Server> server_;
    std::shared_ptr<Newest> newest_{std::make_shared<Newest>()};
    std::string page_;
    std::thread thread_;
};

}  // namespace fairlead::live
