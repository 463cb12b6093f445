#pragma once
// The library's pipelines as the gateway's own sources run them: records in, the stream's bytes and
// the newest pose out. IMU samples pass the attitude stage first.
#include <cstdint>
#include <memory>
#include <optional>

#include "examples/gateway/config.hpp"
#include "fairlead/base/bytes.hpp"
#include "fairlead/base/types.hpp"

namespace fairlead::gateway {

/// Record: Pose, or Sample.
template <class Record>
class Chain {
  public:
    Chain() = default;
    virtual ~Chain() = default;
    Chain(const Chain&) = delete;
    Chain& operator=(const Chain&) = delete;

    /// As of a pipeline; the bytes are valid until the next call. flush(): until Status::end.
    virtual Bytes push(const Record& record) noexcept = 0;
    virtual Bytes idle() noexcept = 0;
    virtual Bytes flush() noexcept = 0;
    virtual bool push_event(const Event& event) noexcept = 0;
    /// The newest pose, if the last push gave one; it is ahead of the curve by the reducer's delay.
    virtual std::optional<Pose> pose() const noexcept = 0;
    /// Records that the intake refused or mended.
    virtual std::uint32_t faults() const noexcept = 0;
};

/// period_ns: of the records; 0, or beyond what a pipeline takes: it is measured.
std::unique_ptr<Chain<Pose>> make_pose_chain(const UnitConfig& unit, std::int64_t period_ns);
/// Without a magnetometer, heading is relative to the start.
std::unique_ptr<Chain<Sample>> make_sample_chain(const UnitConfig& unit, std::int64_t period_ns,
                                                 bool magnetometer);

}  // namespace fairlead::gateway
