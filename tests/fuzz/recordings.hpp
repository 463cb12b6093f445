#pragma once
// What every reader of recordings promises, whatever the bytes are: a recording that holds
// together, or a refusal that names the file.
#include <optional>
#include <string>
#include <string_view>

#include "host_sim/recording/plausible.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/recording/writers.hpp"
#include "tests/fuzz/input.hpp"

namespace fairlead::fuzz {

/// The recording that the bytes hold, or nothing where they are refused.
inline std::optional<sim::Recording> read(std::string_view bytes, const std::string& name,
                                          const sim::ReadOptions& options = {}) {
    try {
        sim::Recording r = sim::parse_recording(bytes, name, options);
        FUZZ_EXPECT(r.poses.empty() || r.samples.empty());
        FUZZ_EXPECT(r.truth.empty() || r.truth.size() == r.samples.size());
        FUZZ_EXPECT(options.salvage == sim::Salvage::yes || r.damage.empty());
        FUZZ_EXPECT(r.size() <= bytes.size());
        static_cast<void>(sim::doubts(r));
        return r;
    } catch (const sim::BadData& e) {
        FUZZ_EXPECT(std::string_view{e.what()}.find(name) != std::string_view::npos);
    } catch (const sim::BadSpec&) {  // the options, not the bytes
    }
    return std::nullopt;
}

}  // namespace fairlead::fuzz
