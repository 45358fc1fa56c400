#pragma once
#include <nanobind/nanobind.h>

#include <stdexcept>
#include <string>
#include <utility>

#include "visviva/term/law_callback.hpp"
#include "visviva/term/term.hpp"

/// A function of Python that a term calls, with the interpreter's lock. Functions of the user often know the
/// system that calls them: Python owns them, and only weak references lie here, where the garbage collector
/// could not see the cycle.
class Callback {
  public:
    Callback(const visviva::Term* term, const nanobind::object& function)
        : term_(term), function_(function) {}

    template <class... Arguments>
    nanobind::object operator()(Arguments&&... arguments) const {
        const nanobind::object function = function_();
        if (function.is_none())
            throw std::runtime_error(term_->name + ": a function was called after its system was released");
        const Calling during(term_->name);
        return function(std::forward<Arguments>(arguments)...);
    }

    /// Name of the term whose function this thread is in; empty outside. Processes come to such functions
    /// each by itself, so that these cannot wait for others.
    static std::string caller() { return calling_ ? *calling_ : std::string(); }

  private:
    struct Calling {
        explicit Calling(const std::string& name) : outer(std::exchange(calling_, &name)) {}
        ~Calling() { calling_ = outer; }
        Calling(const Calling&) = delete;
        Calling& operator=(const Calling&) = delete;
        const std::string* outer;
    };
    inline static thread_local const std::string* calling_ = nullptr;

    const visviva::Term* term_;
    nanobind::weakref function_;
};

/// As the core calls it: f(n, want_tangent, t, h, discrete, arrays).
visviva::LawCallback law_callback(const visviva::Term* term, const nanobind::object& function);
