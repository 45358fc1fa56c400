// Elements whose strains are quadratic in the unknowns, under laws of one or several of them.
#pragma once
#include "visviva/base/aligned.hpp"
#include "visviva/strain/strain.hpp"
#include "visviva/term/entry_term.hpp"
#include "visviva/term/law_callback.hpp"

namespace visviva {

class StrainTerm : public EntryTerm {
  public:
    // Arrays are given element-fastest without padding: weight [n_forms][n] and so on.
    StrainTerm(StrainShape shape, int n, const int* index, const double* weight, const double* y_const,
               const double* e_const, const double* par, int n_par, const int* signal);
    void set_callback(LawCallback f) { callback_ = std::move(f); }
    const StrainShape& shape() const { return shape_; }
    double* par() { return par_.data(); }
    int stride() const { return view_.stride; }

    void begin(const double* x0) override;
    void residual(const Context&, double* r) override;
    Refusal refuse(const Context&) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;

  private:
    void list_entries(std::vector<std::pair<int, int>>& entries) const override;
    void set_positions(const std::vector<std::int64_t>& positions) override;
    void make_program();
    void call_back(const Context&, bool want_tangent);

    StrainShape shape_;
    StrainView view_;
    LawCallback callback_;
    Aligned<double> weight_, y_const_, e_const_, par_, y0_, e0_, e_eval_, e_rate_, e1_, lambda_;
    Aligned<double> cb_S_, cb_D_, cb_R_, cb_Phi_, cb_J_, cb_Jt_, cb_W_, scratch_, out_;
    std::vector<int> index_, signal_, pairs_;
    std::vector<std::pair<int, int>> slots_;  // local (row, column) of every tangent entry
    std::vector<Product> products_;
    std::vector<Border> columns_, rows_;
    Aligned<std::int64_t> position_;
};

}  // namespace visviva
