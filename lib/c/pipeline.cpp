// The pipeline of the configuration, for C.
#include "lib/c/objects.hpp"

using namespace fairlead::c;
using fairlead::Status;

namespace {

/// Parameters for C over those of the configuration.
BoardPipeline::Params params_of(const fairlead_pipeline_params* params) noexcept {
    BoardPipeline::Params out = Config::params();
    if (params != nullptr) join_params(*params, out, ToCpp{});
    return out;
}

template <class Record>
fairlead_bytes push(fairlead_pipeline* pipeline, const Record* in) noexcept {
    auto* const cell = find<PipelineCell>(pipeline);
    if (cell == nullptr || in == nullptr) {
        const bool closed = cell == nullptr && pipeline != nullptr;
        return {nullptr, 0, closed ? FAIRLEAD_CLOSED : FAIRLEAD_BAD_ARGUMENT};
    }
    return bytes_of(cell->value.push(to_cpp(*in)));
}

template <class Call>
fairlead_bytes call(fairlead_pipeline* pipeline, Call&& act) noexcept {
    auto* const cell = find<PipelineCell>(pipeline);
    if (cell == nullptr) return {nullptr, 0, missing(pipeline)};
    return bytes_of(act(cell->value));
}

template <class Record, class Get>
fairlead_status give(const fairlead_pipeline* pipeline, Record* out, Get&& get) noexcept {
    const auto* const cell = find<PipelineCell>(pipeline);
    if (cell == nullptr) return missing(pipeline);
    if (out == nullptr) return FAIRLEAD_BAD_ARGUMENT;
    const auto& record = get(cell->value);
    if (!record) return FAIRLEAD_NOT_FOUND;
    to_c(*out, *record);
    return FAIRLEAD_OK;
}

constexpr auto filtered = [](const BoardPipeline& p) noexcept -> auto& { return p.filtered(); };

}  // namespace

extern "C" {

void fairlead_pipeline_defaults(fairlead_pipeline_params* params) {
    if (params == nullptr) return;
    *params = {};
    const BoardPipeline::Params from = Config::params();
    join_params(*params, from, ToC{});
}

fairlead_status fairlead_pipeline_init(fairlead_pipeline* pipeline, size_t size,
                                       const fairlead_pipeline_params* params) {
    if (!fits(pipeline, size)) return FAIRLEAD_BAD_ARGUMENT;
    return code(make<PipelineCell>(pipeline, params_of(params))->value.check().status);
}

const char* fairlead_pipeline_refused_field(const fairlead_pipeline* pipeline) {
    const auto* const cell = find<PipelineCell>(pipeline);
    return cell == nullptr ? nullptr : cell->value.check().field;
}

#if FAIRLEAD_TAKES_POSES
fairlead_bytes fairlead_pipeline_push_pose(fairlead_pipeline* pipeline, const fairlead_pose* pose) {
    return push(pipeline, pose);
}
#endif
#if FAIRLEAD_TAKES_SAMPLES
fairlead_bytes fairlead_pipeline_push_sample(fairlead_pipeline* pipeline,
                                             const fairlead_sample* sample) {
    return push(pipeline, sample);
}
#endif
#if FAIRLEAD_TAKES_VECTORS
fairlead_bytes fairlead_pipeline_push_vector(fairlead_pipeline* pipeline,
                                             const fairlead_vector* vector) {
    return push(pipeline, vector);
}
#endif

fairlead_status fairlead_pipeline_push_event(fairlead_pipeline* pipeline,
                                             const fairlead_event* event) {
    auto* const cell = find<PipelineCell>(pipeline);
    if (cell == nullptr) return missing(pipeline);
    if (event == nullptr || !cell->value.check()) return FAIRLEAD_BAD_ARGUMENT;
    return cell->value.push_event(to_cpp(*event)) ? FAIRLEAD_OK : FAIRLEAD_OVERRUN;
}

fairlead_bytes fairlead_pipeline_idle(fairlead_pipeline* pipeline) {
    return call(pipeline, [](BoardPipeline& p) noexcept { return p.idle(); });
}
fairlead_bytes fairlead_pipeline_flush(fairlead_pipeline* pipeline) {
    return call(pipeline, [](BoardPipeline& p) noexcept { return p.flush(); });
}
fairlead_status fairlead_pipeline_reset(fairlead_pipeline* pipeline) {
    auto* const cell = find<PipelineCell>(pipeline);
    if (cell == nullptr) return missing(pipeline);
    cell->value.reset();
    return code(cell->value.check().status);
}

#if FAIRLEAD_TAKES_VECTORS
fairlead_status fairlead_pipeline_filtered(const fairlead_pipeline* pipeline,
                                           fairlead_vector* out) {
    return give(pipeline, out, filtered);
}
#else
fairlead_status fairlead_pipeline_pose(const fairlead_pipeline* pipeline, fairlead_pose* out) {
    return give(
        pipeline, out, [](const BoardPipeline& p) noexcept -> auto& { return p.pose(); });
}
fairlead_status fairlead_pipeline_filtered(const fairlead_pipeline* pipeline, fairlead_pose* out) {
    return give(pipeline, out, filtered);
}
#endif

fairlead_status fairlead_pipeline_count(const fairlead_pipeline* pipeline,
                                        fairlead_pipeline_statistics* out) {
    const auto* const cell = find<PipelineCell>(pipeline);
    if (cell == nullptr) return missing(pipeline);
    if (out == nullptr) return FAIRLEAD_BAD_ARGUMENT;
    const auto& encoder = cell->value.encoder().inner();
    *out = {};
    out->faults = faults_of(cell->value.intake().faults());
    out->sample_period_ns = cell->value.sample_period_ns();
    out->frames = encoder.frames();
    out->restarts = encoder.restarts();
    out->refused_events = encoder.refused_events();
    out->given_up = encoder.given_up();
    out->run = encoder.run();
    return FAIRLEAD_OK;
}
}
