// Two processes, played by threads, that share the terms of a system: they decide and end as one that has all
// terms.
#include <doctest/doctest.h>

#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "dense.hpp"
#include "visviva/system/system.hpp"
#include "visviva/term/mirror.hpp"
#include "visviva/term/pattern.hpp"

using namespace visviva;

namespace {

// Where both bring arrays and take their sum or the largest; who waits for one that never comes gives up.
class Meeting {
  public:
    template <class F>
    void combine(double* values, std::size_t n, F both) {
        std::unique_lock lock(mutex_);
        if (waiting_ == nullptr) {
            waiting_ = values, size_ = n;
            const int round = round_;
            const bool met = came_.wait_for(lock, std::chrono::seconds(20), [&] { return round_ != round; });
            if (!met || !fits_) throw std::runtime_error("the other one did something else");
            return;
        }
        fits_ = size_ == n;
        for (std::size_t i = 0; fits_ && i < n; ++i) values[i] = waiting_[i] = both(waiting_[i], values[i]);
        waiting_ = nullptr, ++round_;
        came_.notify_all();
        if (!fits_) throw std::runtime_error("the other one did something else");
    }

  private:
    std::mutex mutex_;
    std::condition_variable came_;
    double* waiting_ = nullptr;
    std::size_t size_ = 0;
    int round_ = 0;
    bool fits_ = true;
};

class One : public Processes {
  public:
    One(Meeting& meeting, int rank) : meeting_(meeting), rank_(rank) {}
    std::vector<char> own(const std::vector<int>& unknowns, int n) override {
        std::vector<double> last(n, 0.0);  // the second, where it has an equation, and else the first
        for (int u : unknowns) last[u] = rank_ + 1;
        meeting_.combine(last.data(), last.size(), [](double a, double b) { return std::max(a, b); });
        std::vector<char> mine(n, 0);
        for (int u : unknowns) mine[u] = last[u] == rank_ + 1;
        return mine_ = mine;
    }
    void sum(double* values, std::size_t n) override {
        meeting_.combine(values, n, [](double a, double b) { return a + b; });
    }
    double largest(double value) override {
        meeting_.combine(&value, 1, [](double a, double b) { return std::max(a, b); });
        return value;
    }
    void share(double* d, std::size_t n) override {
        for (std::size_t u = 0; u < n; ++u)
            if (!mine_[u]) d[u] = 0;
        sum(d, n);
    }
    void tell(std::string& words, int& number) override {
        std::vector<double> all(2 * most, 0.0);
        double* mine = all.data() + most * static_cast<std::size_t>(rank_);
        mine[0] = static_cast<double>(words.size()), mine[1] = number;
        std::copy(words.begin(), words.end(), mine + 2);
        sum(all.data(), all.size());
        const double* first = all.data() + (all[0] > 0 ? 0 : most);
        words.assign(first + 2, first + 2 + static_cast<int>(first[0]));
        number = static_cast<int>(first[1]);
    }

  private:
    static constexpr std::size_t most = 100;
    Meeting& meeting_;
    int rank_;
    std::vector<char> mine_;
};

// Adds up the parts of the matrix.
class Dense : public LinearSolver {
  public:
    Dense(int n, Processes* together, int fails = -1) : n_(n), K_(n, n), together_(together), left_(fails) {}
    void analyze(const Csr& csr, const Blocks&) override { csr_ = &csr; }
    bool factor(const double* values, const Place&) override {
        K_.setZero();
        for (int i = 0; i < csr_->n; ++i)
            for (auto k = csr_->row[i]; k < csr_->row[i + 1]; ++k)
                K_(csr_->unknown[i], csr_->unknown[csr_->col[k]]) = values[k];
        if (together_) together_->sum(K_.data(), static_cast<std::size_t>(K_.size()));
        return left_-- != 0;
    }
    bool solve(const double* r, const Place&, double* d, double) override {
        Eigen::VectorXd all = Eigen::VectorXd::Map(r, n_);
        if (together_) together_->sum(all.data(), static_cast<std::size_t>(n_));
        Eigen::VectorXd::Map(d, n_) = K_.fullPivLu().solve(-all);
        return true;
    }

  private:
    int n_;
    Eigen::MatrixXd K_;
    Processes* together_;
    int left_;  // factorisations until one fails, in this process alone
    const Csr* csr_ = nullptr;
};

// Springs between unknowns 0, 1 and the ground, a load that grows with time, and a multiplier that holds x1
// by x0.
class Frame : public Term {
  public:
    void couple(Pattern& p) const override {
        for (int a : {0, 1, 3})
            for (int b : {0, 1, 3}) p.couple(a, b);
    }
    void connect(const Pattern& p) override {
        for (int a : {0, 1, 3})
            for (int b : {0, 1, 3}) at_[a][b] = p.position(a, b);
    }
    void residual(const Context& c, double* r) override {
        const double *x = c.vectors.x1, apart = x[0] - x[1];
        r[0] += 2 * x[0] + 5 * apart - 6 * c.step.t1 + 0.5 * x[3];
        r[1] += -5 * apart - x[3];
        r[3] += 0.5 * x[0] - x[1] + 0.1 * c.step.t1;
    }
    void tangent(const Context&, double* values) override {
        values[at_[0][0]] += 7, values[at_[1][1]] += 5, values[at_[0][1]] -= 5, values[at_[1][0]] -= 5;
        values[at_[0][3]] += 0.5, values[at_[3][0]] += 0.5, values[at_[1][3]] -= 1, values[at_[3][1]] -= 1;
    }
    void ledger(const Context&, const double*, LedgerSums&) override {}

  private:
    std::int64_t at_[4][4];
};

// A stop at x1 = 1, and a spring to unknown 2 that is found beyond 0.6: branches and a new pattern.
class Stop : public Term, public NeighbourSearch {
  public:
    void couple(Pattern& p) const override {
        p.couple(1, 1), p.couple(2, 2);
        if (near_) p.couple(1, 2), p.couple(2, 1);
    }
    void connect(const Pattern& p) override {
        for (int a : {1, 2})
            for (int b : {1, 2})
                if (a == b || near_) at_[a - 1][b - 1] = at_or_behind(p, a, b);
    }
    void residual(const Context& c, double* r) override {
        const double* x = c.vectors.x1;
        closed_ = x[1] > 1;
        if (closed_) r[1] += 300 * (x[1] - 1);
        r[2] += x[2] * x[2] * x[2] + x[2];
        if (near_) r[1] += x[1] - x[2], r[2] += x[2] - x[1];
    }
    void tangent(const Context& c, double* values) override {
        was_closed_ = closed_;
        if (closed_) values[at_[0][0]] += 300;
        values[at_[1][1]] += 3 * c.vectors.x1[2] * c.vectors.x1[2] + 1;
        if (!near_) return;
        values[at_[0][0]] += 1, values[at_[1][1]] += 1, values[at_[0][1]] -= 1, values[at_[1][0]] -= 1;
    }
    void ledger(const Context&, const double*, LedgerSums&) override {}
    TermCapabilities capabilities() override { return {.search = this}; }
    bool find_neighbours(const Way& way) override {
        const bool before = near_;
        near_ = way.x0[1] > 0.6;
        n_patterns += near_ != before;
        return near_ != before;
    }
    bool is_outdated() const override { return closed_ != was_closed_; }
    double resolution() const override { return 1e-12; }
    Refusal refuse(const Context& c) override {
        if (c.step.t1 < 2.9) return {};
        return {1, "too much"};
    }
    int n_patterns = 0;

  private:
    // What has no equation here goes behind the last entry.
    static std::int64_t at_or_behind(const Pattern& p, int row, int col) {
        const std::int64_t at = p.position(row, col);
        return at < 0 ? p.n_entries() : at;
    }
    bool near_ = false, closed_ = false, was_closed_ = false;
    std::int64_t at_[2][2];
};

struct Found {
    std::vector<Unknowns> x;
    std::vector<int> iterations, factorizations;
    std::string refused;
    int n_patterns = 0;
};

// What another process adds is evaluated along by those that mirror it.
Found march(Meeting* meeting, int rank, int fails = -1, bool mirrors = false) {
    System system({2, 2, 2, 0}, {0, 0, 0, 0}, {1, 1, 1, 0});
    const auto stop = std::make_shared<Stop>();
    if (rank != 1) system.add(std::make_shared<Frame>());
    if (rank != 0) system.add(stop);
    if (rank == 0 && mirrors) system.add(std::make_shared<Mirror>(stop));
    std::unique_ptr<One> together;
    if (meeting) {
        system.set_processes(std::make_unique<One>(*meeting, rank));
        together = std::make_unique<One>(*meeting, rank);
    }
    system.set_accounts(1, 1), system.set_signal_count(1);
    system.set_judged({3});
    system.finalize();
    system.set_solver(std::make_unique<Dense>(4, together.get(), fails));
    Found found;
    for (int k = 1; k <= 6; ++k) {
        Step step;
        step.t0 = 0.5 * (k - 1), step.t1 = step.te = 0.5 * k, step.h = 0.5;
        const Report report = system.solve(step, system.no_signals(), {});
        found.iterations.push_back(report.iterations);
        found.factorizations.push_back(report.factorizations);
        if (!report.converged) {
            found.refused = report.reason;
            break;
        }
        if (!system.accept(step, system.no_signals(), true).converged) break;
        found.x.push_back(system.x);
    }
    found.n_patterns = stop->n_patterns;
    return found;
}

struct Both {
    std::array<Found, 2> found;
    std::array<std::string, 2> failed;
};

// The second one fails to factor after so many times.
Both march_both(int fails, bool mirrors = false) {
    Meeting meeting;
    Both both;
    auto run = [&](int rank) {
        try {
            both.found[rank] = march(&meeting, rank, rank == 1 ? fails : -1, mirrors);
        } catch (const std::exception& error) {
            both.failed[rank] = error.what();
        }
    };
    std::thread other(run, 1);
    run(0);
    other.join();
    return both;
}

}  // namespace

TEST_CASE("processes take the same branches, patterns, iterations and refusals as one") {
    const Found one = march(nullptr, -1);
    REQUIRE(one.x.size() == 5);
    CHECK(one.n_patterns == 1);
    CHECK(one.refused == "too much");
    CHECK(one.x.back()[1] > 1);  // at the stop

    const auto [found, failed] = march_both(-1);
    CHECK(found[0].refused == "too much");
    CHECK(found[1].refused == "too much");
    for (int rank : {0, 1}) {
        CHECK(failed[rank].empty());
        CHECK(found[rank].iterations == one.iterations);
        CHECK(found[rank].factorizations == one.factorizations);
        REQUIRE(found[rank].x.size() == one.x.size());
        for (std::size_t k = 0; k < one.x.size(); ++k)
            for (int u = 0; u < 4; ++u)
                CHECK(found[rank].x[k][u] == doctest::Approx(one.x[k][u]).epsilon(1e-12));
    }
}

TEST_CASE("what another process adds decides the same where it is mirrored") {
    const Found one = march(nullptr, -1);
    const auto [found, failed] = march_both(-1, true);
    for (int rank : {0, 1}) {
        CHECK(failed[rank].empty());
        CHECK(found[rank].refused == "too much");
        CHECK(found[rank].n_patterns == 1);
        CHECK(found[rank].iterations == one.iterations);
        REQUIRE(found[rank].x.size() == one.x.size());
        for (int u = 0; u < 4; ++u)
            CHECK(found[rank].x.back()[u] == doctest::Approx(one.x.back()[u]).epsilon(1e-12));
    }
}

TEST_CASE("what one process cannot factor, none goes on with") {
    const auto [found, failed] = march_both(3);
    for (int rank : {0, 1}) {
        CHECK(failed[rank].empty());
        CHECK(found[rank].refused == "the tangent is singular");
        CHECK(found[rank].iterations == found[1].iterations);
        CHECK(found[rank].x.size() < 5);
    }
}
