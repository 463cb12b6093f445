#pragma once
// What the errors are measured on: the calm streams of streams/adverse, a stage's output for them,
// and the largest distance from what it should have been.
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "tests/ref/rotation.hpp"
#include "tests/target/stream.hpp"

namespace fairlead::target {

using Records = std::vector<Record>;

/// Motions without gaps, bad input or half turns: a reference of the whole sequence exists.
inline std::vector<Records> calm_streams() {
    std::vector<Records> streams;
    std::ifstream file{"tests/target/streams/adverse"};
    for (std::string line; std::getline(file, line);) {
        static Recipe recipe;
        const std::string name = line.substr(0, line.find(' '));
        if (name != "hand-motion" && name != "rest-and-go" && name != "straight") continue;
        if (!parse(line.c_str(), recipe)) continue;
        Generator generator{recipe};
        Records records;
        for (Record record; generator.next(record, false);) records.push_back(record);
        streams.push_back(records);
    }
    return streams;
}

/// All that a stage gives for a stream, its flush included.
template <class Subject>
auto all_of(Subject subject, const Records& records) {
    std::vector<typename Subject::Output> outputs;
    for (const Record& record : records)
        if (const auto out = subject.push(record)) outputs.push_back(*out);
    while (const auto out = subject.flush()) outputs.push_back(*out);
    return outputs;
}

inline std::vector<ref::V> positions_of(const Records& records) {
    std::vector<ref::V> all;
    for (const Record& r : records) all.push_back(ref::of(r.pose.p_w_m));
    return all;
}
inline std::vector<ref::Q> orientations_of(const Records& records) {
    std::vector<ref::Q> all;
    for (const Record& r : records) all.push_back(ref::unit(ref::of(r.pose.q_wb)));
    return all;
}

class Largest {
  public:
    void number(double distance) { see(number_, distance); }
    void position(const Vec3& p, const ref::V& truth) { see(m_, norm(ref::of(p) - truth)); }
    void orientation(const Quat& q, const ref::Q& truth) {
        angle(ref::angle(ref::unit(ref::of(q)), truth));
    }
    void angle(double rad) { see(rad_, rad); }
    void pose(const Pose& pose, const ref::V& p, const ref::Q& q) {
        position(pose.p_w_m, p);
        orientation(pose.q_wb, q);
    }
    double m() const { return m_; }
    double rad() const { return rad_; }

    /// "1.2e-07", "3.4e-06 m, 5.6e-07 rad": what was seen.
    std::string text() const {
        std::string all;
        const auto add = [&all](double value, const char* unit) {
            if (value < 0) return;
            char cell[40];
            std::snprintf(cell, sizeof cell, "%s%.1e%s", all.empty() ? "" : ", ", value, unit);
            all += cell;
        };
        add(number_, "");
        add(m_, " m");
        add(rad_, " rad");
        return all;
    }

  private:
    static void see(double& most, double value) { most = value <= most ? most : value; }
    double number_{-1}, m_{-1}, rad_{-1};  // below zero: not seen
};

}  // namespace fairlead::target
