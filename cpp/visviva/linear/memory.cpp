#include <algorithm>
#include <cstdio>
#include <fstream>

#include "visviva/linear/linear_choice.hpp"

namespace visviva {

static double number_in(const char* path) {
    double value = 0;
    std::ifstream(path) >> value;  // stays 0 for "max" and for what does not exist
    return value;
}

static double available_in_system() {
    std::ifstream file("/proc/meminfo");
    std::string key, unit;
    double kilobytes = 0;
    while (file >> key >> kilobytes) {
        if (key == "MemAvailable:") return 1024 * kilobytes;
        std::getline(file, unit);
    }
    return 0;
}

double available_memory() {
    const double system = available_in_system();
    const double limit = number_in("/sys/fs/cgroup/memory.max");
    if (limit <= 0) return system;
    const double left = std::max(limit - number_in("/sys/fs/cgroup/memory.current"), 1.0);
    return system > 0 ? std::min(system, left) : left;
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
