// Numbers of gaps that steps change, as elastic tractions of friction. They belong to a configuration of the
// vertices: a step may be looked at again, or a kept tangent be made again.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

namespace visviva {

class GapMemory {
  public:
    void resize(std::size_t n_positions, std::size_t n_numbers, double first) {
        at_start_.assign(n_numbers, first);
        for (Record* r : {&now_, &before_, &at_tangent_})
            *r = {std::vector<double>(n_positions, 0.0), at_start_};
    }
    /// When the step begins.
    const std::vector<double>& at_start() const { return at_start_; }

    /// A step begins at X.
    void begin_step(const std::vector<double>& X) {
        const Record* record = &now_;
        for (const Record* r : {&at_tangent_, &before_, &now_})
            if (r->X == X) record = r;
        at_start_ = record->numbers;
    }
    /// A step from X0 has ended at X1 with these.
    void end_step(const std::vector<double>& X0, const std::vector<double>& X1, std::vector<double> numbers) {
        before_ = {X0, at_start_};
        now_ = {X1, std::move(numbers)};
    }
    /// Other numbers for the step that begins where the last one ended.
    void amend(std::vector<double> numbers) { at_start_ = now_.numbers = std::move(numbers); }
    void mark_tangent(const std::vector<double>& X0) { at_tangent_ = {X0, at_start_}; }

    void write(std::vector<double>& m) const {
        for (const Record* r : {&now_, &before_, &at_tangent_}) {
            m.insert(m.end(), r->X.begin(), r->X.end());
            m.insert(m.end(), r->numbers.begin(), r->numbers.end());
        }
    }
    void read(const double*& m) {
        for (Record* r : {&now_, &before_, &at_tangent_})
            for (std::vector<double>* part : {&r->X, &r->numbers}) {
                std::copy_n(m, part->size(), part->begin());
                m += part->size();
            }
    }

  private:
    struct Record {
        std::vector<double> X, numbers;
    };
    std::vector<double> at_start_;
    Record now_, before_, at_tangent_;  // the latest, the one before, that of the kept tangent
};

}  // namespace visviva
