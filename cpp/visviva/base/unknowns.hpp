// Vectors of all unknowns, of which some are never written: their memory is zero until it is, and takes no
// room until then. They are made in their final size, for what grows into room that it had before is not
// zero.
#pragma once
#include <algorithm>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

namespace visviva {

template <class T>
struct ZeroAllocator {
    using value_type = T;

    ZeroAllocator() = default;
    template <class U>
    ZeroAllocator(const ZeroAllocator<U>&) {}
    T* allocate(std::size_t n) {
        if (void* p = std::calloc(n, sizeof(T))) return static_cast<T*>(p);
        throw std::bad_alloc();
    }
    void deallocate(T* p, std::size_t) { std::free(p); }
    template <class U>
    void construct(U*) {}
    template <class U, class... Given>
    void construct(U* p, Given&&... given) {
        ::new (static_cast<void*>(p)) U(std::forward<Given>(given)...);
    }
    friend bool operator==(const ZeroAllocator&, const ZeroAllocator&) { return true; }
};

using Unknowns = std::vector<double, ZeroAllocator<double>>;

inline bool is_zero(const Unknowns& u) {
    return std::all_of(u.begin(), u.end(), [](double value) { return value == 0; });
}

// A copy to be brought back, of zeros alone none.
class KeptUnknowns {
  public:
    explicit KeptUnknowns(const Unknowns& u) : size_(u.size()) {
        if (!is_zero(u)) values_ = u;
    }
    void bring_back(Unknowns& u) const {
        if (!values_.empty())
            u = values_;
        else if (u.size() != size_)
            u = Unknowns(size_);
        else if (!is_zero(u))
            std::fill(u.begin(), u.end(), 0.0);
    }

  private:
    std::size_t size_;
    Unknowns values_;
};

}  // namespace visviva
