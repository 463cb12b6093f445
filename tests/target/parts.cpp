// Where the RAM of a pipeline goes: one array as large as each part. bounds.py reads their sizes
// from the object file.
#include <type_traits>

#include "fairlead/pipeline.hpp"
#include "fairlead/wire/decoder.hpp"

namespace {

using namespace fairlead;

template <class AChannels, std::size_t Delay, Beam Width>
struct Board {
    using Input = Pose;
    using Channels = AChannels;
    using Filter = PoseFilter<9>;
    static constexpr std::size_t delay_records_max = Delay;
    static constexpr Beam beam = Width;
    static constexpr std::size_t events_max = 0;
};

/// The part of the encoder that carries a channel of the board.
template <class C, class B, std::size_t Window>
using Part =
    typename detail::WireChannel<C, B::beam,
                                 typename detail::KindOf<B>::Type>::Tag::template Channel<Window>;

template <class B>
struct Parts {
    using Whole = Pipeline<B>;
    using Inner = std::decay_t<decltype(std::declval<const typename Whole::Encoder&>().inner())>;
    static constexpr std::size_t position() {
        if constexpr (!B::Channels::template has<Position>)
            return 0;
        else
            return sizeof(Part<Position, B, Inner::window_max>);
    }
    static constexpr std::size_t orientation() {
        if constexpr (!B::Channels::template has<Orientation>)
            return 0;
        else
            return sizeof(Part<Orientation, B, Inner::window_max>);
    }
    static constexpr std::size_t intake = sizeof(typename Whole::Gate),
                                 grid = sizeof(typename Whole::Grid),
                                 filter = sizeof(typename B::Filter),
                                 frames = sizeof(Inner) - position() - orientation(),
                                 all = sizeof(Whole);
};

}  // namespace

// one more byte than the part, so that a part of none has a symbol, too
#define FAIRLEAD_PARTS(stage, ...)                                    \
    char stage##__intake[1 + Parts<__VA_ARGS__>::intake];             \
    char stage##__filter[1 + Parts<__VA_ARGS__>::filter];             \
    char stage##__grid[1 + Parts<__VA_ARGS__>::grid];                 \
    char stage##__position[1 + Parts<__VA_ARGS__>::position()];       \
    char stage##__orientation[1 + Parts<__VA_ARGS__>::orientation()]; \
    char stage##__frames[1 + Parts<__VA_ARGS__>::frames];             \
    char stage##__all[1 + Parts<__VA_ARGS__>::all]

using Both = fairlead::Channels<fairlead::Position, fairlead::Orientation>;
using Turning = fairlead::Channels<fairlead::Orientation>;

extern "C" {
FAIRLEAD_PARTS(orientation_32, Board<Turning, 32, fairlead::Beam::medium>);
FAIRLEAD_PARTS(orientation_120, Board<Turning, 120, fairlead::Beam::medium>);
FAIRLEAD_PARTS(narrow_32, Board<Both, 32, fairlead::Beam::narrow>);
FAIRLEAD_PARTS(narrow_120, Board<Both, 120, fairlead::Beam::narrow>);
FAIRLEAD_PARTS(medium_120, Board<Both, 120, fairlead::Beam::medium>);
FAIRLEAD_PARTS(wide_120, Board<Both, 120, fairlead::Beam::wide>);
}
