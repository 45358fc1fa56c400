#include "visviva/system/predictor.hpp"

#include <algorithm>

#include "visviva/base/vector_dispatch.hpp"

namespace visviva {

namespace {

void cross(const double* a, const double* b, double* c) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

// Sum of d_i x e_i over the directors.
void turning(const RigidUnknowns& body, const double* d, const double* e, double* sum) {
    sum[0] = sum[1] = sum[2] = 0;
    for (int k = 0; k < 3; ++k) {
        const int* q = body.q + 3 + 3 * k;
        const double a[3] = {d[q[0]], d[q[1]], d[q[2]]}, b[3] = {e[q[0]], e[q[1]], e[q[2]]};
        double c[3];
        cross(a, b, c);
        for (int i = 0; i < 3; ++i) sum[i] += c[i];
    }
}

// Cayley's rotation about t, less the identity, of the directors in x.
void turn(const RigidUnknowns& body, const double* t, const double* x, double* dx) {
    const double f = 1 / (1 + 0.25 * (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
    for (int k = 0; k < 3; ++k) {
        const int* q = body.q + 3 + 3 * k;
        const double d[3] = {x[q[0]], x[q[1]], x[q[2]]};
        double once[3], twice[3];
        cross(t, d, once);
        cross(t, once, twice);
        for (int c = 0; c < 3; ++c) dx[q[c]] = f * (once[c] + 0.5 * twice[c]);
    }
}

void gather(const std::vector<int>& unknowns, const double* x, double* to) {
    for (std::size_t k = 0; k < unknowns.size(); ++k) to[k] = x[unknowns[k]];
}

void scatter(const std::vector<int>& unknowns, const double* from, double* x) {
    for (std::size_t k = 0; k < unknowns.size(); ++k) x[unknowns[k]] = from[k];
}

}  // namespace

void Extrapolation::resize(std::vector<double> weight, bool spreads) {
    weight_ = std::move(weight), spreads_ = spreads;
    for (auto& d : difference_) d = {};
    forget();
}

void Extrapolation::push(const double* x) {
    const int n = static_cast<int>(weight_.size()), n_d = std::min(known_ + 1, most);
    double* d[most];
    for (int k = 0; k < n_d; ++k) difference_[k].resize(n), d[k] = difference_[k].data();
    double error[most], alternating[most];
    vector_kernels().differences(n, n_d, x, weight_.data(), d, error, alternating);
    // Difference k + 1 is what the sum of those before it missed x by; where difference k changed its sign,
    // that sum less difference k would have met x.
    // Of few steps there is little to choose from.
    order_ = 1, alternates_ = false;
    double least = known_ > 0 ? error[0] : 0;
    if (spreads_ && known_ > 0)
        if (const double all = vector_kernels().largest(n, x, weight_.data()); all < least)
            least = all, order_ = 0;
    for (int k = 1; k < known_; ++k) {
        if (error[k] < least && known_ > 2) least = error[k], order_ = k + 1, alternates_ = false;
        if (alternating[k] < least && (known_ > 2 || spreads_))
            least = alternating[k], order_ = k, alternates_ = true;
    }
    known_ = std::min(known_ + 1, most);
}

void Extrapolation::next(double* x) const {
    const int n = static_cast<int>(weight_.size());
    std::fill(x, x + n, 0.0);
    for (int k = 0; k < order_ + (alternates_ ? 1 : 0); ++k)
        vector_kernels().affine(n, k < order_ ? 1.0 : -1.0, difference_[k].data(), x, x);
}

double Extrapolation::largest() const {
    return vector_kernels().largest(static_cast<int>(weight_.size()), difference_[0].data(), weight_.data());
}

void Extrapolation::write(std::vector<double>& memory) const {
    for (int value : {known_, order_, static_cast<int>(alternates_)}) memory.push_back(value);
    for (const auto& d : difference_) {
        memory.insert(memory.end(), d.begin(), d.end());
        memory.insert(memory.end(), weight_.size() - d.size(), 0.0);
    }
}

const double* Extrapolation::read(const double* memory) {
    known_ = static_cast<int>(memory[0]), order_ = static_cast<int>(memory[1]), alternates_ = memory[2] != 0;
    memory += 3;
    for (int k = 0; k < most; ++k, memory += weight_.size())
        if (k < known_) difference_[k].assign(memory, memory + weight_.size());
    return memory;
}

void Predictor::resize(std::vector<int> coordinates, std::vector<double> weight, bool spread,
                       std::vector<int> multipliers, std::vector<RigidUnknowns> rigid) {
    coordinates_ = std::move(coordinates), multipliers_ = std::move(multipliers), rigid_ = std::move(rigid);
    motion_.resize(std::move(weight), spread);
    multiplier_.resize(std::vector<double>(multipliers_.size(), 1.0));
    turn_.resize(std::vector<double>(3 * rigid_.size(), 1.0));
    work_.assign(std::max({coordinates_.size(), multipliers_.size(), 3 * rigid_.size()}), 0.0);
}

void Predictor::predict(double h, const double* x, const double* v, bool moves, double* dx) {
    if (moves && h == h_ && motion_.knows()) {
        motion_.next(work_.data());
        scatter(coordinates_, work_.data(), dx);
    } else if (moves) {
        for (int i : coordinates_) dx[i] = h * v[i];
    }
    predict_rotations(h, x, v, dx);
}

void Predictor::predict_multipliers(double h, double* dx) {
    if (h == h_ && multiplier_.knows())
        multiplier_.next(work_.data());
    else
        std::fill(work_.begin(), work_.end(), 0.0);
    scatter(multipliers_, work_.data(), dx);
}

void Predictor::predict_rotations(double h, const double* x, const double* v, double* dx) {
    const bool known = h == h_ && turn_.knows();
    if (known) turn_.next(work_.data());
    for (std::size_t body = 0; body < rigid_.size(); ++body) {
        double* t = &work_[3 * body];
        if (!known) {  // angular velocity d_i x d_i' / 2
            turning(rigid_[body], x, v, t);
            for (int c = 0; c < 3; ++c) t[c] *= 0.5 * h;
        }
        turn(rigid_[body], t, x, dx);
    }
}

void Predictor::record_rotations(const double* x0, const double* dx) {
    for (std::size_t body = 0; body < rigid_.size(); ++body) {
        // sum d_i x (d_i + dd_i) = 2 sin(angle) n, sum d_i . dd_i = 2 (cos(angle) - 1); Cayley's is 2
        // tan(angle/2) n
        double s[3], trace = 4;
        turning(rigid_[body], x0, dx, s);
        for (int k = 3; k < 12; ++k) trace += x0[rigid_[body].q[k]] * dx[rigid_[body].q[k]];
        for (int c = 0; c < 3; ++c) work_[3 * body + c] = 2 * s[c] / std::max(trace, 1e-3);
    }
    turn_.push(work_.data());
}

void Predictor::record(const double* x0, const double* dx, double h) {
    if (h != h_) forget();
    h_ = h;
    gather(coordinates_, dx, work_.data());
    motion_.push(work_.data());
    gather(multipliers_, dx, work_.data());
    multiplier_.push(work_.data());
    record_rotations(x0, dx);
}

void Predictor::write(std::vector<double>& memory) const {
    std::size_t size = 1;
    for (const auto* part : {&motion_, &multiplier_, &turn_}) size += part->written();
    memory.reserve(memory.size() + size);
    memory.push_back(h_);
    for (const auto* part : {&motion_, &multiplier_, &turn_}) part->write(memory);
}

const double* Predictor::read(const double* memory) {
    h_ = *memory++;
    for (auto* part : {&motion_, &multiplier_, &turn_}) memory = part->read(memory);
    return memory;
}

}  // namespace visviva
