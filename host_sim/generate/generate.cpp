#include "host_sim/generate/generate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host_sim/generate/motion.hpp"
#include "host_sim/generate/sensor_model.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {

const char* const generate_help =
    "SPEC = ITEM { '+' ITEM }, for example model:optical+rest:1+reach:0.8:5+gap:0.3+oscillate:4:2\n"
    "  motions, one after another, each from rest to rest:\n"
    "    rest:S                       at rest for S seconds\n"
    "    reach:S[:COUNT[:M[:RAD]]]    COUNT min-jerk reaches of S seconds, to places within M\n"
    "                                 metres, turning by at most RAD   [1, 0.5, 1.2]\n"
    "    oscillate:S[:HZ[:M[:RAD]]]   about the present pose   [1, 0.1, 0.3]\n"
    "    turn:S[:RAD_S]               a fast turn with that largest rate   [6]\n"
    "    jump[:M[:RAD]]               a teleport between two records   [0.3, 0.5]\n"
    "  events, from where they stand, while the motion goes on:\n"
    "    gap:S                        no records for S seconds\n"
    "    lose:CHANNEL:S               position, orientation or both are not valid\n"
    "    dropouts:CHANNEL:S:COUNT[:LONGEST]\n"
    "                                 COUNT losses of a channel at random times within S seconds, "
    "each\n"
    "                                 of at most LONGEST seconds   [0.3]\n"
    "    press:CHANNEL:S[:COUNT]      COUNT presses of a button, value 1 and then 0 of a discrete\n"
    "                                 channel, at times within S seconds   [1]\n"
    "  settings of the whole recording:\n"
    "    model:NAME                   the sensor, see below   [optical]\n"
    "    rate:HZ                      records a second   [the model's]\n"
    "    jitter:US                    uneven record times, even within +-US microseconds   [0]";

namespace {

struct Span {
    double from_s{}, to_s{};
    std::uint32_t lost{};  // flag bits; 0: no record at all
    bool holds(double t_s) const { return t_s >= from_s && t_s < to_s; }
};

struct Plan {
    SensorModel model;
    double rate_hz{}, jitter_s{};
    std::vector<Span> events;
    std::vector<Event> presses;
    Random press_times, dropout_times;
    Motion motion;
};

const SensorModel& model_named(const std::string& name, const SpecItem& item) {
    for (const SensorModel& model : sensor_models())
        if (model.name == name) return model;
    item.refuse("no such model");
}

std::uint32_t channel_named(const std::string& name, const SpecItem& item) {
    if (name == "position") return flag::position_valid;
    if (name == "orientation") return flag::orientation_valid;
    if (name == "both") return flag::position_valid | flag::orientation_valid;
    item.refuse("the channel is position, orientation or both");
}

constexpr double longest_s = 86400;

bool add_motion(const SpecItem& item, Motion& motion) {
    if (item.name == "rest") {
        item.expect_arguments(1, 1);
        motion.rest(item.number(0, 0, longest_s));
    } else if (item.name == "reach") {
        item.expect_arguments(1, 4);
        const double s = item.number(0, 0.02, longest_s), m = item.number(2, 0, 100, 0.5);
        const double rad = item.number(3, 0, 100, 1.2);
        const long count = item.arguments.size() > 1 ? item.whole(1, 1, 100000) : 1;
        for (long i = 0; i < count; ++i) motion.reach(s, m, rad);
    } else if (item.name == "oscillate") {
        item.expect_arguments(1, 4);
        motion.oscillate(item.number(0, 0.1, longest_s), item.number(1, 1e-3, 1000, 1),
                         item.number(2, 0, 100, 0.1), item.number(3, 0, 100, 0.3));
    } else if (item.name == "turn") {
        item.expect_arguments(1, 2);
        motion.turn(item.number(0, 0.02, longest_s), item.number(1, 0, 1000, 6));
    } else if (item.name == "jump") {
        item.expect_arguments(0, 2);
        motion.jump(item.number(0, 0, 100, 0.3), item.number(1, 0, 100, 0.5));
    } else {
        return false;
    }
    return true;
}

/// Short losses, as when a hand hides the markers of an optical tracker.
void add_dropouts(const SpecItem& item, double from_s, Plan& plan) {
    item.expect_arguments(3, 4);
    const std::uint32_t channel = channel_named(item.arguments[0], item);
    const double s = item.number(1, 1e-6, longest_s);
    const long count = item.whole(2, 1, 100000);
    const double longest = item.number(3, 1e-6, longest_s, 0.3);
    for (long i = 0; i < count; ++i) {
        const double at_s = plan.dropout_times.uniform(from_s, from_s + s);
        plan.events.push_back({at_s, at_s + plan.dropout_times.uniform(0, longest), channel});
    }
}

/// At any nanosecond: events do not wait for a record.
void add_presses(const SpecItem& item, double from_s, Plan& plan) {
    item.expect_arguments(2, 3);
    const auto channel = static_cast<std::uint16_t>(item.whole(0, 0, 65535));
    const double s = item.number(1, 1e-6, longest_s);
    const long count = item.arguments.size() > 2 ? item.whole(2, 1, 100000) : 1;
    std::vector<std::int64_t> times;
    for (long i = 0; i < 2 * count; ++i)
        times.push_back(
            static_cast<std::int64_t>(plan.press_times.uniform(from_s, from_s + s) * 1e9));
    std::sort(times.begin(), times.end());
    for (std::size_t i = 0; i < times.size(); ++i)
        plan.presses.push_back({times[i], channel, static_cast<std::uint16_t>(1 - i % 2), 0});
}

bool add_event(const SpecItem& item, Plan& plan) {
    const double now_s = plan.motion.duration_s();
    if (item.name == "gap") {
        item.expect_arguments(1, 1);
        plan.events.push_back({now_s, now_s + item.number(0, 0, longest_s), 0});
    } else if (item.name == "press") {
        add_presses(item, now_s, plan);
    } else if (plan.model.is_imu && (item.name == "lose" || item.name == "dropouts")) {
        item.refuse("an IMU has no channels of a pose to lose");
    } else if (item.name == "dropouts") {
        add_dropouts(item, now_s, plan);
    } else if (item.name == "lose") {
        item.expect_arguments(2, 2);
        plan.events.push_back(
            {now_s, now_s + item.number(1, 0, longest_s), channel_named(item.arguments[0], item)});
    } else {
        return false;
    }
    return true;
}

Plan make_plan(const std::string& spec, std::uint64_t seed) {
    const auto items = parse_spec(spec);
    Plan plan{
        sensor_models()[1],  0, 0, {}, {}, Random{seed ^ 0x7072657373u}, Random{seed ^ 0x64726F70u},
        Motion{Random{seed}}};
    std::vector<const SpecItem*> motions;
    for (const SpecItem& item : items) {  // settings first: they hold for the whole recording
        if (item.name == "model") {
            item.expect_arguments(1, 1);
            plan.model = model_named(item.arguments[0], item);
        } else if (item.name == "rate") {
            item.expect_arguments(1, 1);
            plan.rate_hz = item.number(0, 0.1, 100000);
        } else if (item.name == "jitter") {
            item.expect_arguments(1, 1);
            plan.jitter_s = item.number(0, 0, 1e6) * 1e-6;
        } else {
            motions.push_back(&item);
        }
    }
    if (plan.rate_hz <= 0) plan.rate_hz = plan.model.rate_hz();
    if (plan.jitter_s * plan.rate_hz > 0.45)
        throw BadSpec("jitter of more than 0.45 periods would swap records");
    for (const SpecItem* item : motions)
        if (!add_motion(*item, plan.motion) && !add_event(*item, plan))
            item->refuse("unknown item; see fairlead-sim generate --help");
    std::stable_sort(plan.presses.begin(), plan.presses.end(),
                     [](const Event& a, const Event& b) { return a.t_ns < b.t_ns; });
    const double records = plan.motion.duration_s() * plan.rate_hz;
    if (!(records >= 1)) throw BadSpec("'" + spec + "' has no motion of at least one record");
    if (records > 1e8) throw BadSpec("'" + spec + "' is longer than 10^8 records");
    return plan;
}

/// Flags that the events take away at t; empty where there is no record.
std::optional<std::uint32_t> lost_at(const std::vector<Span>& events, double t_s) {
    std::uint32_t lost = 0;
    for (const Span& event : events) {
        if (!event.holds(t_s)) continue;
        if (event.lost == 0) return {};
        lost |= event.lost;
    }
    return lost;
}

void lose(Pose& pose, std::uint32_t channels) {
    pose.flags &= ~channels;
    if ((channels & flag::position_valid) != 0) pose.p_w_m = {};
    if ((channels & flag::orientation_valid) != 0) pose.q_wb = {};
}

}  // namespace

Recording generate(const std::string& spec, std::uint64_t seed) {
    const Plan plan = make_plan(spec, seed);
    Random times{seed ^ 0x74696D6573u};  // streams of their own: a gap changes no later noise
    TrackerSensor tracker{plan.model.tracker, Random{seed ^ 0x747261636Bu}};
    ImuSensor imu{plan.model.imu, plan.rate_hz, Random{seed ^ 0x696D75u}};
    Recording recording;
    recording.name = "generated";
    recording.format = plan.model.is_imu ? Format::imu : Format::trk;
    recording.period_s = 1 / plan.rate_hz;
    recording.events = plan.presses;
    const auto count = static_cast<std::int64_t>(plan.motion.duration_s() * plan.rate_hz + 0.5);
    Progress progress{"generate", static_cast<std::size_t>(count)};
    for (std::int64_t i = 0; i < count; ++i) {
        progress.show(static_cast<std::size_t>(i));
        const double even_s = (static_cast<double>(i) + 0.5) / plan.rate_hz;
        const double late_s = times.uniform(-plan.jitter_s, plan.jitter_s);
        const auto t_us = static_cast<std::int64_t>((even_s + late_s) * 1e6 + 0.5);
        const double t_s = static_cast<double>(t_us) * 1e-6;
        const MotionState truth = plan.motion.at(t_s);
        Pose pose = tracker.measure(truth, t_us * 1000);
        const Sample sample = imu.measure(truth, t_us * 1000);
        const auto lost = lost_at(plan.events, t_s);
        if (!lost) continue;
        recording.truth.push_back(to_pose(truth, t_us * 1000));
        recording.moving.push_back(truth.moving ? 1 : 0);
        if (plan.model.is_imu) {
            recording.samples.push_back(sample);
        } else {
            lose(pose, *lost);
            recording.poses.push_back(pose);
        }
    }
    if (recording.size() == 0) throw BadSpec("'" + spec + "' leaves no record");
    return recording;
}

}  // namespace fairlead::sim
