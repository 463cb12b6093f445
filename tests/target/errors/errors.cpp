// How far each stage's output may be from what it should have been, one line a stage: its name, a
// tab, the figures. On the host alone: the same bits carry them to every core.
#include "tests/target/errors/curves.hpp"
#include "tests/target/errors/smoothing.hpp"

int main() {
    using namespace fairlead::target;
    const auto streams = calm_streams();
    if (streams.size() != 3) {
        std::fputs("errors: the calm streams are missing\n", stderr);
        return 2;
    }
    const auto say = [](const char* stage, const std::string& text) {
        std::printf("%s\t%s\n", stage, text.c_str());
    };
    say("approx", approx_error(streams).text());
    say("quat", quat_error(streams).text());
    say("bspline", bspline_error(streams).text());
    say("bspline_orientation", bspline_orientation_error(streams).text());
    say("calibrator", calibrator_error(streams).text());
    say("attitude", attitude_error<fairlead::AttitudeMode::imu_mag>(streams).text());
    say("attitude_imu", attitude_error<fairlead::AttitudeMode::imu>(streams).text());

    const auto centred = taps_of(fairlead::binomial_mask<9>());
    const auto causal = taps_of(fairlead::causal_savitzky_golay_mask<9, 1>());
    const auto smoothing = taps_of(fairlead::smoothing_mask(1));
    say("filter_9", against<filter_stage::Subject>(streams, centred, 4).text());
    say("filter_causal_9", against<filter_causal_stage::Subject>(streams, causal, 8).text());
    say("cascade_5x4", against<cascade_stage::Subject>(streams, smoothing, 2, 4).text());
    const auto adaptive = adaptive_errors(streams);
    say("adaptive", adaptive.filter.text());
    say("predict", adaptive.predicted.text());
    say("fairing_2x4", fairing_error<fairing_2_stage::Subject>(streams).text());
    say("fairing_3x4", fairing_error<fairing_3_stage::Subject>(streams).text());
    say("strain_16", strain_error(streams).text());

    constexpr auto narrow = fairlead::Beam::narrow, medium = fairlead::Beam::medium,
                   wide = fairlead::Beam::wide;
    bool kept = true;
    const auto say_reduced = [&](const char* stage, const Reduced& reduced) {
        say(stage, reduced.text());
        kept = kept && reduced.kept;
    };
    say_reduced("encode_position_120",
                encoder_error<EncoderStage<JustPosition, 120, medium>>(streams));
    say_reduced("encode_orientation_32",
                encoder_error<EncoderStage<JustOrientation, 32, medium>>(streams));
    say_reduced("encode_orientation_120",
                encoder_error<EncoderStage<JustOrientation, 120, medium>>(streams));
    say_reduced("encode_narrow_120", encoder_error<EncoderStage<Both, 120, narrow>>(streams));
    say_reduced("encode_medium_120", encoder_error<EncoderStage<Both, 120, medium>>(streams));
    say_reduced("encode_wide_120", encoder_error<EncoderStage<Both, 120, wide>>(streams));
    say_reduced("pipeline_32", pipeline_error(streams));
    return kept ? 0 : 1;
}
