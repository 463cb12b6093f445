// A reader that holds the header of another run, because the one between was lost or its own was
// kept for too long, believes nothing: no number of followers may agree under a wrong header.
#include <gtest/gtest.h>

#include <vector>

#include "fairlead/pipeline.hpp"
#include "fairlead/wire/decoder.hpp"
#include "tests/unit/header_frame.hpp"

namespace fairlead {
namespace {

template <class AKind>
struct Board {
    using Input = VectorSample<1>;
    using Channels = fairlead::Channels<Vector<1>>;
    using Filter = NoFilter;
    static constexpr std::size_t delay_records_max = 16;
    static constexpr Beam beam = Beam::narrow;
    static constexpr std::size_t events_max = 0;
    using Kind = AKind;
};

template <class AKind>
std::vector<std::uint8_t> stream() {
    typename Pipeline<Board<AKind>>::Params params;
    params.sample_period_ns = 10'000'000;
    params.restart_interval_ns = 400'000'000;
    Pipeline<Board<AKind>> chain{params};
    std::vector<std::uint8_t> out;
    for (int i = 0; i < 300; ++i) {
        VectorSample<1> s;
        s.t_ns = 1'000'000'000 + i * std::int64_t{10'000'000};
        s.value[0] = 0.01f * static_cast<float>(i * i * 7919 % 13);
        s.flags = flag::vector_valid;
        for (const std::uint8_t byte : chain.push(s)) out.push_back(byte);
    }
    return out;
}

/// Of the headers of runs that began at other times, those whose digest looks to a single check
/// like one of the 64 times that a reader tries: one of a thousand.
template <class AKind>
void nothing_is_believed() {
    const std::vector<std::uint8_t> bytes = stream<AKind>();
    const std::size_t size = wire::frame_size(bytes[0], bytes[1]);
    wire::Header header;
    ASSERT_EQ(wire::read_header(bytes.data(), size, header), wire::HeaderFault::none);
    const std::uint32_t digest = header.digest;
    const std::int64_t turn = std::int64_t{64} << header.shape.timing.time_bits;
    std::size_t tried = 0;
    for (std::int64_t k = 0; tried < 20 && k < 100000; ++k) {
        header.shape.base_ns = 5'000'000'000 + k * 1'000'003;
        std::uint8_t other[wire::long_frame_max];
        const std::size_t n = wire::write_header(header, other);
        bool alike = false;
        for (std::int64_t i = 0; i < 64; ++i)
            alike = alike || wire::seed(header.digest, {i * turn, 0, 0}) == wire::seed(digest, {});
        if (!alike) continue;
        ++tried;
        using Reader = wire::Decoder<1, 0, wire::KindSet<curve::Smooth, curve::Cubics>>;
        Reader reader;
        ASSERT_TRUE(reader.adopt(other, n));
        std::size_t pieces = 0;
        typename Reader::Piece piece;
        const auto drain = [&] {
            while (reader.next(piece)) ++pieces;
        };
        for (std::size_t i = size; i < bytes.size(); ++i)
            if (reader.push(bytes[i])) drain();
        while (reader.finish()) drain();
        EXPECT_EQ(pieces, 0u) << "base " << header.shape.base_ns;
    }
    EXPECT_EQ(tried, 20u);
}

TEST(StaleHeader, NothingIsBelieved) { nothing_is_believed<curve::Smooth>(); }
TEST(StaleHeader, NothingIsBelievedOfCubics) { nothing_is_believed<curve::Cubics>(); }

}  // namespace
}  // namespace fairlead
