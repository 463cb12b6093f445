#pragma once
// Will it meet its deadlines on the board? Answered on the host, before there is a board: a
// recording is replayed through the pipeline, every push is charged the instructions that BOUNDS.md
// (or a count trace) gives for it, and a deterministic scheduler plays sensor, core and wire. No
// wall clock: the same input gives the same answer on every machine. docs/bounds.md has an example.
//
// The model: a sensor stamps a record at its time; the interrupt puts it into a queue up to jitter
// later; one task takes records in order, each for instructions x cycles per instruction / clock;
// the bytes of a push go to the wire's buffer when the push ends and leave at the wire's speed.
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace fairlead::sim {

struct TimingModel {
    double core_hz{168e6};
    double cycles_per_instruction_min{1.0};  // of the core and its memory: measure it once, on the
    double cycles_per_instruction_max{1.7};  // board, over your own code
    double interrupt_jitter_s{0};            // at most, from the sensor's stamp to the queue
    std::size_t queue_capacity{4};           // records, the one in work not counted
    double wire_bytes_per_s{11520};          // 115200 baud, 8N1
    std::size_t wire_capacity{512};          // bytes that may wait for the wire
    double push_budget_s{1e-3};              // one push, by itself
    double response_budget_s{10e-3};         // from the sensor's stamp to the end of its push
    std::uint32_t seed{1};                   // of the jitter
    std::size_t messages_max{10};            // failures told in words; all are counted
};

/// One push: when its record was stamped, what the push costs, how many bytes it sends.
struct TimedPush {
    std::int64_t t_ns{};
    std::uint64_t instructions{};
    std::size_t bytes{};
};

struct TimingReport {
    std::size_t pushes{}, failures{};
    std::size_t dearest_push{};  // index
    double push_min_s{}, push_max_s{};
    double response_max_s{};
    std::size_t queue_max{};          // records waiting
    std::size_t wire_max{};           // bytes waiting
    double wire_delay_max_s{};        // from the end of a push to its last byte on the wire
    double core_load{}, wire_load{};  // shares of the time that the recording takes
    std::vector<std::string> messages;

    bool ok() const { return failures == 0; }
    std::string text() const;  // the messages, or one line of figures
};

TimingReport play(const TimingModel& model, const std::vector<TimedPush>& pushes);

/// A row of BOUNDS.md.
struct StageBound {
    std::uint64_t flash{}, ram{}, stack_used{}, stack_bound{};
    std::uint64_t min{}, mean{}, worst_found{}, bound{}, any_operands{}, flush_worst{};
};
/// All stages of one core, by name ("Cortex-M4F"). Throws BadData where the file has no such core.
std::map<std::string, StageBound> read_bounds(const std::string& path, const std::string& core);

/// Instructions of every push, as the counting plugin wrote them. Throws BadData.
std::vector<std::uint32_t> read_counts(const std::string& path);

/// Replays records through a pipeline. cost(i) is the instructions of push i. Flushes are left out:
/// they run when the recording is over and nothing waits for them.
template <class Pipeline, class Records, class Cost>
std::vector<TimedPush> replay(Pipeline& pipeline, const Records& records, const Cost& cost) {
    std::vector<TimedPush> pushes;
    for (const auto& record : records) {
        const std::size_t bytes = pipeline.push(record).size;
        pushes.push_back({record.t_ns, cost(pushes.size()), bytes});
    }
    return pushes;
}

}  // namespace fairlead::sim
