// Which side of the body that it lies in a vertex belongs to, where the nearest is not the one by which it came
// in: known for the start of the step, and kept for where a step may be looked at again.
#pragma once
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

namespace visviva {

class Sides {
  public:
    static constexpr int nearest = -1;

    void resize(int n) {
        n_ = n;
        for (Record* r : {&at_, &now_, &before_, &at_tangent_}) *r = fresh({});
    }
    /// The positions at the start of the step; empty: there was no step yet.
    const std::vector<double>& start() const { return at_.X; }
    int of(int vertex) const { return at_.side[vertex]; }
    bool began_inside(int vertex) const { return at_.inside[vertex] != 0; }

    /// Makes X the start of the step; what is not known there yet follows from where the step began until now,
    /// by find(vertex), a pair of the side and whether it lies inside. True if sides have changed.
    template <class F>
    bool settle(const std::vector<double>& X, F find) {
        if (X == at_.X) return false;
        for (const Record* r : {&now_, &before_, &at_tangent_})
            if (X == r->X) return take(*r);
        Record next = fresh(X);
        for (int A = 0; A < n_; ++A) std::tie(next.side[A], next.inside[A]) = find(A);
        before_ = std::move(now_), now_ = next;
        return take(std::move(next));
    }
    void mark_tangent() { at_tangent_ = at_; }

    void write(std::vector<double>& m) const {
        for (const Record* r : {&now_, &at_tangent_}) {
            m.push_back(static_cast<double>(r->X.size()));
            m.insert(m.end(), r->X.begin(), r->X.end());
            m.insert(m.end(), r->side.begin(), r->side.end());
            m.insert(m.end(), r->inside.begin(), r->inside.end());
        }
    }
    void read(const double*& m) {
        for (Record* r : {&now_, &at_tangent_}) {
            const std::size_t size = static_cast<std::size_t>(*m++);
            *r = fresh({m, m + size}), m += size;
            for (int& side : r->side) side = static_cast<int>(*m++);
            for (int& inside : r->inside) inside = static_cast<int>(*m++);
        }
        at_ = now_;
    }

  private:
    struct Record {
        std::vector<double> X;
        std::vector<int> side, inside;
    };
    Record fresh(std::vector<double> X) const {
        return {std::move(X), std::vector<int>(n_, nearest), std::vector<int>(n_, 0)};
    }
    bool take(Record next) {
        const bool changed = next.side != at_.side;
        at_ = std::move(next);
        return changed;
    }

    int n_ = 0;
    Record at_, now_, before_, at_tangent_;
};

}  // namespace visviva
