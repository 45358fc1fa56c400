#include "visviva/contact/swept_search.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

namespace {

// Parts of the reach by which surfaces may leave what was swept, until the search is done again, and at all.
constexpr double again = 0.125, too_far = 0.35;

}  // namespace

// A vertex that has left what was swept by more than a margin; -1: none.
int SweptSearch::beyond(const std::vector<double>& X, double margin) const {
    if (from_.empty()) return 0;
    for (std::size_t i = 0; i < from_.size(); ++i)
        if (X[i] < std::min(from_[i], to_[i]) - margin || X[i] > std::max(from_[i], to_[i]) + margin)
            return static_cast<int>(i / 3);
    return -1;
}

bool SweptSearch::is_due(const std::vector<double>& X) const { return beyond(X, again * reach_) >= 0; }

int SweptSearch::lost(const std::vector<double>& X) const { return beyond(X, too_far * reach_); }

bool SweptSearch::find_neighbours(Gaps& gaps, const std::vector<double>& X0, const std::vector<double>& X1) {
    constexpr double steps_ahead = 4;
    from_ = X0, to_ = X1;
    for (std::size_t i = 0; i < to_.size(); ++i) {
        const double step = to_[i] - from_[i], ahead = steps_ahead * std::clamp(step, -reach_, reach_);
        to_[i] = from_[i] + (std::abs(step) > std::abs(ahead) ? step : ahead);
    }
    return gaps.search(from_.data(), to_.data());
}

void SweptSearch::write(std::vector<double>& m) const {
    m.push_back(from_.empty() ? 0 : 1);
    m.insert(m.end(), from_.begin(), from_.end()), m.insert(m.end(), to_.begin(), to_.end());
}

bool SweptSearch::read(const double*& m, Gaps& gaps) {
    const std::size_t n = gaps.skin().constant.size();
    if (*m++ == 0) {
        from_.clear(), to_.clear();
        return false;
    }
    from_.assign(m, m + n), to_.assign(m + n, m + 2 * n);
    m += 2 * n;
    return gaps.search(from_.data(), to_.data());
}

}  // namespace visviva
