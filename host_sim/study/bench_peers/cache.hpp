#pragma once
// Results that do not change, kept in a text file: one `key<TAB>value` a line, appended as they
// come. A key names the method, its version and the data's hash, so nothing stale is ever found.
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <string>

#include "host_sim/study/baselines/track.hpp"

namespace fairlead::sim {

class Cache {
  public:
    explicit Cache(std::string path);
    Cache(const Cache&) = delete;
    Cache& operator=(const Cache&) = delete;
    ~Cache();

    /// The value kept under `key`, or what `make` returns, which is then kept.
    std::string get(const std::string& key, const std::function<std::string()>& make);

  private:
    std::map<std::string, std::string> values_;
    std::FILE* file_{};
};

/// FNV-1a over times and values.
std::uint64_t hash(const Track& track);

/// "method hash tolerance", the part that all keys share.
std::string cache_key(const std::string& method, std::uint64_t hash, double tolerance);

}  // namespace fairlead::sim
