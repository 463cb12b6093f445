#pragma once
// Symmetric positive definite banded systems, in memory fixed at compile time.
//
// LDL^T without pivoting, row by row: row i of L needs the Band rows before it and nothing else, so
// a stream may factor each row as it comes. In place: the factor overwrites the matrix.
// Cost: Band (Band + 1) / 2 multiply-adds and one division per row; 2 Band multiply-adds per row
// and right-hand side. All loops are bounded by Band and Capacity.
#include <array>
#include <cstddef>

#include "fairlead/base/status.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/math/vec.hpp"

namespace fairlead {

/// A(i, j) = 0 for |i - j| > Band; the size is chosen at run time, up to Capacity. Right-hand sides
/// are any type with subtraction and multiplication by Real, such as Real and BasicVec3<Real>.
template <class Real, std::size_t Capacity, std::size_t Band>
class Banded {
    static_assert(Capacity > 0 && Band < Capacity);

  public:
    static constexpr std::size_t capacity = Capacity;
    static constexpr std::size_t band = Band;

    constexpr std::size_t size() const noexcept { return size_; }

    /// n rows, all zero.
    constexpr void resize(std::size_t n) noexcept {
        FAIRLEAD_ASSERT(n <= Capacity);
        size_ = n;
        for (std::size_t i = 0; i < n; ++i) rows_[i] = {};
    }

    /// A(i, j) and A(j, i), one entry.
    constexpr Real& at(std::size_t i, std::size_t j) noexcept {
        const std::size_t row = i > j ? i : j, column = i > j ? j : i;
        FAIRLEAD_ASSERT(row < size_ && row - column <= Band);
        return rows_[row][Band + column - row];
    }
    constexpr Real at(std::size_t i, std::size_t j) const noexcept {
        const std::size_t row = i > j ? i : j, column = i > j ? j : i;
        FAIRLEAD_ASSERT(row < size_ && row - column <= Band);
        return rows_[row][Band + column - row];
    }

    /// Row i of A x, before factoring.
    template <class T>
    constexpr T multiplied(std::size_t i, const T* x) const noexcept {
        T sum{};
        for (std::size_t j = first(i); j < size_ && j <= i + Band; ++j) sum = sum + at(i, j) * x[j];
        return sum;
    }

    /// Turns the matrix into its factor. bad_data: it is not positive definite.
    constexpr Status factor() noexcept {
        for (std::size_t i = 0; i < size_; ++i)
            if (const Status s = factor_row(i); s != Status::ok) return s;
        return Status::ok;
    }

    /// The same for row i alone, when the rows before it are done.
    constexpr Status factor_row(std::size_t i) noexcept {
        auto& row = rows_[i];
        const std::size_t start = first(i);
        for (std::size_t j = start; j < i; ++j) {  // row holds L D until its pivot is known
            Real g = row[Band + j - i];
            for (std::size_t k = start > first(j) ? start : first(j); k < j; ++k)
                g = g - row[Band + k - i] * rows_[j][Band + k - j];
            row[Band + j - i] = g;
        }
        Real pivot = row[Band];
        for (std::size_t j = start; j < i; ++j) {
            const Real g = row[Band + j - i], l = g * rows_[j][Band];
            pivot = pivot - g * l;
            row[Band + j - i] = l;
        }
        if (!(pivot > 0) || !approx::is_finite(pivot)) return Status::bad_data;
        row[Band] = 1 / pivot;  // the reciprocal is what everything after needs
        return Status::ok;
    }

    /// x <- A^-1 x, after factor().
    template <class T>
    constexpr void solve(T* x) const noexcept {
        for (std::size_t i = 0; i < size_; ++i) x[i] = forward(i, x);
        for (std::size_t i = size_; i-- > 0;) x[i] = backward(i, x);
    }

    /// One row of L y = x: y[i] from x[i] and y[i - Band] ... y[i - 1], in one array.
    template <class T>
    constexpr T forward(std::size_t i, const T* x) const noexcept {
        T sum = x[i];
        for (std::size_t j = first(i); j < i; ++j) sum = sum - rows_[i][Band + j - i] * x[j];
        return sum;
    }
    /// One row of D L^T x = y, from the last row upwards, in one array.
    template <class T>
    constexpr T backward(std::size_t i, const T* x) const noexcept {
        T sum = rows_[i][Band] * x[i];
        for (std::size_t j = i + 1; j < size_ && j <= i + Band; ++j)
            sum = sum - rows_[j][Band + i - j] * x[j];
        return sum;
    }

  private:
    static constexpr std::size_t first(std::size_t i) noexcept { return i > Band ? i - Band : 0; }

    std::array<std::array<Real, Band + 1>, Capacity> rows_{};  // A(i, i - Band) ... A(i, i)
    std::size_t size_{0};
};

/// The same for 3x3 blocks: block (i, j) = 0 for |i - j| > BlockBand; unknowns are vectors. Inside
/// a block row the band is full, so that a scalar band of 3 BlockBand + 2 wastes next to nothing.
template <class Real, std::size_t Capacity, std::size_t BlockBand>
class BlockBanded {
  public:
    using Block = std::array<std::array<Real, 3>, 3>;
    using Vector = BasicVec3<Real>;
    static constexpr std::size_t capacity = Capacity;
    static constexpr std::size_t band = BlockBand;

    constexpr std::size_t size() const noexcept { return size_; }

    constexpr void resize(std::size_t blocks) noexcept {
        size_ = blocks;
        scalar_.resize(3 * blocks);
    }

    /// Adds m to block (i, j) and its transpose to block (j, i), i >= j. A diagonal block must be
    /// symmetric.
    constexpr void add(std::size_t i, std::size_t j, const Block& m) noexcept {
        FAIRLEAD_ASSERT(i >= j);
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < (i == j ? r + 1 : 3); ++c)
                scalar_.at(3 * i + r, 3 * j + c) += m[r][c];
    }

    constexpr Status factor() noexcept { return scalar_.factor(); }

    /// x <- A^-1 x, after factor().
    constexpr void solve(Vector* x) noexcept {
        for (std::size_t i = 0; i < size_; ++i) {
            flat_[3 * i] = x[i].x;
            flat_[3 * i + 1] = x[i].y;
            flat_[3 * i + 2] = x[i].z;
        }
        scalar_.solve(flat_.data());
        for (std::size_t i = 0; i < size_; ++i)
            x[i] = {flat_[3 * i], flat_[3 * i + 1], flat_[3 * i + 2]};
    }

    /// The scalar system: row 3 i + axis.
    constexpr Banded<Real, 3 * Capacity, 3 * BlockBand + 2>& scalar() noexcept { return scalar_; }

  private:
    Banded<Real, 3 * Capacity, 3 * BlockBand + 2> scalar_{};
    std::array<Real, 3 * Capacity> flat_{};
    std::size_t size_{0};
};

}  // namespace fairlead
