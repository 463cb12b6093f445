#include "host_sim/study/bench_peers/cache.hpp"

#include <cinttypes>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace fairlead::sim {

Cache::Cache(std::string path) {
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    std::ifstream in{path};
    for (std::string line; std::getline(in, line);) {
        const auto tab = line.find('\t');
        if (tab != std::string::npos) values_[line.substr(0, tab)] = line.substr(tab + 1);
    }
    file_ = std::fopen(path.c_str(), "a");
    if (file_ == nullptr) throw BadData("cannot write " + path);
}

Cache::~Cache() { std::fclose(file_); }

std::string Cache::get(const std::string& key, const std::function<std::string()>& make) {
    if (const auto found = values_.find(key); found != values_.end()) return found->second;
    std::string value = make();
    std::fprintf(file_, "%s\t%s\n", key.c_str(), value.c_str());
    std::fflush(file_);
    return values_[key] = value;
}

std::uint64_t hash(const Track& track) {
    std::uint64_t h = 1469598103934665603u;
    for (const auto* numbers : {&track.t, &track.x}) {
        for (const double v : *numbers) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, &v, sizeof bits);
            for (int i = 0; i < 8; ++i) h = (h ^ ((bits >> (8 * i)) & 255u)) * 1099511628211u;
        }
    }
    return h;
}

std::string cache_key(const std::string& method, std::uint64_t hash, double tolerance) {
    char text[64];
    std::snprintf(text, sizeof text, " %016" PRIx64 " %.9g", hash, tolerance);
    return method + text;
}

}  // namespace fairlead::sim
