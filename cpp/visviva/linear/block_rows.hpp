// Sparse matrices of small dense blocks.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

namespace visviva {

// Patterns change by little: room for some growth saves the memory from being made anew every time.
template <class T>
void assign_with_room(std::vector<T>& a, std::size_t n, T value) {
    if (a.capacity() < n) a.reserve(n + n / 8);
    a.assign(n, value);
}

// View of the kernels: block row i holds blocks row[i] .. row[i + 1], stored by columns.
template <class T>
struct BlockView {
    int rows, cols;  // of a block
    const std::int64_t* row;
    const int* col;
    const T* value;
};

template <class T>
struct BlockRows {
    static constexpr int padding = 8;  // vector loads reach beyond the last block

    int rows = 1, cols = 1;
    std::vector<std::int64_t> row = {0};
    std::vector<int> col;
    std::vector<T> value;  // [block][column][row], then padding

    int n() const { return static_cast<int>(row.size()) - 1; }
    std::size_t size() const { return static_cast<std::size_t>(n()) * rows; }
    std::size_t n_values() const { return col.size() * rows * cols; }
    T* block(std::int64_t k) { return value.data() + k * rows * cols; }
    const T* block(std::int64_t k) const { return value.data() + k * rows * cols; }
    void allocate() { assign_with_room(value, n_values() + padding, T(0)); }
    BlockView<T> view() const { return {rows, cols, row.data(), col.data(), value.data()}; }
};

// A matrix of blocks whose rows are asked for one by one: it need not have its values, if it can make them.
struct BlockReader {
    // The blocks of a row, in `room` if they are made for this call.
    using Row = std::function<const double*(int i, std::vector<double>& room)>;

    BlockReader(const BlockRows<double>& a)
        : pattern(a), row([&a](int i, std::vector<double>&) { return a.block(a.row[i]); }) {}
    BlockReader(const BlockRows<double>& a, Row of) : pattern(a), row(std::move(of)) {}

    int size_of_block() const { return pattern.rows * pattern.cols; }
    std::int64_t size_of_row(int i) const { return (pattern.row[i + 1] - pattern.row[i]) * size_of_block(); }

    const BlockRows<double>& pattern;
    Row row;
};

}  // namespace visviva
