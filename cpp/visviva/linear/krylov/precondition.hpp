// Preconditioners of the iterative solvers.
#pragma once
#include "visviva/linear/linear_choice.hpp"
#include "visviva/linear/node_matrix.hpp"

namespace visviva {

class Preconditioning {
  public:
    virtual ~Preconditioning() = default;
    // Takes the matrix, or keeps what it made of an earlier one; false: it cannot, see message().
    virtual bool build(const NodeMatrix& matrix) = 0;
    virtual void apply(const double* r, double* z) = 0;  // z = M^-1 r
    virtual double memory() const { return 0; }
    virtual const char* name() const = 0;
    std::string message;
    // Course of the last solution; whether what is kept from an earlier matrix should have been made anew.
    virtual void learn(int /*iterations*/) {}
    virtual bool kept() const { return false; }
    virtual void forget() {}
    // Whether M satisfies the rows of constraints exactly: then iterations that start from M^-1 b keep them
    // so.
    virtual bool starts_exact() const { return false; }
};

std::unique_ptr<Preconditioning> make_preconditioning(const LinearChoice&);
std::unique_ptr<Preconditioning> make_saddle();
std::unique_ptr<Preconditioning> make_augmented(const LinearChoice&);
std::unique_ptr<Preconditioning> make_commutator(const LinearChoice&);
std::unique_ptr<Preconditioning> make_mixture(const LinearChoice&);
std::unique_ptr<Preconditioning> make_multigrid(const LinearChoice&);

// Inverses of the diagonal blocks, of the diagonal alone if so wished; what is zero there stays as it is.
template <class T>
BlockRows<T> inverse_diagonal(const BlockReader& matrix, bool diagonal_alone);

}  // namespace visviva
