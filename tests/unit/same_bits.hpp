#pragma once
// Digests of what stages give, against the digests in tests/golden/bits. The streams are made of
// integers (tests/target/stream.hpp), so that they are the same on every machine, and so must the
// outputs be. A change that is meant: the failing test writes the new file and says where; copy it.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/target/stream.hpp"

namespace fairlead::target {

inline void mix(Digest& d, double x) {
    std::int64_t bits = 0;
    if (!approx::is_nan(x)) std::memcpy(&bits, &x, sizeof bits);
    mix(d, bits);
}
inline void mix(Digest& d, const BasicVec3<double>& v) { mix(d, v.x), mix(d, v.y), mix(d, v.z); }

}  // namespace fairlead::target

namespace fairlead::test {

using target::Digest;
using target::Record;
using Records = std::vector<Record>;

/// A stream of tests/target/streams/adverse, or one of the test's own.
struct NamedStream {
    std::string name;
    Records clean, all;  // all: with what only an intake should meet
};

inline std::vector<NamedStream> streams(std::vector<std::string> lines = {}) {
    std::ifstream file{"tests/target/streams/adverse"};
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    std::vector<NamedStream> out;
    for (const std::string& line : lines) {
        target::Recipe recipe;
        if (!target::parse(line.c_str(), recipe)) continue;
        NamedStream stream{recipe.name, {}, {}};
        target::Generator clean{recipe}, all{recipe};
        for (Record record; clean.next(record, false);) stream.clean.push_back(record);
        for (Record record; all.next(record, true);) stream.all.push_back(record);
        out.push_back(std::move(stream));
    }
    return out;
}

/// The digests of one test, by stage and stream.
class Bits {
  public:
    explicit Bits(const std::string& name) : name_{name + ".txt"} {
        std::ifstream file{golden()};
        for (std::string stage, stream, digest; file >> stage >> stream >> digest;)
            known_[stage + ' ' + stream] = digest;
    }
    Bits(const Bits&) = delete;
    Bits& operator=(const Bits&) = delete;

    void add(const std::string& stage, const std::string& stream,
             const std::function<void(Digest&)>& run) {
        Digest digest;
        run(digest);
        char text[16];
        std::snprintf(text, sizeof text, "%08x", digest.value());
        found_[stage + ' ' + stream] = text;
    }

    ~Bits() {
        bool same = known_.size() == found_.size();
        for (const auto& [what, digest] : found_) {
            const auto at = known_.find(what);
            const bool equal = at != known_.end() && at->second == digest;
            same = same && equal;
            EXPECT_TRUE(equal) << what << " gives other bits than " << golden() << " says";
        }
        EXPECT_TRUE(same);
        if (same) return;
        const std::string path = ::testing::TempDir() + name_;
        std::ofstream out{path};
        for (const auto& [what, digest] : found_) out << what << ' ' << digest << '\n';
        std::printf("where the change is meant: cp %s %s\n", path.c_str(), golden().c_str());
    }

  private:
    std::string golden() const { return "tests/golden/bits/" + name_; }

    std::string name_;
    std::map<std::string, std::string> known_{}, found_{};
};

}  // namespace fairlead::test
