#include "visviva/flow/end_values.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

namespace {

double smaller(double a, double b) {
    if (a * b <= 0) return 0;
    return std::abs(a) < std::abs(b) ? a : b;
}

}  // namespace

EndValues::EndValues(std::vector<int> unknowns) : unknown_(std::move(unknowns)) {
    std::sort(unknown_.begin(), unknown_.end());
    unknown_.erase(std::unique(unknown_.begin(), unknown_.end()), unknown_.end());
    middle_.assign(unknown_.size(), 0.0), slope_ = middle_;
}

void EndValues::settle(const Step& step, double* x) {
    if (step.theta == 1) {
        known_ = 0;
        return;
    }
    const double apart = (1 - step.theta) * h_ + step.theta * step.h;
    for (std::size_t k = 0; k < unknown_.size(); ++k) {
        double& value = x[unknown_[k]];
        const double slope = known_ ? (value - middle_[k]) / apart : 0;
        middle_[k] = value;
        if (known_ == 2) value += (1 - step.theta) * step.h * smaller(slope, slope_[k]);
        slope_[k] = slope;
    }
    h_ = step.h, known_ = std::min(known_ + 1, 2);
}

void EndValues::write(std::vector<double>& memory) const {
    memory.push_back(h_), memory.push_back(known_);
    for (const auto* part : {&middle_, &slope_}) memory.insert(memory.end(), part->begin(), part->end());
}

void EndValues::read(const double*& memory) {
    h_ = *memory++, known_ = static_cast<int>(*memory++);
    for (auto* part : {&middle_, &slope_})
        for (double& value : *part) value = *memory++;
}

}  // namespace visviva
