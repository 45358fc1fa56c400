// Vertices, edges and corners that take over from each other: what slides over the border of a face is held
// by an edge of that from then on, and the other way round. As deep as it was held before, for it has not
// come in there by a force, and would lose what it stores.
#include <algorithm>

#include "visviva/contact/contact_term.hpp"

namespace visviva {

// Where its gradient on the first body has its resultant.
Hold ContactTerm::hold(int A, const Gap& gap) const {
    Hold h{A, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    const auto& stencil = gaps_->stencil(A);
    const auto is_own = [&](std::size_t v) { return stencil[v] < gaps_->n_first(); };
    for (std::size_t v = 0; v < stencil.size(); ++v)
        if (is_own(v)) h.push += Eigen::Vector3d::Map(&gap.gradient[3 * v]);
    const double size = h.push.norm();
    if (size > 0) h.push /= size;
    for (std::size_t v = 0; v < stencil.size() && size > 0; ++v)
        if (is_own(v))
            h.place += h.push.dot(Eigen::Vector3d::Map(&gap.gradient[3 * v])) / size *
                       Eigen::Vector3d::Map(&X1_[3 * stencil[v]]);
    return h;
}

// At the end of the step.
std::vector<Hold> ContactTerm::held() const {
    std::vector<char> closed(gaps_->n());
    for (int A = 0; A < gaps_->n(); ++A) closed[A] = area1_[A] > 0 && gap1_[A] < 0;
    std::vector<Gap> gaps(gaps_->n());
    gaps_->gradients(X1_.data(), closed, gaps);
    std::vector<Hold> all;
    for (int A = 0; A < gaps_->n(); ++A) {
        if (!closed[A]) continue;
        Hold h = hold(A, gaps[A]);
        h.energy = potential(A, gap1_[A]);
        for (const int v : gaps_->stencil(A))
            for (const int w : gaps_->stencil(A))
                h.way = std::max(
                    h.way, (Eigen::Vector3d::Map(&D_[3 * v]) - Eigen::Vector3d::Map(&D_[3 * w])).norm());
        all.push_back(h);
    }
    return all;
}

void ContactTerm::let_go_of(const std::vector<Hold>& held) {
    lost_.clear();
    for (const Hold& h : held)
        if (gaps_->has_left(h.gap)) lost_.push_back(h);
}

void ContactTerm::find_come() {
    std::vector<char> come(gaps_->n());
    for (int A = 0; A < gaps_->n(); ++A) come[A] = gaps_->has_come(A) && area0_[A] > 0;
    std::vector<Gap> gaps(gaps_->n());
    gaps_->gradients(X0_.data(), come, gaps);
    come_.clear();
    for (int A = 0; A < gaps_->n(); ++A)
        if (come[A]) come_.push_back(hold(A, gaps[A]));
}

// Each to the nearest that is no farther than bodies have moved past each other.
void ContactTerm::hand_over() {
    for (ContactTerm* from : {this, beside_.get()})
        for (const Hold& lost : from->lost_) {
            double least = 2 * lost.way;
            ContactTerm* to = nullptr;
            Hold* nearest = nullptr;
            for (ContactTerm* term : {this, beside_.get()})
                for (Hold& come : term->come_)
                    if (const double distance = lost.distance(come); distance < least)
                        least = distance, to = term, nearest = &come;
            if (!nearest) continue;
            nearest->energy += lost.energy;
            from->let_go_ -= lost.energy;
            to->let_go_ += lost.energy;
        }
    for (ContactTerm* term : {this, beside_.get()})
        for (const Hold& own : term->come_)
            if (own.energy > 0) term->go_on(own);
}

// No deeper than it is: what is left of the energy is let go.
void ContactTerm::go_on(const Hold& own) {
    const int A = own.gap;
    const double offset = area0_[A] * gaps_->offset(A), deep = offset - gap0_[A];
    const double held = std::min(std::sqrt(2 * own.energy / options_.stiffness[A]), deep);
    gaps_->offsets()->set_offset(A, (deep - held) / area0_[A]);
    gap0_[A] = -held, known_.clear();
    let_go_ -= potential(A, -held);
}

}  // namespace visviva
