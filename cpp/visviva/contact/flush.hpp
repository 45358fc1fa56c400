// So far beside the border of a face what touches it is above it, and no edge crosses that border: of bodies
// that are flush one alone holds. What asks takes different ways to the same offset, which rounding tells
// apart: the limit lies where a step begins in the middle of the widest gap between the offsets there are.
#pragma once
#include <algorithm>
#include <vector>

namespace visviva {

class Flush {
  public:
    explicit Flush(double usual) : usual_(usual), limit_(usual) {}
    double limit() const { return limit_; }
    /// True if the limit is another one from now on.
    bool settle(std::vector<double> offsets) {
        constexpr double wide = 2;  // times, and parts of, what is usual
        const double low = usual_ / wide, high = usual_ * wide;
        std::erase_if(offsets, [&](double offset) { return offset <= low || offset >= high; });
        const double before = limit_;
        limit_ = offsets.empty() ? usual_ : middle_of_widest(low, std::move(offsets), high);
        return limit_ != before;
    }

  private:
    static double middle_of_widest(double low, std::vector<double> between, double high) {
        between.push_back(high);
        std::sort(between.begin(), between.end());
        double widest = 0, middle = low;
        for (const double next : between) {
            if (next - low > widest) widest = next - low, middle = 0.5 * (low + next);
            low = next;
        }
        return middle;
    }
    double usual_, limit_;
};

}  // namespace visviva
