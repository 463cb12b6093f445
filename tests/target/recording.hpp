#pragma once
// Reads .imu and .trk recordings one record at a time (docs/formats.md), in a few hundred bytes of
// memory: the reader for a core. The host simulator has its own, for more formats.
#include "tests/target/platform.hpp"
#include "tests/target/subject.hpp"

namespace fairlead::target {

class RecordingReader {
  public:
    /// False where the file is missing or is neither.
    bool open(const char* path) noexcept {
        file_ = platform::open_to_read(path);
        if (file_ < 0) return false;
        std::uint32_t header[16]{};
        if (platform::read(file_, header, sizeof header) != sizeof header) return false;
        constexpr std::uint32_t imu = 0x31524D49, trk = 0x314B5254;  // "IMR1", "TRK1"
        samples_ = header[0] == imu;
        left_ = header[2];
        return (samples_ && header[3] == sizeof(Imu)) ||
               (header[0] == trk && header[3] == sizeof(Trk));
    }
    void close() noexcept { platform::close(file_); }

    bool has_samples() const noexcept { return samples_; }

    bool next(Record& record) noexcept {
        if (left_ == 0) return false;
        --left_;
        record = {};
        return samples_ ? next_imu(record) : next_trk(record);
    }

  private:
    struct Imu {
        std::uint32_t t_us, flags;
        Vec3 gyro, accel, mag;
        Quat ref_q;
        Vec3 ref_p;
    };
    struct Trk {
        std::uint32_t t_us, valid;
        Vec3 p;
        Quat q;
    };

    bool next_imu(Record& record) noexcept {
        Imu imu{};
        if (platform::read(file_, &imu, sizeof imu) != sizeof imu) return false;
        Sample& s = record.sample;
        s.t_ns = std::int64_t{1000} * imu.t_us;
        s.gyro_rad_s = imu.gyro;
        s.accel_m_s2 = imu.accel;
        s.mag_uT = imu.mag;
        s.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
        return true;
    }
    bool next_trk(Record& record) noexcept {
        Trk trk{};
        if (platform::read(file_, &trk, sizeof trk) != sizeof trk) return false;
        Pose& p = record.pose;
        p.t_ns = std::int64_t{1000} * trk.t_us;
        if ((trk.valid & 1) != 0) {
            p.q_wb = trk.q;
            p.flags |= flag::orientation_valid;
        }
        if ((trk.valid & 2) != 0) {
            p.p_w_m = trk.p;
            p.flags |= flag::position_valid;
        }
        return true;
    }

    int file_{-1};
    bool samples_{false};
    std::uint32_t left_{0};
};

}  // namespace fairlead::target
