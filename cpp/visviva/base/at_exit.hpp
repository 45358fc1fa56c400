// Guard that puts things back however a scope is left: functions from outside may throw anywhere.
#pragma once
#include <utility>

namespace visviva {

template <class F>
class AtExit {
  public:
    explicit AtExit(F f) : f_(std::move(f)) {}
    AtExit(const AtExit&) = delete;
    AtExit& operator=(const AtExit&) = delete;
    ~AtExit() { f_(); }

  private:
    F f_;
};

}  // namespace visviva
