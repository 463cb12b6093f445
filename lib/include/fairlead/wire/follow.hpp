#pragma once
// Reads what a decoder tells, for those who keep its curves: the live window, the store of the host
// simulator, the gateway. The rule is told here once: a new run forgets nothing of the decoder, but
// its times must not be compared with those before.
#include <cstdint>

#include "fairlead/wire/curve_piece.hpp"

namespace fairlead::wire {

/// One for each decoder. Cost: that of Decoder::next() for each piece.
class PieceFollower {
  public:
    /// Call it after each push() or finish() that returned true. new_run(first): the pieces from
    /// now on are of another run than those before; first: there was none before. take(piece): a
    /// piece.
    /// @return true: there was a piece.
    template <class ADecoder, class NewRun, class Take>
    bool operator()(ADecoder& decoder, NewRun&& new_run, Take&& take) {
        if (decoder.run_index() != run_index_) {
            const bool first = run_index_ == 0;
            run_index_ = decoder.run_index();
            new_run(first);
        }
        bool any = false;
        for (typename ADecoder::Piece piece; decoder.next(piece); any = true) take(piece);
        return any;
    }

  private:
    std::uint32_t run_index_{0};  // of the pieces so far; 0: none yet
};

/// Does a piece hold at this time? Behind its start up to its end, the first one of a curve also at
/// its start.
constexpr bool holds_at(bool begins, std::int64_t start_ns, std::int64_t end_ns,
                        std::int64_t t_ns) noexcept {
    return t_ns <= end_ns && (begins ? t_ns >= start_ns : t_ns > start_ns);
}

}  // namespace fairlead::wire
