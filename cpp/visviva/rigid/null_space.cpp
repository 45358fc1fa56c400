// The discrete null-space reduction of rigid bodies [2]: rows premultiplied by P(q_g)^T, increments P(q1) u
// with P = {phi' = v, d_i' = w x d_i}, so that the 18 unknowns of a body (12 coordinates, 6 multipliers)
// become 6. The directors move by d_i <- R d_i, which keeps them orthonormal. What remains is solved by block
// elimination. The solution of a step is the one of the full system; only the way to it differs.
#include <algorithm>
#include <cmath>
#include <map>

#include "visviva/linear/block_lu.hpp"
#include "visviva/linear/linear.hpp"
#include "visviva/rigid/rigid_dispatch.hpp"

namespace visviva {

namespace {

void cross_add(const double* a, const double* b, double* c) {
    c[0] += a[1] * b[2] - a[2] * b[1];
    c[1] += a[2] * b[0] - a[0] * b[2];
    c[2] += a[0] * b[1] - a[1] * b[0];
}

struct Directors {
    double d[9];  // d1, d2, d3
};

double along(const Directors& f, int k, const double* t) {
    return f.d[3 * k] * t[0] + f.d[3 * k + 1] * t[1] + f.d[3 * k + 2] * t[2];
}

Directors gather(const RigidUnknowns& body, const double* x) {
    Directors f;
    for (int k = 0; k < 9; ++k) f.d[k] = x[body.q[3 + k]];
    return f;
}

Directors gather(const RigidUnknowns& body, const Place& place) {
    Directors f;
    for (int k = 0; k < 9; ++k) {
        const double x0 = place.x0[body.q[3 + k]];
        f.d[k] = x0 + place.theta_g * (place.x1[body.q[3 + k]] - x0);
    }
    return f;
}

// One Newton-Schulz sweep towards the nearest orthonormal frame: d <- d (I - (d^T d - I) / 2); returns the
// defect.
double orthonormalise(const Directors& f, double* change) {
    double e[3][3], largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            e[i][j] = (i == j ? -1.0 : 0.0);
            for (int c = 0; c < 3; ++c) e[i][j] += f.d[3 * i + c] * f.d[3 * j + c];
            largest = std::max(largest, std::abs(e[i][j]));
        }
    for (int j = 0; j < 3; ++j)
        for (int c = 0; c < 3; ++c) {
            change[3 * j + c] = 0;
            for (int i = 0; i < 3; ++i) change[3 * j + c] -= 0.5 * f.d[3 * i + c] * e[i][j];
        }
    return largest;
}

class NullSpace : public LinearSolver, public RigidSolver {
  public:
    NullSpace() { report_.name = "block LU of the null-space reduced system"; }

    void analyze(const Csr& pattern, const Blocks& blocks) override {
        csr_ = &pattern;
        rigid_ = blocks.rigid;
        number_unknowns(blocks);
        collect_entries();
        std::vector<std::pair<int, int>> pairs;
        for (const Group& g : groups_)
            if (g.i != g.j) pairs.push_back({g.i, g.j});
        lu_.analyze(size_, blocks.stage, pairs, multiplier_);
        report_.n_redundant = lu_.n_dependent();
        for (Group& g : groups_) g.target = lu_.block(g.i, g.j);
        right_.resize(lu_.n());
        lay_out_bodies();
        plain_.clear();
        unknown_at_.assign(lu_.n(), 0);
        is_multiplier_ = blocks.multiplier;
        for (int b = 0; b < static_cast<int>(size_.size()); ++b) {
            for (int k = 0; rigid_of_[b] < 0 && k < size_[b]; ++k)
                plain_.push_back({lu_.offset(b) + k, members_[b][k]});
        }
        for (const auto& [at, unknown] : plain_) unknown_at_[at] = unknown;
    }

    void project(const double* x0, double* dx) override {
        for (const RigidUnknowns& body : rigid_) {
            Directors f;
            for (int k = 0; k < 9; ++k) f.d[k] = x0[body.q[3 + k]] + dx[body.q[3 + k]];
            double change[9];
            for (int sweep = 0; sweep < 8; ++sweep) {
                const double defect = orthonormalise(f, change);
                for (int k = 0; k < 9; ++k) f.d[k] += change[k], dx[body.q[3 + k]] += change[k];
                if (defect < 1e-9) break;  // convergence is quadratic: the next defect is rounding
            }
        }
    }

    void balance(const double* r, const Place& place, double* dx, double* x1) override {
        rigid_kernels().balance(view_, r, place, dx, x1);
    }

    bool factor(const double* values, const Place& place) override {
        lu_.set_zero();
        for (const Group& g : groups_) {
            double f[12 * 12];
            const int rows = full_[g.i], cols = full_[g.j];
            big_.assign(static_cast<std::size_t>(rows) * cols, 0.0);
            double* a = rows * cols <= 144 ? f : big_.data();
            std::fill(a, a + rows * cols, 0.0);
            for (int k = g.begin; k < g.end; ++k)
                a[entries_[k].i * cols + entries_[k].j] += values[entries_[k].at];
            add_block(g, a, place);
        }
        const bool regular = lu_.factor(regularization);
        report_.singular_unknown = regular ? -1 : members_[lu_.singular_block()].front();
        report_.n_redundant = lu_.n_dependent();
        return regular;
    }

    bool solve(const double* r, const Place& place, double* d, double) override {
        reduced(r, place, d);
        rigid_kernels().expand(view_, right_.data(), place, d);
        return true;
    }

    bool solve_rates(const double* r, const Place& place, double* d) override {
        reduced(r, place, d);
        for (int b = 0; b < static_cast<int>(rigid_.size()); ++b) {
            const int* q = rigid_[b].q;
            const double* s = right_.data() + lu_.offset(block_[q[0]]);
            const Directors f = gather(rigid_[b], place.x1);
            double w[3], turned[9] = {};
            for (int c = 0; c < 3; ++c) w[c] = s[3] * f.d[c] + s[4] * f.d[3 + c] + s[5] * f.d[6 + c];
            for (int k = 0; k < 3; ++k) cross_add(w, f.d + 3 * k, turned + 3 * k);
            for (int c = 0; c < 3; ++c) d[q[c]] = s[c];
            for (int k = 0; k < 9; ++k) d[q[3 + k]] = turned[k];
        }
        return true;
    }

    void find_redundant(bool on) override {
        lu_.find_dependent(on);
        report_.n_redundant = lu_.n_dependent();
    }
    LinearCapabilities capabilities() override { return {this, nullptr}; }

  private:
    // The reduced solution, and that of the unknowns which are not those of bodies.
    void reduced(const double* r, const Place& place, double* d) {
        double* s = right_.data();
        for (const auto& [at, unknown] : plain_) s[at] = -r[unknown];
        rigid_kernels().force(view_, r, place, s);
        for (const LuGauge& g : lu_.gauges()) apply(g, place, s);
        lu_.solve(s);
        for (const auto& [at, unknown] : plain_) d[unknown] = s[at];
    }

    struct Group {
        int i, j, begin, end;
        LuBlock target;
    };
    struct Entry {
        int i, j;
        std::int64_t at;
    };

    // Multipliers that have no effect go to zero: the gauge g.row g.column^T acts on them, not on their
    // increment.
    void apply(const LuGauge& g, const Place& place, double* s) const {
        double effect = 0;
        for (int k = 0; k < g.n; ++k) {
            const int u = unknown_at_[g.x + k];
            if (is_multiplier_[u]) effect += g.column[k] * place.x1[u];
        }
        for (int k = 0; k < g.n; ++k) s[g.x + k] -= effect * g.row[k];
    }

    void number_unknowns(const Blocks& blocks) {
        const int n_blocks = static_cast<int>(blocks.stage.size());
        members_.assign(n_blocks, {}), rigid_of_.assign(n_blocks, -1);
        block_ = blocks.block;
        local_.assign(block_.size(), -1);
        for (int b = 0; b < static_cast<int>(rigid_.size()); ++b) {
            const int home = block_[rigid_[b].q[0]];
            rigid_of_[home] = b;
            for (int k = 0; k < 12; ++k) local_[rigid_[b].q[k]] = k, members_[home].push_back(rigid_[b].q[k]);
        }
        for (int u : csr_->unknown)
            if (rigid_of_[block_[u]] < 0) {
                local_[u] = static_cast<int>(members_[block_[u]].size());
                members_[block_[u]].push_back(u);
            }
        size_.clear(), full_.clear(), multiplier_.clear();
        for (int b = 0; b < n_blocks; ++b) {
            full_.push_back(static_cast<int>(members_[b].size()));
            size_.push_back(rigid_of_[b] < 0 ? full_[b] : 6);
            for (int k = 0; k < size_[b]; ++k)
                multiplier_.push_back(rigid_of_[b] < 0 ? blocks.multiplier[members_[b][k]] : 0);
        }
    }

    void collect_entries() {
        std::map<std::pair<int, int>, std::vector<Entry>> by_block;
        for (int i = 0; i < csr_->n; ++i)
            for (auto k = csr_->row[i]; k < csr_->row[i + 1]; ++k) {
                const int u = csr_->unknown[i], v = csr_->unknown[csr_->col[k]];
                if (local_[u] < 0 || local_[v] < 0) continue;  // multipliers of orthonormality
                by_block[{block_[u], block_[v]}].push_back({local_[u], local_[v], k});
            }
        groups_.clear(), entries_.clear();
        for (const auto& [ij, list] : by_block) {
            const int begin = static_cast<int>(entries_.size());
            entries_.insert(entries_.end(), list.begin(), list.end());
            groups_.push_back({ij.first, ij.second, begin, static_cast<int>(entries_.size()), {}});
        }
    }

    // P^T a P into the elimination's storage; a is row-major, full_[i] x full_[j].
    void add_block(const Group& g, const double* a, const Place& place) {
        const int rows = full_[g.i], cols = full_[g.j];
        double left[6 * 12];
        int n = rows;
        if (rigid_of_[g.i] >= 0) {
            const RigidUnknowns& body = rigid_[rigid_of_[g.i]];
            if (cols > 12) wide_.assign(static_cast<std::size_t>(6) * cols, 0.0);
            double* l = cols > 12 ? wide_.data() : left;
            reduce_rows(a, cols, gather(body, place), gather(body, place.x1), l);
            a = l, n = 6;
        }
        const LuBlock& target = g.target;
        if (rigid_of_[g.j] < 0) {
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < cols; ++j) target(i, j) += a[i * cols + j];
            return;
        }
        const Directors f = gather(rigid_[rigid_of_[g.j]], place.x1);
        for (int i = 0; i < n; ++i) {
            double t[3] = {0, 0, 0};
            for (int k = 0; k < 3; ++k) cross_add(f.d + 3 * k, a + i * cols + 3 + 3 * k, t);
            for (int c = 0; c < 3; ++c) target(i, c) += a[i * cols + c];
            for (int c = 0; c < 3; ++c) target(i, 3 + c) += along(f, c, t);
        }
    }

    // Rows of forces to force and torque; the torque by its components along the directors f1.
    static void reduce_rows(const double* a, int cols, const Directors& f, const Directors& f1, double* l) {
        for (int j = 0; j < cols; ++j) {
            double t[3] = {0, 0, 0};
            for (int k = 0; k < 3; ++k) {
                const double force[3] = {a[(3 + 3 * k) * cols + j], a[(4 + 3 * k) * cols + j],
                                         a[(5 + 3 * k) * cols + j]};
                cross_add(f.d + 3 * k, force, t);
            }
            for (int c = 0; c < 3; ++c)
                l[c * cols + j] = a[c * cols + j], l[(3 + c) * cols + j] = along(f1, c, t);
        }
    }

    // The bodies in the layout of the kernels; the last one fills the padding.
    void lay_out_bodies() {
        const int n = static_cast<int>(rigid_.size()), stride = (n + 7) / 8 * 8;
        q_.assign(static_cast<std::size_t>(12) * stride, 0),
            lambda_.assign(static_cast<std::size_t>(6) * stride, 0);
        at_.assign(stride, 0);
        for (int e = 0; e < stride && n > 0; ++e) {
            const RigidUnknowns& body = rigid_[std::min(e, n - 1)];
            for (int k = 0; k < 12; ++k) q_[static_cast<std::size_t>(k) * stride + e] = body.q[k];
            for (int k = 0; k < 6; ++k)
                lambda_[static_cast<std::size_t>(k) * stride + e] = body.multiplier[k];
            at_[e] = lu_.offset(block_[body.q[0]]);
        }
        view_ = {n, stride, q_.data(), lambda_.data(), at_.data()};
    }

    const Csr* csr_ = nullptr;
    BlockLU lu_;
    std::vector<RigidUnknowns> rigid_;
    std::vector<int> block_, local_, size_, full_, rigid_of_;
    std::vector<char> multiplier_, is_multiplier_;
    std::vector<int> unknown_at_;
    std::vector<std::vector<int>> members_;
    std::vector<Group> groups_;
    std::vector<Entry> entries_;
    std::vector<std::pair<int, int>> plain_;  // place in the right-hand side, unknown
    RigidView view_;
    std::vector<int> q_, lambda_, at_;
    std::vector<double> right_, big_, wide_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_null_space() { return std::make_unique<NullSpace>(); }

}  // namespace visviva
