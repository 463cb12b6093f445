#pragma once
// From accepted samples to the bytes of the stream: the same type in the machine and on the host.
#include <vector>

#include "fairlead/pipeline.hpp"
#include "fairlead/sense/attitude.hpp"

namespace fairlead::vm {

class Chain {
  public:
    void push(const Sample& sample, std::vector<std::uint8_t>& out) {
        if (const auto pose = attitude_.push(sample)) append(pipeline_.push(*pose), out);
    }
    void flush(std::vector<std::uint8_t>& out) {
        for (Bytes bytes = pipeline_.flush(); !bytes.empty(); bytes = pipeline_.flush())
            append(bytes, out);
    }

  private:
    static void append(const Bytes& bytes, std::vector<std::uint8_t>& out) {
        out.insert(out.end(), bytes.data, bytes.data + bytes.size);
    }
    static Pipeline<PipelineConfig>::Params params() {
        Pipeline<PipelineConfig>::Params p;
        p.encoder.tick_ns = 1000000;
        p.encoder.position = false;
        return p;
    }

    BasicAttitude<float, AttitudeMode::imu> attitude_;
    Pipeline<PipelineConfig> pipeline_{params()};
};

}  // namespace fairlead::vm
