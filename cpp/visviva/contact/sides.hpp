// Side of the body to which a vertex inside belongs: that by which it came in, not the nearest.
// Known for the start of the step, and kept for where a step may be looked at again.
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

namespace visviva {

class Sides {
  public:
    static constexpr int nearest = -1;  // of what is outside, or was not followed

    void resize(int n) {
        n_ = n;
        for (Record* r : {&at_, &now_, &before_, &at_tangent_}) *r = fresh({});
    }
    /// The positions at the start of the step; empty: there was no step yet.
    const std::vector<double>& start() const { return at_.X; }
    int of(int vertex) const { return at_.side[vertex]; }

    /// Makes X the start of the step; what is not known there yet follows from where the step began until
    /// now, by find(vertex). True if sides have changed.
    template <class F>
    bool settle(const std::vector<double>& X, F find) {
        if (X == at_.X) return false;
        for (const Record* r : {&now_, &before_, &at_tangent_})
            if (X == r->X) return take(*r);
        Record next = fresh(X);
        for (int A = 0; A < n_; ++A) next.side[A] = find(A);
        before_ = std::move(now_), now_ = next;
        return take(std::move(next));
    }
    void mark_tangent() { at_tangent_ = at_; }

    void write(std::vector<double>& m) const {
        for (const Record* r : {&now_, &at_tangent_}) {
            m.push_back(static_cast<double>(r->X.size()));
            m.insert(m.end(), r->X.begin(), r->X.end());
            m.insert(m.end(), r->side.begin(), r->side.end());
        }
    }
    void read(const double*& m) {
        for (Record* r : {&now_, &at_tangent_}) {
            const std::size_t size = static_cast<std::size_t>(*m++);
            *r = fresh({m, m + size}), m += size;
            for (int& side : r->side) side = static_cast<int>(*m++);
        }
        at_ = now_;
    }

  private:
    struct Record {
        std::vector<double> X;
        std::vector<int> side;
    };
    Record fresh(std::vector<double> X) const { return {std::move(X), std::vector<int>(n_, nearest)}; }
    bool take(Record next) {
        const bool changed = next.side != at_.side;
        at_ = std::move(next);
        return changed;
    }

    int n_ = 0;
    Record at_, now_, before_, at_tangent_;
};

}  // namespace visviva
