// Whether two bodies lie in each other, as told by where their surfaces cross.
#pragma once
#include "visviva/contact/enclosure.hpp"

namespace visviva {

/// The deepest place found that lies in both bodies by more than `least`; depth 0 if none does.
DeepPlace find_overlap(const Enclosure& one, const Enclosure& two, double least);

}  // namespace visviva
