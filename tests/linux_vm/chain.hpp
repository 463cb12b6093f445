#pragma once
// From accepted samples to the bytes of the stream: the same type in the machine and on the host.
#include <vector>

#include "fairlead/pipeline.hpp"

namespace fairlead::vm {

class Chain {
  public:
    void push(const Sample& sample, std::vector<std::uint8_t>& out) {
        append(pipeline_.push(sample), out);
    }
    void flush(std::vector<std::uint8_t>& out) {
        for (Bytes bytes; bytes.status != Status::end;) append(bytes = pipeline_.flush(), out);
    }

  private:
    struct Board {
        using Input = Imu<AttitudeMode::imu>;
        using Channels = fairlead::Channels<Orientation>;
        using Filter = NoFilter;
        static constexpr std::size_t delay_records_max = 64;
        static constexpr Beam beam = Beam::medium;
        static constexpr std::size_t events_max = 0;
    };
    static void append(const Bytes& bytes, std::vector<std::uint8_t>& out) {
        out.insert(out.end(), bytes.begin(), bytes.end());
    }

    Pipeline<Board> pipeline_{{}};
};

}  // namespace fairlead::vm
