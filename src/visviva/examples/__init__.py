"""Examples: each module has `study(**parameters)` and `check(result)`; `visviva run NAME` runs one."""
