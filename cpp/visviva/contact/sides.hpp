// What gaps remember from step to step, such as the side of the body to which a vertex inside belongs: that
// by which it came in, not the nearest. Known for the start of the step, and kept for where a step may be
// looked at again.
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

namespace visviva {

/// A facet or a face of the body, and how deep a vertex was below it when it was found there: so deep it
/// stores no energy.
struct Entered {
    int face = -1;
    double offset = 0;
    bool operator==(const Entered&) const = default;
};
inline void write_side(std::vector<double>& m, const Entered& side) {
    m.insert(m.end(), {static_cast<double>(side.face), side.offset});
}
inline void read_side(const double*& m, Entered& side) {
    side = {static_cast<int>(m[0]), m[1]};
    m += 2;
}

/// Of every gap a `Side`, which write_side and read_side put into memory.
template <class Side>
class SidesOf {
  public:
    explicit SidesOf(Side unknown) : unknown_(unknown) {}
    void resize(int n) {
        n_ = n;
        for (Record* r : {&at_, &now_, &before_, &at_tangent_}) *r = fresh({});
    }
    /// The positions at the start of the step; empty: there was no step yet.
    const std::vector<double>& start() const { return at_.X; }
    const Side& of(int gap) const { return at_.side[gap]; }
    const std::vector<Side>& all() const { return at_.side; }

    /// Makes X the start of the step; what is not known there yet follows from where the step began until
    /// now, by find(sides). True if sides have changed.
    template <class F>
    bool settle(const std::vector<double>& X, F find) {
        if (X == at_.X) return false;
        for (const Record* r : {&now_, &before_, &at_tangent_})
            if (X == r->X) return take(*r);
        Record next = fresh(X);
        find(next.side);
        before_ = std::move(now_), now_ = next;
        return take(std::move(next));
    }
    void mark_tangent() { at_tangent_ = at_; }
    /// Another side than was found where the step begins.
    void amend(int gap, const Side& side) {
        at_.side[gap] = side;
        if (now_.X == at_.X) now_.side[gap] = side;
    }

    void write(std::vector<double>& m) const {
        for (const Record* r : {&now_, &at_tangent_}) {
            m.push_back(static_cast<double>(r->X.size()));
            m.insert(m.end(), r->X.begin(), r->X.end());
            for (const Side& side : r->side) write_side(m, side);
        }
    }
    void read(const double*& m) {
        for (Record* r : {&now_, &at_tangent_}) {
            const std::size_t size = static_cast<std::size_t>(*m++);
            *r = fresh({m, m + size}), m += size;
            for (Side& side : r->side) read_side(m, side);
        }
        at_ = now_;
    }

  private:
    struct Record {
        std::vector<double> X;
        std::vector<Side> side;
    };
    Record fresh(std::vector<double> X) const { return {std::move(X), std::vector<Side>(n_, unknown_)}; }
    bool take(Record next) {
        const bool changed = next.side != at_.side;
        at_ = std::move(next);
        return changed;
    }

    int n_ = 0;
    Side unknown_;
    Record at_, now_, before_, at_tangent_;
};

/// Sides of vertices, by numbers of facets or of faces.
class Sides : public SidesOf<Entered> {
  public:
    static constexpr int nearest = -1;  // of what is outside, or was not followed
    static constexpr int none = -2;     // of what comes in where it cannot have touched: free for the step
    Sides() : SidesOf({nearest, 0}) {}
};

}  // namespace visviva
