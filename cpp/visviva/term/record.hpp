// Restart record of a part, under its name and with the version of its layout.
#pragma once
#include <stdexcept>
#include <string>
#include <vector>

namespace visviva {

struct Record {
    std::string name;
    int version = 1;
    std::vector<double> numbers;

    std::string titled() const { return "'" + name + "' (version " + std::to_string(version) + ")"; }
    // Refuses numbers that were not all read.
    void end(const double* read) const {
        if (read != numbers.data() + numbers.size())
            throw std::invalid_argument("the record " + titled() + " does not have the size that is read");
    }
};

// Two of the same layout: numbers apart.
inline bool are_alike(const Record& a, const Record& b) { return a.name == b.name && a.version == b.version; }

// The one of that name, or null.
inline const Record* record_named(const std::vector<Record>& all, const std::string& name) {
    for (const Record& record : all)
        if (record.name == name) return &record;
    return nullptr;
}

}  // namespace visviva
