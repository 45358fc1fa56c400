// oneMKL's PARDISO, opened at run time: nothing of it is needed to build, and without it other solvers serve.
#include <dlfcn.h>

#include <algorithm>
#include <cmath>

#include "visviva/base/parallel.hpp"
#include "visviva/linear/scaled.hpp"

namespace visviva {

namespace {

constexpr double accurate = 1e-8;  // a residual above it asks for a new analysis
constexpr double useless = 1e-4;   // a residual above it is no solution
enum { analysis = 11, factorization = 22, solution = 33, release_all = -1 };
// Factorisations are divided as for so many threads, however many there are: the same bits for any number.
constexpr int parts = 8;
enum { sequential_layer = 1, gnu_layer = 3 };  // of MKL_Set_Threading_Layer

struct Mkl {
    using Pardiso = void (*)(void** pt, const int* maxfct, const int* mnum, const int* mtype,
                             const int* phase, const int* n, const double* a, const int* ia, const int* ja,
                             int* perm, const int* nrhs, int* iparm, const int* msglvl, double* b, double* x,
                             int* error);
    Pardiso pardiso = nullptr;
    int (*set_threads)(int) = nullptr;
    std::string missing;
};

// With the GNU layer the process holds one OpenMP run-time only; MKL ends the process where it cannot load a
// layer, so look first.
void choose_layer(void* library) {
    auto* set = reinterpret_cast<int (*)(int)>(dlsym(library, "MKL_Set_Threading_Layer"));
    const bool openmp = dlopen("libgomp.so.1", RTLD_NOW | RTLD_GLOBAL) != nullptr;
    if (set) set(openmp ? gnu_layer : sequential_layer);
}

Mkl open_mkl(const std::string& path) {
    Mkl mkl;
    void* library = nullptr;
    for (const std::string& name : {path, std::string("libmkl_rt.so.3"), std::string("libmkl_rt.so.2")})
        if (!library && !name.empty()) library = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char* why = dlerror();
        mkl.missing = why ? why : "no oneMKL";
        return mkl;
    }
    choose_layer(library);
    mkl.pardiso = reinterpret_cast<Mkl::Pardiso>(dlsym(library, "pardiso"));
    mkl.set_threads = reinterpret_cast<int (*)(int)>(dlsym(library, "MKL_Set_Num_Threads_Local"));
    if (!mkl.pardiso || !mkl.set_threads) mkl.missing = "the library holds no PARDISO";
    return mkl;
}

// One library per process: the first that is asked for.
const Mkl& mkl_of(const std::string& path) {
    static const Mkl mkl = open_mkl(path);
    return mkl;
}

const char* meaning(int error) {
    switch (error) {
        case -2:
            return "PARDISO: not enough memory";
        case -3:
            return "PARDISO: the reordering failed";
        case -4:
            return "PARDISO: zero pivot";
        case -7:
            return "PARDISO: the diagonal matrix is singular";
        case -8:
            return "PARDISO: more than 2^31 entries";
        default:
            return "PARDISO: internal error";
    }
}

class Pardiso : public LinearSolver {
  public:
    explicit Pardiso(const LinearChoice& choice) : choice_(choice), mkl_(mkl_of(choice.library)) {
        regularization = choice.regularization;
        type_ = choice.kind == MatrixKind::definite ? 2 : choice.kind == MatrixKind::symmetric ? -2 : 11;
        report_.name = type_ == 2    ? "PARDISO, Cholesky"
                       : type_ == -2 ? "PARDISO, symmetric indefinite"
                                     : "PARDISO, LU";
        if (type_ == 2) report_.n_negative = 0;
    }
    Pardiso(const Pardiso&) = delete;
    Pardiso& operator=(const Pardiso&) = delete;
    ~Pardiso() override { release(); }

    void analyze(const Csr& pattern, const Blocks& blocks) override {
        release();
        matrix_.analyze(pattern, blocks, choice_.kind);
        b_.resize(matrix_.n()), s_.resize(matrix_.n());
    }

    bool factor(const double* values, const Place&) override {
        report_.message.clear(), report_.singular_unknown = -1;
        if (!matrix_.fill(values, regularization)) return failed(matrix_.message());
        const bool fresh = !analyzed_;
        if ((fresh && !run_analysis()) || !run_factorization()) return false;
        const bool again = !fresh && perturbed() > perturbed_when_analyzed_;
        if (again && !(run_analysis() && run_factorization())) return false;
        if (fresh || again) perturbed_when_analyzed_ = perturbed();
        return !(fresh || perturbed() > 0) || regular();
    }

    bool solve(const double* r, const Place&, double* d, double) override {
        report_.message.clear();
        matrix_.right_hand_side(r, b_.data());
        if (!run_solution()) return false;
        double residual = matrix_.residual(b_.data(), s_.data());
        if (!(residual <= accurate) && stale_) {  // the pivots were chosen for other values
            if (!run_analysis() || !run_factorization() || !run_solution()) return false;
            residual = matrix_.residual(b_.data(), s_.data());
        }
        if (!(residual <= useless)) {
            return failed("the tangent is singular to working precision (residual of the linear system " +
                          std::to_string(residual) + ")");
        }
        matrix_.increment(s_.data(), d);
        return true;
    }

    // Without matching the ordering knows the pattern alone; scaling and matching see values.
    void forget() override {
        if (matches()) release();
    }

  private:
    int call(int phase, double* b, double* x) {
        const int one = 1, none = 0, n = matrix_.n();
        int error = 0, unused = 0;
        const int before = mkl_.set_threads(threads_);
        mkl_.pardiso(pt_, &one, &one, &type_, &phase, &n, matrix_.value().data(), matrix_.row().data(),
                     matrix_.col().data(), &unused, &one, iparm_, &none, b, x, &error);
        mkl_.set_threads(before);
        return error;
    }

    void set_parameters() {
        std::fill(pt_, pt_ + 64, nullptr), std::fill(iparm_, iparm_ + 64, 0);
        iparm_[0] = 1;  // what follows is given
        iparm_[1] = ordering();
        iparm_[7] = matches() ? 2 : 0;     // steps of iterative refinement; 0: where pivots were perturbed
        iparm_[9] = type_ == 11 ? 13 : 8;  // pivots below 10^-this are perturbed
        iparm_[10] = matches() ? 1 : 0;    // scaling and
        iparm_[12] = matches() ? 1 : 0;    // matching: saddle points need both
        iparm_[17] = -1;                   // report the entries of the factors
        iparm_[20] = 1;                    // Bunch and Kaufman's pivots
        iparm_[33] = parts;
        iparm_[34] = 1;  // counted from zero
    }

    bool run_analysis() {
        release();
        threads_ = n_threads();  // what is allocated now, later phases use
        set_parameters();
        if (const int error = call(analysis, nullptr, nullptr)) return failed(meaning(error));
        analyzed_ = true, stale_ = false;
        report_.memory = 1024.0 * std::max(iparm_[14], iparm_[15] + iparm_[16]);
        require_memory(report_.memory, choice_.memory_limit, matrix_.n());
        return true;
    }

    bool run_factorization() {
        stale_ = factored_, factored_ = true;
        const int error = call(factorization, nullptr, nullptr);
        if (type_ == -2) report_.n_negative = iparm_[22];
        if (error == 0) return true;
        const bool known = error == -4 && iparm_[29] > 0;
        report_.singular_unknown = known ? matrix_.unknown(std::min(iparm_[29], matrix_.n()) - 1) : -1;
        if (error == -4 && type_ == 2) return failed("the tangent is not positive definite");
        return failed(meaning(error));
    }

    bool run_solution() {
        const int error = call(solution, b_.data(), s_.data());
        return error == 0 || failed(meaning(error));
    }

    // Rounding hides a singular matrix from the pivots; the solution to an arbitrary right-hand side shows
    // it.
    bool regular() {
        b_ = arbitrary_vector(matrix_.n());
        if (!run_solution()) return false;
        const auto largest = std::max_element(s_.begin(), s_.end(),
                                              [](double a, double b) { return std::abs(a) < std::abs(b); });
        if (!is_singular(s_, matrix_.residual(b_.data(), s_.data()), regularization)) return true;
        report_.singular_unknown = matrix_.unknown(static_cast<int>(largest - s_.begin()));
        return failed("the tangent is singular");
    }

    int ordering() const { return choice_.minimum_degree ? 0 : 2; }  // 2: nested dissection
    bool matches() const { return type_ != 2 && choice_.matching; }
    bool failed(const std::string& why) { return report_.message = why, false; }
    int perturbed() const { return type_ == 2 ? 0 : iparm_[13]; }

    void release() {
        if (analyzed_) call(release_all, nullptr, nullptr);
        analyzed_ = factored_ = stale_ = false;
    }

    LinearChoice choice_;
    const Mkl& mkl_;
    ScaledMatrix matrix_;
    void* pt_[64] = {};
    int iparm_[64] = {}, type_ = 11, perturbed_when_analyzed_ = 0, threads_ = 1;
    bool analyzed_ = false, factored_ = false;
    bool stale_ = false;  // factored with values that the analysis has not seen
    std::vector<double> b_, s_;
};

}  // namespace

std::string missing_pardiso(const std::string& library) { return mkl_of(library).missing; }

std::unique_ptr<LinearSolver> make_pardiso(const LinearChoice& choice) {
    return std::make_unique<Pardiso>(choice);
}

}  // namespace visviva
