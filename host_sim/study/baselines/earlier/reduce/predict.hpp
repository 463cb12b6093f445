#pragma once
// Where the signal is likely to go: a linear predictor per horizon, learned while the stream runs.
//
// x(i + h) - x(i) is predicted from x(i) - x(i - lag) for a few lags; one set of coefficients
// serves all components, so that the prediction turns with the signal. Recursive least squares in
// its normal form: forgetting, and weights 1 / (0.3 + error) against outliers. The predictions only
// steer the choice between plans that all keep the tolerance. Cost per push: about 370
// multiplications (D = 3).
#include <array>
#include <cstddef>
#include <cstdint>

#include "host_sim/study/baselines/earlier/reduce/plan.hpp"
#include "host_sim/study/baselines/earlier/reduce/window.hpp"

namespace fairlead::earlier {

/// The coefficients of one horizon. Rows of numbers are as long as the signal has components.
class LinearModel {
  public:
    static constexpr std::size_t lags = 6;

    /// Before anything is learned: the present velocity, fading.
    void start(float reach) noexcept {
        *this = {};
        for (std::size_t k = 0; k < lags; ++k) a_[packed(k, k)] = prior;
        const float tau = 12;
        c_[1] = tau * (1 - approx::exp(-reach / tau)) / 2;
        b_[1] = prior * c_[1];
        variance_ = reach * reach / 64;
    }

    /// y = c f: a row from a row per lag.
    void predict(const float* f, std::size_t size, float* y) const noexcept {
        for (std::size_t d = 0; d < size; ++d) y[d] = 0;
        for (std::size_t k = 0; k < lags; ++k)
            for (std::size_t d = 0; d < size; ++d) y[d] += c_[k] * f[k * size + d];
    }

    /// y is what came of f, `guess` what was predicted.
    void learn(const float* f, const float* y, const float* guess, std::size_t size) noexcept {
        float square = 0;
        for (auto& v : a_) v *= forgetting;
        for (auto& v : b_) v *= forgetting;
        for (std::size_t d = 0; d < size; ++d) {
            const float e = y[d] - guess[d];
            square += e * e;
            const float w = 1 / (0.3f + approx::absolute(e));
            for (std::size_t i = 0; i < lags; ++i) {
                const float wf = w * f[i * size + d];
                for (std::size_t j = 0; j <= i; ++j) a_[packed(i, j)] += wf * f[j * size + d];
                b_[i] += wf * y[d];
            }
        }
        square /= static_cast<float>(size);
        variance_ += 0.05f * ((square < 400 ? square : 400) - variance_);
    }

    /// c = a^-1 b by LDL^T, with a little of the identity for what has not moved yet.
    void solve() noexcept {
        auto l = a_;
        std::array<float, lags> pivot{};
        for (std::size_t i = 0; i < lags; ++i) {
            for (std::size_t j = 0; j <= i; ++j) {
                float sum = l[packed(i, j)];
                if (i == j) sum = sum * (1 + 1e-5f) + 1e-3f;
                for (std::size_t k = 0; k < j; ++k)
                    sum -= l[packed(i, k)] * l[packed(j, k)] * pivot[k];
                if (i == j)
                    pivot[i] = sum > 1e-6f ? sum : 1e-6f;
                else
                    l[packed(i, j)] = sum / pivot[j];
            }
        }
        for (std::size_t i = 0; i < lags; ++i) {
            c_[i] = b_[i];
            for (std::size_t k = 0; k < i; ++k) c_[i] -= l[packed(i, k)] * c_[k];
        }
        for (std::size_t i = 0; i < lags; ++i) c_[i] /= pivot[i];
        for (std::size_t i = lags; i-- > 0;)
            for (std::size_t k = i + 1; k < lags; ++k) c_[i] -= l[packed(k, i)] * c_[k];
    }

    float variance() const noexcept { return variance_; }

  private:
    static constexpr float prior = 1e-2f, forgetting = 0.9995f;
    static constexpr std::size_t packed(std::size_t i, std::size_t j) noexcept {
        return i * (i + 1) / 2 + j;
    }

    std::array<float, lags*(lags + 1) / 2> a_{};  // normal matrix, lower triangle by rows
    std::array<float, lags> b_{}, c_{};
    float variance_{0};
};

/// Two horizons, both short: farther ones were tried, and made streams longer rather than shorter.
template <class Channel>
class Predictor {
  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t horizons = 2;
    static constexpr std::array<std::uint8_t, horizons> horizon{5, 10};  // samples
    using Vector = std::array<float, D>;
    using Value = typename Channel::Value;

    void reset() noexcept {
        for (std::size_t h = 0; h < horizons; ++h) models_[h].start(horizon[h]);
        size_ = 0;
    }
    Predictor() noexcept { reset(); }

    /// A new sample of the curve; a new curve forgets the samples, not the model.
    void push(const Value& value, bool starts, const typename Channel::Judge& judge) noexcept {
        if (starts) size_ = 0;
        head_ = (head_ + 1) % history;
        values_[head_] = value;
        if (size_ < history) ++size_;
        for (std::size_t h = 0; h < horizons; ++h) learn(h, judge);
        if (++turn_ == 4) turn_ = 0;
    }

    using Change = std::array<Vector, horizons>;
    /// The expected changes from the newest sample to each horizon, in the sample's frame.
    Change changes(const typename Channel::Judge& judge) const noexcept {
        const Features f = features(0, judge);
        Change out;
        for (std::size_t h = 0; h < horizons; ++h) models_[h].predict(f.data(), D, out[h].data());
        return out;
    }
    float variance(std::size_t h) const noexcept { return models_[h].variance(); }

  private:
    static constexpr std::size_t lags = LinearModel::lags;
    static constexpr std::array<std::uint8_t, lags> lag{1, 2, 4, 8, 16, 32};
    static constexpr std::size_t history = horizon[horizons - 1] + lag[lags - 1] + 1;
    using Features = std::array<float, lags * D>;

    const Value& ago(std::size_t n) const noexcept {
        return values_[(head_ + history - (n < size_ ? n : size_ - 1)) % history];
    }

    /// Differences to earlier samples, as seen from the sample `back` samples ago.
    Features features(std::size_t back, const typename Channel::Judge& judge) const noexcept {
        Features f;
        for (std::size_t k = 0; k < lags; ++k) {
            const Vector row = judge.difference(ago(back + lag[k]), ago(back));
            for (std::size_t d = 0; d < D; ++d) f[k * D + d] = row[d];
        }
        return f;
    }

    void learn(std::size_t h, const typename Channel::Judge& judge) noexcept {
        if (size_ < std::size_t{horizon[h]} + 3) return;
        const Features f = features(horizon[h], judge);
        // the change as seen from the earlier sample, like its features
        Vector y = judge.difference(ago(0), ago(horizon[h])), guess;
        for (float& v : y) v = -v;
        models_[h].predict(f.data(), D, guess.data());
        models_[h].learn(f.data(), y.data(), guess.data(), D);
        if ((turn_ + h) % 4 == 0) models_[h].solve();
    }

    std::array<LinearModel, horizons> models_{};
    std::array<Value, history> values_{};
    std::size_t head_{0}, size_{0}, turn_{0};
};

}  // namespace fairlead::earlier
