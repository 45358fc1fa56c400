#include "visviva/linear/krylov/smoother.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "visviva/linear/krylov/precondition.hpp"
#include "visviva/linear/scaled.hpp"

namespace visviva {

namespace {

constexpr float lowest_share = 0.2F;  // of the spectrum's upper end that smoothing damps
constexpr int power_steps = 12;
constexpr int lanczos_steps = 12;

double product(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * b[i];
    return sum;
}

}  // namespace

void multiply(const BlockRows<float>& a, const std::vector<float>& x, std::vector<float>& y) {
    multiply(a, x, y, [](std::size_t) {});
}

BlockRows<float> single(const BlockReader& a, double factor) {
    constexpr int piece = 512;  // block rows of a task
    BlockRows<float> b;
    b.rows = a.pattern.rows, b.cols = a.pattern.cols, b.row = a.pattern.row, b.col = a.pattern.col;
    b.allocate();
    in_pieces(b.n(), piece, [&](int begin, int end) {
        std::vector<double> room;
        for (int i = begin; i < end; ++i) {
            const double* row = a.row(i, room);
            std::transform(row, row + a.size_of_row(i), b.block(b.row[i]),
                           [factor](double v) { return static_cast<float>(factor * v); });
        }
    });
    return b;
}

Smoother::Smoother(const BlockReader& a, double factor)
    : a_(single(a, factor)), inverse_(inverse_diagonal<float>(a, false)) {
    for (float& v : inverse_.value) v = static_cast<float>(v / factor);
    for (Vector* v : {&residual_, &step_, &scaled_}) v->resize(a_.size());
}

void Smoother::smooth(const Vector& b, Vector& x, bool zero) {
    const float middle = 0.5F * (upper_ + lower_), half = 0.5F * (upper_ - lower_);
    if (zero)
        residual_ = b, std::fill(x.begin(), x.end(), 0.0F);
    else
        defect(b, x);
    float rho = half / middle;
    for (int k = 0; k < degree_; ++k) {
        const float next = 1 / (2 * middle / half - rho);
        const float old = k == 0 ? 0 : next * rho, add = k == 0 ? 1 / middle : 2 * next / half;
        if (k > 0) rho = next;
        multiply(inverse_, residual_, scaled_,
                 [&](std::size_t i) { step_[i] = old * step_[i] + add * scaled_[i], x[i] += step_[i]; });
        if (k + 1 < degree_) subtract(step_);
    }
}

const Smoother::Vector& Smoother::defect(const Vector& b, const Vector& x) {
    multiply(a_, x, residual_, [&](std::size_t i) { residual_[i] = b[i] - residual_[i]; });
    return residual_;
}

void Smoother::subtract(const Vector& step) {
    multiply(a_, step, scaled_, [&](std::size_t i) { residual_[i] -= scaled_[i]; });
}

// Largest eigenvalue of D^-1 A by the power method.
void Smoother::damp_upper() {
    const auto start = arbitrary_vector(static_cast<int>(size()));
    std::copy(start.begin(), start.end(), step_.begin());
    double largest = 1;
    for (int k = 0; k < power_steps; ++k) {
        multiply(a_, step_, scaled_);
        multiply(inverse_, scaled_, residual_);
        const double before = product(step_, step_), after = product(residual_, residual_);
        largest = std::sqrt(after / before);
        const auto shrink = static_cast<float>(1 / std::sqrt(after));
        for (std::size_t i = 0; i < size(); ++i) step_[i] = shrink * residual_[i];
    }
    upper_ = static_cast<float>(1.1 * largest), lower_ = lowest_share * upper_;
}

// Conjugate gradients are Lanczos' method: their factors make a tridiagonal matrix whose eigenvalues are
// about the least and the largest ones of D^-1 A.
int Smoother::damp_all(float reduction) {
    const auto start = arbitrary_vector(static_cast<int>(size()));
    std::copy(start.begin(), start.end(), residual_.begin());
    Vector p(size(), 0.0F), z(size());
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(lanczos_steps, lanczos_steps);
    double rz = 0, alpha = 1;
    int n = 0;
    for (; n < lanczos_steps; ++n) {
        multiply(inverse_, residual_, z);
        const double rz1 = product(residual_, z), beta = n > 0 ? rz1 / rz : 0;
        if (rz1 == 0) break;
        for (std::size_t i = 0; i < size(); ++i) p[i] = z[i] + static_cast<float>(beta) * p[i];
        multiply(a_, p, scaled_);
        if (n > 0) T(n, n) = beta / alpha, T(n, n - 1) = T(n - 1, n) = std::sqrt(beta) / alpha;
        alpha = rz1 / product(p, scaled_);
        if (!(alpha > 0) || !std::isfinite(alpha)) return std::numeric_limits<int>::max();
        T(n, n) += 1 / alpha, rz = rz1;
        for (std::size_t i = 0; i < size(); ++i) residual_[i] -= static_cast<float>(alpha) * scaled_[i];
    }
    if (n == 0) return degree_;
    const Eigen::VectorXd found =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(T.topLeftCorner(n, n), Eigen::EigenvaluesOnly)
            .eigenvalues();
    upper_ = static_cast<float>(1.05 * found[n - 1]);
    lower_ = static_cast<float>(0.95 * std::max(found[0], 1e-6 * found[n - 1]));
    const double root = std::sqrt(upper_ / lower_);
    return degree_ = std::max(
               1, static_cast<int>(std::ceil(std::log(2 / reduction) / std::log((root + 1) / (root - 1)))));
}

}  // namespace visviva
