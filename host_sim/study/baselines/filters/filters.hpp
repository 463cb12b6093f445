#pragma once
// The rivals of the orientation and position filters, as published; host only. Each takes a pose
// and gives one, without delay of its own (latency() says how far its centre tap lies behind).
//   - ComponentFilter: each quaternion component by a mask, then re-normalised [Azuma & Bishop
//   1994]
//   - GlobalLogFilter: exp(mask of log q) [Hanotaux & Peroche 1993; Lee & Shin 2002, (27)]
//   - CumulativeFilter: filtered steps, integrated again [Fang et al. 1998; Lee & Shin 2002, (28)]
//   - CasteljauFilter: Bezier point of the window by repeated slerp [Shoemake 1985]: binomial taps
//   - ExponentialFilter: slerp from the last output to the new sample
//   - OneEuroFilter: the same with a cut-off that rises with the speed [Casiez et al. 2012]
// Positions go through the plain linear version of each.
#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "fairlead/base/types.hpp"

namespace fairlead::sim {

class CausalFilter {
  public:
    virtual ~CausalFilter() = default;
    virtual Pose push(const Pose& pose) = 0;
    /// Records between the newest input and the one that the output stands for.
    virtual std::size_t latency() const { return 0; }
};

/// The newest poses under a mask, oldest first, signs continuous; before the window is full its
/// oldest pose stands for the missing ones.
class MaskWindow {
  public:
    explicit MaskWindow(std::size_t taps) : taps_{taps} {}
    void push(const Pose& pose);
    std::size_t size() const { return taps_; }
    const Pose& operator[](std::size_t i) const { return poses_[i]; }

  private:
    std::size_t taps_;
    std::deque<Pose> poses_;
};

/// taps: oldest first, sum 1. centre: the tap that the output stands for; taps.size() - 1 is
/// causal.
class MaskBaseline : public CausalFilter {
  public:
    MaskBaseline(std::vector<float> taps, std::size_t centre)
        : taps_{std::move(taps)}, centre_{centre}, window_{taps_.size()} {}
    Pose push(const Pose& pose) override;
    std::size_t latency() const override { return taps_.size() - 1 - centre_; }

  protected:
    virtual Quat orientation() = 0;
    std::vector<float> taps_;
    std::size_t centre_;
    MaskWindow window_;
};

class ComponentFilter final : public MaskBaseline {
    using MaskBaseline::MaskBaseline;
    Quat orientation() override;
};
class GlobalLogFilter final : public MaskBaseline {
    using MaskBaseline::MaskBaseline;
    Quat orientation() override;
};
class CumulativeFilter final : public MaskBaseline {
    using MaskBaseline::MaskBaseline;
    Quat orientation() override;
    std::deque<Vec3> steps_;  // half-angle steps into the newest samples
    Quat out_{};
};
class CasteljauFilter final : public MaskBaseline {
  public:
    explicit CasteljauFilter(std::size_t taps);

  private:
    Quat orientation() override;
};

class ExponentialFilter final : public CausalFilter {
  public:
    explicit ExponentialFilter(float part) : part_{part} {}
    Pose push(const Pose& pose) override;

  private:
    float part_;
    bool started_{false};
    Pose out_{};
};

struct OneEuroParams {
    float cutoff_min_hz{1}, speed_gain{0}, speed_cutoff_hz{1};
};
class OneEuroFilter final : public CausalFilter {
  public:
    /// speed_gain of positions in Hz per m/s, of orientations in Hz per rad/s.
    OneEuroFilter(const OneEuroParams& position, const OneEuroParams& orientation)
        : position_{position}, orientation_{orientation} {}
    Pose push(const Pose& pose) override;

  private:
    OneEuroParams position_, orientation_;
    bool started_{false};
    Pose raw_{}, out_{};
    Vec3 velocity_{}, rate_{};
};

std::vector<float> binomial_taps(std::size_t n);
std::vector<float> average_taps(std::size_t n);
/// (1 - part)^k, newest heaviest, cut at n and made to sum to one.
std::vector<float> exponential_taps(std::size_t n, float part);

}  // namespace fairlead::sim
