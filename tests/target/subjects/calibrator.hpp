#pragma once
#include "fairlead/sense/calibrate.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text =
        "Calibrator: offset, 3 x 3, temperature and mounting of each";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = true;
    static constexpr bool takes_anything = false;
    using Output = fairlead::Sample;
    fairlead::Calibrator stage{example()};

    static fairlead::Calibration example() {
        fairlead::Calibration c;
        c.gyro.offset = {0.01f, -0.02f, 0.005f};
        c.accel = {{0.1f, -0.2f, 0.3f},
                   {{1.01f, 0.002f, 0}, {-0.003f, 0.99f, 0.004f}, {0, 0, 1.02f}}};
        c.mag = {{12, -7, 30}, {{0.9f, 0.02f, 0.01f}, {0.02f, 1.1f, 0}, {0.01f, 0, 1}}};
        c.gyro_offset_per_K = {1e-4f, -2e-4f, 3e-4f};
        c.q_bs = {0.5f, 0.5f, -0.5f, 0.5f};
        return c;
    }

    std::optional<Output> push(const fairlead::target::Record& in) {
        return stage(in.sample, 31.5f);
    }
    std::optional<Output> flush() { return std::nullopt; }
};
