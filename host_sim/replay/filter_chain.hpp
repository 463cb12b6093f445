#pragma once
// --filter SPEC: filters chosen at run time, one after another, as one stage. No push allocates.
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "fairlead/smooth/adaptive.hpp"
#include "fairlead/smooth/cascade.hpp"
#include "fairlead/smooth/fairing_window.hpp"
#include "fairlead/smooth/strain.hpp"

namespace fairlead::sim {

extern const char* const filter_help;

inline constexpr std::size_t taps_max = 257, filters_max = 8;
inline constexpr std::size_t rounds_max = 100, lag_max = 400;

/// A large stage on the heap, copied with its owner.
template <class Stage>
class Boxed {
  public:
    explicit Boxed(const Stage& stage) : stage_{std::make_unique<Stage>(stage)} {}
    Boxed(const Boxed& other) : Boxed{*other.stage_} {}
    Boxed(Boxed&&) noexcept = default;
    Boxed& operator=(const Boxed& other) { return *this = Boxed{other}; }
    Boxed& operator=(Boxed&&) noexcept = default;
    ~Boxed() = default;

    std::optional<Pose> push(const Pose& pose) noexcept { return stage_->push(pose); }
    std::optional<Pose> flush() noexcept { return stage_->flush(); }
    void reset() noexcept { stage_->reset(); }
    std::size_t delay() const noexcept { return stage_->delay(); }

  private:
    std::unique_ptr<Stage> stage_;
};

/// Any of the filters that a SPEC can name.
class NamedFilter {
  public:
    using Masked = AnyPoseFilter<taps_max>;
    using Fairing2 = AnyFairingWindow<2, rounds_max>;
    using Fairing3 = AnyFairingWindow<3, rounds_max, true>;
    using Strain = AnyStrainSmoother<lag_max>;

    NamedFilter() = default;
    explicit NamedFilter(const AnyMask<taps_max>& mask) : filter_{Masked{mask}} {}
    explicit NamedFilter(const AdaptivePoseFilter& filter) : filter_{filter} {}
    template <class Stage>
    explicit NamedFilter(Boxed<Stage> stage) : filter_{std::move(stage)} {}

    std::optional<Pose> push(const Pose& pose) noexcept {
        return std::visit([&](auto& f) { return f.push(pose); }, filter_);
    }
    std::optional<Pose> flush() noexcept {
        return std::visit([](auto& f) { return f.flush(); }, filter_);
    }
    void reset() noexcept {
        std::visit([](auto& f) { f.reset(); }, filter_);
    }
    std::size_t delay() const noexcept {
        return std::visit([](const auto& f) { return f.delay(); }, filter_);
    }

  private:
    std::variant<Masked, AdaptivePoseFilter, Boxed<Fairing2>, Boxed<Fairing3>, Boxed<Strain>>
        filter_{};
};

using FilterChain = Chain<NamedFilter, filters_max>;

/// binomial:N | hs:LAMBDA | hu:LAMBDA | sg:N:P | csg:N:P | taps:A,B,...@CENTRE |
/// adaptive:HZ:SLOPE | fair:M:DAMPING:ROUNDS[:BOUND_M:BOUND_RAD] | strain:HZ[:LAG], joined by '+'.
/// Empty: no filter. step_s: from record to record, nominally. Throws BadSpec.
FilterChain parse_filters(const std::string& spec, double step_s);

}  // namespace fairlead::sim
