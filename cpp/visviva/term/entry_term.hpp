// Terms whose tangents are lists of scalar entries.
#pragma once
#include <utility>

#include "visviva/term/term.hpp"

namespace visviva {

class EntryTerm : public Term {
  public:
    void couple(Pattern&) const final;
    void connect(const Pattern&) final;

  protected:
    // (row, column) unknowns of every entry, and where these are among the values of the tangent.
    virtual void list_entries(std::vector<std::pair<int, int>>& entries) const = 0;
    virtual void set_positions(const std::vector<std::int64_t>& positions) = 0;
};

}  // namespace visviva
