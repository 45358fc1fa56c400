// Elastic tractions of friction from step to step, two numbers for each gap. They belong to a configuration
// of the vertices: a step may be looked at again, or a kept tangent be made again.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "visviva/contact/friction.hpp"

namespace visviva {

class ElasticSlip {
  public:
    void resize(std::size_t n_positions, int n_gaps) {
        at_start_.assign(2 * n_gaps, 0.0);
        for (Record* r : {&now_, &before_, &at_tangent_})
            *r = {std::vector<double>(n_positions, 0.0), at_start_};
    }
    /// The traction at a gap when the step begins.
    Eigen::Vector2d at_start(int gap) const { return {at_start_[2 * gap], at_start_[2 * gap + 1]}; }

    /// A step begins at X.
    void begin_step(const std::vector<double>& X) {
        const Record* record = &now_;
        for (const Record* r : {&at_tangent_, &before_, &now_})
            if (r->X == X) record = r;
        at_start_ = record->traction;
    }
    /// A step from X0 has ended at X1.
    void end_step(const std::vector<double>& X0, const std::vector<double>& X1,
                  const std::vector<Traction>& tractions) {
        before_ = {X0, at_start_};
        now_.X = X1;
        for (std::size_t gap = 0; gap < tractions.size(); ++gap)
            for (int i = 0; i < 2; ++i) now_.traction[2 * gap + i] = tractions[gap].value[i];
    }
    void mark_tangent(const std::vector<double>& X0) { at_tangent_ = {X0, at_start_}; }

    void write(std::vector<double>& m) const {
        for (const Record* r : {&now_, &before_, &at_tangent_}) {
            m.insert(m.end(), r->X.begin(), r->X.end());
            m.insert(m.end(), r->traction.begin(), r->traction.end());
        }
    }
    void read(const double*& m) {
        for (Record* r : {&now_, &before_, &at_tangent_})
            for (std::vector<double>* part : {&r->X, &r->traction}) {
                std::copy_n(m, part->size(), part->begin());
                m += part->size();
            }
    }

  private:
    struct Record {
        std::vector<double> X, traction;
    };
    std::vector<double> at_start_;
    Record now_, before_, at_tangent_;  // the latest, the one before, that of the kept tangent
};

}  // namespace visviva
