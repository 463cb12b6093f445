#pragma once
// What a replay of a recording through the library brought to light: the reduced curve beside what
// went in, judged in double from the emitted bytes alone, as a decoder on the far end has them.
// replay_board.hpp runs the pipeline, replay_judge.hpp judges.
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fairlead/board.hpp"
#include "fairlead/math/approx.hpp"
#include "fairlead/sense/intake.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/replay/attitude_trace.hpp"

namespace fairlead::sim {

/// What the reduction keeps small: the bytes, or the number of knots (the earlier search, whose
/// stream has a format of its own).
enum class Objective { bytes, knots };

struct ReplayOptions {
    std::string filter;                      // SPEC; empty: none
    double tol_pos_m{1e-3};                  // per axis
    double tol_rot_rad{pi_v<double> / 720};  // full rotation angle: 0.25 deg
    std::uint32_t delay_max{120};
    Objective objective{Objective::bytes};
    Beam beam{Beam::medium};  // width of the search
    int continuity{1};        // at least; 2: of positions, and with the knots objective of both
    double restart_s{2};      // 0: every frame decodes alone
    std::uint16_t stream_id{0};
    bool position{true}, orientation{true};  // channels that are reduced
    std::optional<AttitudeMode> mode;        // of an IMU; empty: all of its sensors
};

/// One channel, judged at every accepted record in which it is valid.
struct ChannelResult {
    std::size_t samples{};  // records that hold the channel
    std::size_t curves{},
        knots{};  // knots: interior ones, with multiplicity; StoredChannel::knots()
    std::size_t control_points{};  // order + knots, summed over the curves
    std::size_t pieces{};          // of all axes
    std::size_t breaks{};          // jumps within a motion, of all axes
    std::size_t bytes{};           // of the frames, or shares of frames, that carry it
    std::size_t violations{};      // samples outside tolerance, or without a curve: must be 0
    std::size_t changed{};         // samples whose curve changed after they were covered: must be 0
    double max_error{};            // m per axis, or rad: against the reducer's input
    double max_raw{}, rms_raw{};   // distance to the raw samples, per axis or angle
    std::uint32_t max_delay{};     // records
    double mean_delay{}, max_delay_ms{};
    std::vector<std::int64_t> knot_ns;
    std::vector<double> error;         // one per record; NaN where the channel is not valid
    std::vector<std::uint32_t> delay;  // one per record
};

/// The discrete events.
struct EventResult {
    std::size_t offered{}, refused{};  // refused: by a full queue
    std::size_t bytes{};               // of their frames
    std::size_t wrong{};               // not decoded, or with another time or value: must be 0
    std::size_t late{};                // not in the bytes of the record that followed, once the
                                       // stream has begun: must be 0
    std::vector<Event> accepted, decoded;
    std::vector<std::size_t> due;  // per accepted event: the stream's size after that record
};

struct Replay {
    std::string name;
    ReplayOptions options;
    double seconds{};
    std::size_t records_in{}, bytes_per_record{}, bytes_in{};
    std::optional<AttitudeTrace> attitude;     // of an IMU
    std::vector<Pose> raw;                     // accepted by Intake; of an IMU: its orientation
    std::vector<Pose> input;                   // what the reducer was given: raw, or filtered
    std::vector<Pose> decoded;                 // the curve of the stream at the times of `input`
    std::string stream;                        // the emitted bytes
    std::size_t frames{}, restarts{}, runs{};  // of the stream
    std::size_t header_bytes{};
    std::size_t refused{};                        // by the intake: records, or a channel of one
    std::size_t overflows{};                      // frames that did not fit: must be 0
    std::vector<std::size_t> bytes_after_record;  // one per record in, before the flush
    std::vector<std::size_t> bytes_after_input;   // one per pose of `input`
    ChannelResult position, orientation;
    EventResult events;
    std::vector<std::pair<std::string, std::size_t>> faults;  // by kind
    std::size_t filter_delay{};                               // records
};

/// The intake's parameters for a recording: a gap is 100 ms, or three periods of a slow recording.
IntakeParams intake_params(const Recording& recording);

/// Of --max-delay: what the pipelines here have memory for.
inline constexpr std::uint32_t delay_least = 16, delay_most = 240;

/// Runs the recording's poses, or an IMU's samples, through the pipeline, with the heap sealed,
/// then judges the bytes. An IMU has no position channel. Throws BadSpec (filter, parameters).
Replay replay(const Recording& recording, const ReplayOptions& options);

const char* to_string(Beam beam);
const char* to_string(Objective objective);

}  // namespace fairlead::sim
