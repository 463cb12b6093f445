#include "host_sim/recording/imu2.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/recording/bytes.hpp"

namespace fairlead::sim {
namespace {

constexpr std::uint32_t all_fields = 63;
constexpr std::size_t head_size = 12;  // of a record: time and flags
constexpr std::size_t name_offset = 56, name_size = 72;

/// Flags of a record.
namespace bit {
constexpr std::uint32_t gyro_clipped = 1u << 8, accel_clipped = 1u << 9, mag_clipped = 1u << 10;
constexpr std::uint32_t gap = 1u << 11, moving = 1u << 12, event = 1u << 31;
constexpr std::uint32_t known =
    all_fields | gyro_clipped | accel_clipped | mag_clipped | gap | moving | event;
}  // namespace bit

struct Pair {
    std::uint32_t flag, bit;
};
constexpr Pair sample_bits[] = {
    {flag::gyro_valid, imu_field::gyro},     {flag::accel_valid, imu_field::accel},
    {flag::mag_valid, imu_field::mag},       {flag::temperature_valid, imu_field::temperature},
    {flag::gyro_clipped, bit::gyro_clipped}, {flag::accel_clipped, bit::accel_clipped},
    {flag::mag_clipped, bit::mag_clipped},   {flag::gap_before, bit::gap}};

std::uint64_t time_of(std::int64_t t_ns) {
    if (t_ns < 0)
        throw BadData("a time before zero (" + std::to_string(t_ns) +
                      " ns), which .imu does not have; write .csv");
    return static_cast<std::uint64_t>(t_ns);
}

bool is_amount(double value) { return std::isfinite(value) && value >= 0; }

Imu2Header parse_header(std::string_view bytes, Recording& recording) {
    if (bytes.size() < Imu2Header::size) refuse_at(bytes.size(), "the header of 128 bytes is cut");
    if (const auto size = load<std::uint32_t>(bytes, 8); size != Imu2Header::size)
        refuse_at(8, "a header of " + std::to_string(size) + " bytes, expected 128");
    Imu2Header header;
    header.count = load<std::uint64_t>(bytes, 16);
    header.fields = load<std::uint32_t>(bytes, 24);
    if ((header.fields & ~all_fields) != 0)
        refuse_at(24, "unknown fields, bits " + std::to_string(header.fields & ~all_fields));
    const std::size_t expected = imu2_record_size(header.fields);
    if (const auto size = load<std::uint32_t>(bytes, 12); size != expected)
        refuse_at(12, "records of " + std::to_string(size) + " bytes, expected " +
                          std::to_string(expected) + " for these fields");
    const auto frame = load<std::uint32_t>(bytes, 28);
    const bool reference = (header.fields & imu_field::reference_orientation) != 0;
    if (frame > 2) refuse_at(28, "frame " + std::to_string(frame) + " is not known");
    if ((frame != 0) != reference)
        refuse_at(28, reference ? "a reference orientation without its frame"
                                : "a frame without a reference orientation");
    header.frame = static_cast<ReferenceFrame>(frame);
    header.rate_hz = load<double>(bytes, 32);
    if (!is_amount(header.rate_hz)) refuse_at(32, "the rate is not a positive number or zero");
    header.full_scale = load_vec3(bytes, 40);
    const float scales[] = {header.full_scale.x, header.full_scale.y, header.full_scale.z};
    for (std::size_t i = 0; i < 3; ++i)
        if (!is_amount(static_cast<double>(scales[i])))
            refuse_at(40 + 4 * i, "the full scale is not a positive number or zero");
    if (load<std::uint32_t>(bytes, 52) != 0) refuse_at(52, "expected zero");
    const std::string_view name = bytes.substr(name_offset, name_size);
    if (const auto end = name.find('\0'); end == std::string_view::npos)
        refuse_at(name_offset, "the name does not end with a zero");
    else if (end != 0)
        recording.name = name.substr(0, end);
    return header;
}

void parse_event(std::string_view record, std::size_t offset, std::int64_t t_ns,
                 std::uint32_t flags, Recording& recording) {
    if ((flags & ~(bit::event | bit::gap)) != 0)
        refuse_at(offset + 8, "an event with flags of a sample");
    const std::string_view rest = record.substr(head_size + 4);
    if (rest.find_first_not_of('\0') != std::string_view::npos)
        refuse_at(offset + head_size + 4, "an event with more than channel and value");
    Event event;
    event.t_ns = t_ns;
    event.channel = load<std::uint16_t>(record, head_size);
    event.value = load<std::uint16_t>(record, head_size + 2);
    if ((flags & bit::gap) != 0) event.flags = flag::gap_before;
    recording.events.push_back(event);
}

void parse_sample(std::string_view record, std::uint32_t fields, std::int64_t t_ns,
                  std::uint32_t flags, Recording& recording) {
    Sample s;
    s.t_ns = t_ns;
    for (const Pair& p : sample_bits)
        if ((flags & p.bit) != 0) s.flags |= p.flag;
    if ((flags & (bit::gyro_clipped | bit::accel_clipped | bit::mag_clipped)) != 0)
        s.flags |= flag::clipped;
    Pose truth;
    truth.t_ns = t_ns;
    std::size_t at = head_size;
    // a field that is not valid is never read
    const auto next = [&](std::uint32_t field, std::size_t size) {
        const std::size_t here = at;
        if ((fields & field) != 0) at += size;
        return (fields & flags & field) != 0 ? here : 0;
    };
    if (const auto i = next(imu_field::gyro, 12)) s.gyro_rad_s = load_vec3(record, i);
    if (const auto i = next(imu_field::accel, 12)) s.accel_m_s2 = load_vec3(record, i);
    if (const auto i = next(imu_field::mag, 12)) s.mag_uT = load_vec3(record, i);
    if (const auto i = next(imu_field::temperature, 4)) s.temperature_c = load<float>(record, i);
    if (const auto i = next(imu_field::reference_orientation, 16)) {
        truth.q_wb = load_quat(record, i);
        truth.flags |= flag::orientation_valid;
    }
    if (const auto i = next(imu_field::reference_position, 12)) {
        truth.p_w_m = load_vec3(record, i);
        truth.flags |= flag::position_valid;
    }
    recording.samples.push_back(s);
    recording.truth.push_back(truth);
    recording.moving.push_back((flags & bit::moving) != 0 ? 1 : 0);
}

void parse_record(std::string_view record, std::size_t offset, std::uint32_t fields,
                  Recording& recording) {
    const auto time = load<std::uint64_t>(record, 0);
    if (time >> 63 != 0) refuse_at(offset, "a time of 2^63 ns or more");
    const auto flags = load<std::uint32_t>(record, 8);
    if ((flags & ~bit::known) != 0)
        refuse_at(offset + 8, "unknown flags, bits " + std::to_string(flags & ~bit::known));
    const auto t_ns = static_cast<std::int64_t>(time);
    if ((flags & bit::event) != 0) return parse_event(record, offset, t_ns, flags, recording);
    if ((flags & all_fields & ~fields) != 0)
        refuse_at(offset + 8, "a measurement of a sensor that the header does not name");
    parse_sample(record, fields, t_ns, flags, recording);
}

}  // namespace

std::size_t imu2_record_size(std::uint32_t fields) {
    constexpr std::size_t sizes[] = {12, 12, 12, 4, 16, 12};
    std::size_t size = head_size;
    for (std::size_t i = 0; i < 6; ++i)
        if ((fields >> i & 1u) != 0) size += sizes[i];
    return std::max<std::size_t>(size, 16);
}

std::string imu2_header(const Imu2Header& header) {
    std::string out = "IMR1";
    store(out, std::uint32_t{2});
    store(out, static_cast<std::uint32_t>(Imu2Header::size));
    store(out, static_cast<std::uint32_t>(imu2_record_size(header.fields)));
    store(out, header.count);
    store(out, header.fields);
    const bool reference = (header.fields & imu_field::reference_orientation) != 0;
    store(out, static_cast<std::uint32_t>(reference ? header.frame : ReferenceFrame::none));
    store(out, header.rate_hz);
    store(out, header.full_scale);
    store(out, std::uint32_t{0});
    store_name(out, header.name, name_size);
    return out;
}

void append_imu2(std::string& out, std::uint32_t fields, const Sample& sample,
                 const Pose& reference, bool moving) {
    std::uint32_t flags = moving ? bit::moving : 0;
    for (const Pair& p : sample_bits)
        if ((sample.flags & p.flag) != 0) flags |= p.bit;
    if ((reference.flags & flag::orientation_valid) != 0) flags |= imu_field::reference_orientation;
    if ((reference.flags & flag::position_valid) != 0) flags |= imu_field::reference_position;
    flags &= fields | ~all_fields;
    const auto valid = [&](std::uint32_t field) { return (flags & field) != 0; };
    const std::size_t start = out.size();
    store(out, time_of(sample.t_ns));
    store(out, flags);
    const auto vector = [&](std::uint32_t field, const Vec3& v) {
        if ((fields & field) != 0) store(out, valid(field) ? v : Vec3{});
    };
    vector(imu_field::gyro, sample.gyro_rad_s);
    vector(imu_field::accel, sample.accel_m_s2);
    vector(imu_field::mag, sample.mag_uT);
    if ((fields & imu_field::temperature) != 0)
        store(out, valid(imu_field::temperature) ? sample.temperature_c : 0.0f);
    if ((fields & imu_field::reference_orientation) != 0)
        store(out, valid(imu_field::reference_orientation) ? reference.q_wb : Quat{0, 0, 0, 0});
    vector(imu_field::reference_position, reference.p_w_m);
    out.resize(start + imu2_record_size(fields));
}

void append_imu2(std::string& out, std::uint32_t fields, const Event& event) {
    const std::size_t start = out.size();
    store(out, time_of(event.t_ns));
    store(out, bit::event | ((event.flags & flag::gap_before) != 0 ? bit::gap : 0));
    store(out, event.channel);
    store(out, event.value);
    out.resize(start + imu2_record_size(fields));
}

std::uint32_t imu_fields(const Recording& recording) {
    std::uint32_t fields = 0;
    for (const Sample& s : recording.samples)
        for (const Pair& p : sample_bits)
            if ((s.flags & p.flag) != 0) fields |= p.bit & all_fields;
    for (const Pose& pose : recording.truth) {
        if ((pose.flags & flag::orientation_valid) != 0) fields |= imu_field::reference_orientation;
        if ((pose.flags & flag::position_valid) != 0) fields |= imu_field::reference_position;
    }
    return fields;
}

std::string to_imu2(const Recording& recording) {
    Imu2Header header;
    header.name = recording.name;
    header.count = recording.samples.size() + recording.events.size();
    header.fields = imu_fields(recording);
    header.frame =
        recording.frame == ReferenceFrame::none ? ReferenceFrame::level : recording.frame;
    header.rate_hz = recording.period_s > 0 ? 1 / recording.period_s : 0;
    header.full_scale = recording.full_scale;
    std::string out = imu2_header(header);
    std::size_t next = 0;
    for (std::size_t i = 0; i < recording.samples.size(); ++i) {
        const Sample& s = recording.samples[i];
        for (; next < recording.events.size() && recording.events[next].t_ns <= s.t_ns; ++next)
            append_imu2(out, header.fields, recording.events[next]);
        append_imu2(out, header.fields, s, i < recording.truth.size() ? recording.truth[i] : Pose{},
                    i < recording.moving.size() && recording.moving[i] != 0);
    }
    for (; next < recording.events.size(); ++next)
        append_imu2(out, header.fields, recording.events[next]);
    return out;
}

void parse_imu2(std::string_view bytes, Recording& recording, const Steps& progress) {
    const Imu2Header header = parse_header(bytes, recording);
    recording.format = Format::imu;
    recording.version2 = true;
    recording.frame = header.frame;
    recording.full_scale = header.full_scale;
    if (header.rate_hz > 0) recording.period_s = 1 / header.rate_hz;
    const std::size_t size = imu2_record_size(header.fields);
    const bool open = header.count == Imu2Header::open;
    std::size_t offset = Imu2Header::size;
    for (std::uint64_t i = 0; open ? offset < bytes.size() : i < header.count; ++i) {
        if (bytes.size() - offset < size)
            refuse_at(offset, "record " + std::to_string(i) +
                                  (open ? "" : " of " + std::to_string(header.count)) +
                                  " is cut or missing: the file has " +
                                  std::to_string(bytes.size()) + " bytes, expected " +
                                  (open ? "whole records of " + std::to_string(size)
                                        : "128 + " + std::to_string(header.count) + " * " +
                                              std::to_string(size)));
        if (progress && i % 4096 == 0) progress(offset, bytes.size());
        parse_record(bytes.substr(offset, size), offset, header.fields, recording);
        offset += size;
    }
    if (bytes.size() != offset)
        refuse_at(offset, "bytes after the last record: the file has " +
                              std::to_string(bytes.size()) + " bytes, expected " +
                              std::to_string(offset));
    const std::uint32_t reference =
        imu_field::reference_orientation | imu_field::reference_position;
    const bool moving = std::any_of(recording.moving.begin(), recording.moving.end(),
                                    [](std::uint8_t m) { return m != 0; });
    if ((header.fields & reference) == 0 && !moving) {
        recording.truth.clear();
        recording.moving.clear();
    }
}

}  // namespace fairlead::sim
