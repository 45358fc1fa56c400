#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>

#include "visviva/linear/linear_choice.hpp"

namespace visviva {

namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

double number_in(const std::string& path) {
    double value = 0;
    std::ifstream(path) >> value;  // stays 0 for "max" and for what does not exist
    return value;
}

// The number behind a word in a file of such lines; 0 if there is none.
double number_behind(const std::string& word, const std::string& path) {
    std::ifstream file(path);
    std::string key, rest;
    double value = 0;
    while (file >> key >> value) {
        if (key == word) return value;
        std::getline(file, rest);
    }
    return 0;
}

// What a group may still take, if it has a limit. Files that are kept in memory for the next one who reads
// them count as used, but give way.
double left_in_group(const std::string& group, bool second) {
    const double limit = number_in(group + (second ? "/memory.max" : "/memory.limit_in_bytes"));
    if (limit <= 0 || limit > 1e18) return unlimited;
    const std::string stat = group + "/memory.stat", total = second ? "" : "total_";
    double used = number_in(group + (second ? "/memory.current" : "/memory.usage_in_bytes"));
    for (const char* kept : {"inactive_file", "active_file"}) used -= number_behind(total + kept, stat);
    return std::max(limit - used, 1.0);
}

// As `ulimit -v` allows.
double left_of_addresses() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
    const double used = number_in("/proc/self/statm") * static_cast<double>(sysconf(_SC_PAGESIZE));
    return std::max(static_cast<double>(limit.rlim_cur) - used, 1.0);
}

}  // namespace

double left_in_groups(const std::string& groups, const std::string& root) {
    double left = unlimited;
    std::ifstream file(groups);
    for (std::string line; std::getline(file, line);) {  // number:controllers:path
        const auto first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1);
        const bool unified = controllers.empty();
        if (!unified && ("," + controllers + ",").find(",memory,") == std::string::npos) continue;
        const std::string base = root + (unified ? "" : "/memory");
        // limits of all groups around it hold as well
        for (std::string path = line.substr(second + 1);; path.erase(path.rfind('/'))) {
            left = std::min(left, left_in_group(base + path, unified));
            if (path.find('/') == std::string::npos) break;
        }
    }
    return left;
}

double available_memory() {
    const double system = 1024 * number_behind("MemAvailable:", "/proc/meminfo");
    const double left = std::min(left_in_groups("/proc/self/cgroup", "/sys/fs/cgroup"), left_of_addresses());
    return std::min(system > 0 ? system : unlimited, left) < unlimited
               ? std::min(system > 0 ? system : unlimited, left)
               : 0;
}

void require_memory(double bytes, double limit, int n) {
    const double available = limit > 0 ? limit : available_memory();
    if (available <= 0 || bytes <= available) return;
    char text[400];
    std::snprintf(text, sizeof text,
                  "factoring the tangent of %d equations needs about %.3g GB, and %.3g GB are available; "
                  "use an iterative solver (Newton(linear=Iterative())), fewer unknowns, or a machine with "
                  "more memory",
                  n, bytes / 1e9, available / 1e9);
    throw MemoryShortage(text);
}

}  // namespace visviva
