#pragma once
// Where the signal is likely to go: a linear predictor per horizon, learned while the stream runs.
//
// x(i + h) - x(i) is predicted from x(i) - x(i - lag) for a few lags; one set of coefficients
// serves all components, so that the prediction turns with the signal. Recursive least squares in
// its normal form: forgetting, and weights 1 / (0.3 + error) against outliers. The predictions only
// steer the choice between plans that all keep the tolerance. Cost per push: about 1,100
// multiplications (D = 3).
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/reduce/plan.hpp"
#include "fairlead/reduce/window.hpp"

namespace fairlead {

template <class Channel>
class Predictor {
  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t horizons = 6;
    static constexpr std::array<std::uint8_t, horizons> horizon{5, 10, 16, 24, 36, 52};  // samples
    using Vector = std::array<float, D>;
    using Value = typename Channel::Value;

    void reset() noexcept {
        for (std::size_t h = 0; h < horizons; ++h) {
            models_[h] = {};
            for (std::size_t k = 0; k < lags; ++k) models_[h].a[packed(k, k)] = prior;
            const float tau = 12;  // before anything is learned: the present velocity, fading
            const float reach = static_cast<float>(horizon[h]);
            models_[h].c[1] = tau * (1 - approx::exp(-reach / tau)) / 2;
            models_[h].b[1] = prior * models_[h].c[1];
            models_[h].variance = reach * reach / 64;
        }
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
        for (std::size_t h = 0; h < horizons; ++h) out[h] = predicted(models_[h], f);
        return out;
    }
    float variance(std::size_t h) const noexcept { return models_[h].variance; }

  private:
    static constexpr std::size_t lags = 6;
    static constexpr std::array<std::uint8_t, lags> lag{1, 2, 4, 8, 16, 32};
    static constexpr std::size_t history = 52 + 32 + 1;
    static constexpr float prior = 1e-2f, forgetting = 0.9995f;
    using Features = std::array<Vector, lags>;

    struct Model {
        std::array<float, lags*(lags + 1) / 2> a{};  // normal matrix, lower triangle by rows
        std::array<float, lags> b{}, c{};
        float variance{0};
    };
    static constexpr std::size_t packed(std::size_t i, std::size_t j) noexcept {
        return i * (i + 1) / 2 + j;
    }

    const Value& ago(std::size_t n) const noexcept {
        return values_[(head_ + history - (n < size_ ? n : size_ - 1)) % history];
    }

    /// Differences to earlier samples, as seen from the sample `back` samples ago.
    Features features(std::size_t back, const typename Channel::Judge& judge) const noexcept {
        Features f;
        for (std::size_t k = 0; k < lags; ++k)
            f[k] = judge.difference(ago(back + lag[k]), ago(back));
        return f;
    }

    static Vector predicted(const Model& m, const Features& f) noexcept {
        Vector y{};
        for (std::size_t k = 0; k < lags; ++k)
            for (std::size_t d = 0; d < D; ++d) y[d] += m.c[k] * f[k][d];
        return y;
    }

    void learn(std::size_t h, const typename Channel::Judge& judge) noexcept {
        if (size_ < std::size_t{horizon[h]} + 3) return;
        Model& m = models_[h];
        const Features f = features(horizon[h], judge);
        // the change as seen from the earlier sample, like its features
        Vector y = judge.difference(ago(0), ago(horizon[h]));
        const Vector guess = predicted(m, f);
        float square = 0;
        for (auto& v : m.a) v *= forgetting;
        for (auto& v : m.b) v *= forgetting;
        for (std::size_t d = 0; d < D; ++d) {
            y[d] = -y[d];
            const float e = y[d] - guess[d];
            square += e * e;
            const float w = 1 / (0.3f + approx::abs(e));
            for (std::size_t i = 0; i < lags; ++i) {
                const float wf = w * f[i][d];
                for (std::size_t j = 0; j <= i; ++j) m.a[packed(i, j)] += wf * f[j][d];
                m.b[i] += wf * y[d];
            }
        }
        square /= static_cast<float>(D);
        m.variance += 0.05f * ((square < 400 ? square : 400) - m.variance);
        if ((turn_ + h) % 4 == 0) solve(m);
    }

    /// c = a^-1 b by LDL^T, with a little of the identity for what has not moved yet.
    static void solve(Model& m) noexcept {
        auto l = m.a;
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
            m.c[i] = m.b[i];
            for (std::size_t k = 0; k < i; ++k) m.c[i] -= l[packed(i, k)] * m.c[k];
        }
        for (std::size_t i = 0; i < lags; ++i) m.c[i] /= pivot[i];
        for (std::size_t i = lags; i-- > 0;)
            for (std::size_t k = i + 1; k < lags; ++k) m.c[i] -= l[packed(k, i)] * m.c[k];
    }

    std::array<Model, horizons> models_{};
    std::array<Value, history> values_{};
    std::size_t head_{0}, size_{0}, turn_{0};
};

}  // namespace fairlead
