// Active set: gaps that carry pressure, chosen in the iterations of a step until that settles.
#pragma once
#include <utility>
#include <vector>

namespace visviva {

class ActiveSet {
  public:
    explicit ActiveSet(int n) : active_(n, 0), at_tangent_(n, 0) {}

    bool operator[](int gap) const { return active_[gap]; }
    const std::vector<char>& flags() const { return active_; }
    void set(int gap, bool active) { active_[gap] = active; }
    void set_flags(std::vector<char> flags) { active_ = std::move(flags); }

    /// In a new step nothing is chosen yet.
    void begin_step() { changes_ = -1; }
    bool is_chosen() const { return changes_ >= 0; }

    /// Takes those gaps that want pressure, wants(gap). All at once at first; should that go round in
    /// circles, the first gap alone that wants to change does, which ends for every matrix with positive
    /// principal minors (Murty 1974).
    template <class F>
    void update(F wants) {
        constexpr int patience = 6;
        bool changed = false;
        unsettled_ = false;
        for (int gap = 0; gap < static_cast<int>(active_.size()); ++gap) {
            const char wanted = wants(gap);
            if (wanted == active_[gap]) continue;
            if (changed && changes_ >= patience) {
                unsettled_ = true;
                break;
            }
            active_[gap] = wanted, changed = true;
        }
        if (changes_ < 0 || changed) ++changes_;
    }

    void mark_tangent() { at_tangent_ = active_; }
    /// Whether it is another one than that of the tangent, or is known to change further.
    bool is_outdated() const { return unsettled_ || active_ != at_tangent_; }
    bool is_outdated(int gap) const { return active_[gap] != at_tangent_[gap]; }

    /// The kept tangent will be made again, which needs its active set.
    void write(std::vector<double>& m) const { m.insert(m.end(), at_tangent_.begin(), at_tangent_.end()); }
    void read(const double*& m) {
        for (char& active : active_) active = *m++ != 0;
        at_tangent_ = active_;  // a tangent that was updated is not made again, but branches count from it
    }

  private:
    std::vector<char> active_, at_tangent_;
    int changes_ = -1;  // since the step began; -1: not chosen yet
    bool unsettled_ = false;
};

}  // namespace visviva
