/// @file fclib_matrix.cpp
/// Matrices of FCLIB files, in CSparse's three storages: `nz` = -1 by columns, -2 by rows, else the
/// number of triplets. Arrays may be longer than the number of entries.
#include "io/fclib/fclib_matrix.hpp"

#include <algorithm>
#include <tetwarp/error.hpp>
#include <utility>

#include "io/fclib/fclib_numbers.hpp"
#include "io/h5/h5_write.hpp"

namespace tetwarp::fclib {
namespace {
constexpr std::int64_t by_columns = -1;
constexpr std::int64_t by_rows = -2;

/// Row, column and value of every entry.
struct Triplets {
  std::vector<std::int64_t> row;
  std::vector<std::int64_t> column;
  std::vector<double> value;
};

std::string edges_of(std::int64_t rows, std::int64_t columns) {
  return std::to_string(rows) + " x " + std::to_string(columns);
}

void check_edges(const h5::Object& group, const Expected& rows, const Expected& columns) {
  const std::int64_t m = read_integer(group, "m");
  const std::int64_t n = read_integer(group, "n");
  if (m == rows.count && n == columns.count) return;
  const bool is_transposed = m == columns.count && n == rows.count;
  group.fail("is " + edges_of(m, n) + ", expected " + edges_of(rows.count, columns.count) + " (" +
             rows.reason + " x " + columns.reason + ")" +
             (is_transposed ? "; store its transpose" : ""));
}

/// Cuts an array to `count` entries. Throws IoError when it has fewer.
template <class T>
void keep_first(const h5::Object& group,
                const std::string& name,
                std::vector<T>& values,
                std::int64_t count) {
  const auto there = static_cast<std::int64_t>(values.size());
  if (there < count) {
    throw IoError(group.file, group.name + "/" + name,
                  "holds " + std::to_string(there) + " entries, expected " + std::to_string(count) +
                      ", the number that nz or p gives");
  }
  values.resize(static_cast<std::size_t>(count));
}

bool are_below(const std::vector<std::int64_t>& indices, std::int64_t limit) {
  return std::all_of(indices.begin(), indices.end(),
                     [limit](std::int64_t index) { return index >= 0 && index < limit; });
}

void check_indices(const h5::Object& group,
                   const std::string& name,
                   const std::vector<std::int64_t>& indices,
                   std::int64_t limit) {
  if (are_below(indices, limit)) return;
  const auto bad = std::find_if(indices.begin(), indices.end(),
                                [limit](std::int64_t i) { return i < 0 || i >= limit; });
  throw IoError(group.file, group.name + "/" + name,
                "entry " + std::to_string(bad - indices.begin()) + " is " + std::to_string(*bad) +
                    ", expected 0 to " + std::to_string(limit - 1) + "; indices count from 0");
}

/// The line (row or column) of every entry, from the offsets of the lines in `p`.
std::vector<std::int64_t> lines_of(const h5::Object& group, std::int64_t line_count) {
  const std::vector<std::int64_t> start = read_integers(group, "p");
  const auto refuse = [&group](const std::string& problem) {
    throw IoError(group.file, group.name + "/p", problem);
  };
  if (static_cast<std::int64_t>(start.size()) != line_count + 1) {
    refuse("holds " + std::to_string(start.size()) + " offsets, expected " +
           std::to_string(line_count + 1) + ": one more than rows or columns");
  }
  if (start.front() != 0) refuse("begins with " + std::to_string(start.front()) + ", expected 0");
  if (!std::is_sorted(start.begin(), start.end())) refuse("decreases, expected ascending offsets");
  const std::int64_t stored = element_count(h5::open_dataset(group, "i"));
  if (start.back() > stored) {
    refuse("ends with " + std::to_string(start.back()) + ", but i holds " + std::to_string(stored) +
           " entries");
  }
  std::vector<std::int64_t> lines(static_cast<std::size_t>(start.back()));
  for (std::size_t line = 0; line + 1 < start.size(); ++line) {
    std::fill(lines.begin() + start[line], lines.begin() + start[line + 1],
              static_cast<std::int64_t>(line));
  }
  return lines;
}

Triplets read_triplets(const h5::Object& group, std::int64_t rows, std::int64_t columns) {
  const std::int64_t nz = read_integer(group, "nz");
  if (nz < by_rows) {
    throw IoError(group.file, group.name + "/nz",
                  "is " + std::to_string(nz) +
                      ", expected -1 (by columns), -2 (by rows) or a number of triplets");
  }
  Triplets entries;
  entries.row = read_integers(group, "i");
  entries.value = read_reals(group, "x");
  if (nz < 0) {
    entries.column = lines_of(group, nz == by_columns ? columns : rows);
  } else {
    entries.column = read_integers(group, "p");
    keep_first(group, "p", entries.column, nz);
  }
  const auto count = static_cast<std::int64_t>(entries.column.size());
  keep_first(group, "i", entries.row, count);
  keep_first(group, "x", entries.value, count);
  // In FCLIB's documentation p has the rows of triplets; its writers put them in i, as CSparse.
  const bool has_rows_in_p =
      nz >= 0 && !(are_below(entries.row, rows) && are_below(entries.column, columns)) &&
      are_below(entries.row, columns) && are_below(entries.column, rows);
  if (nz == by_rows || has_rows_in_p) std::swap(entries.row, entries.column);
  const bool has_rows_in_i = nz != by_rows && !has_rows_in_p;
  check_indices(group, has_rows_in_i ? "i" : "p", entries.row, rows);
  check_indices(group, has_rows_in_i ? "p" : "i", entries.column, columns);
  return entries;
}

/// To rows; the entries of a row keep their order.
SparseMatrix compress(const Triplets& entries, std::int64_t rows, std::int64_t columns) {
  SparseMatrix matrix;
  matrix.rows = rows;
  matrix.columns = columns;
  matrix.row_start.resize(static_cast<std::size_t>(rows) + 1);
  matrix.column.resize(entries.row.size());
  matrix.value.resize(entries.row.size());
  for (const std::int64_t row : entries.row) ++matrix.row_start[static_cast<std::size_t>(row) + 1];
  for (std::size_t row = 1; row < matrix.row_start.size(); ++row) {
    matrix.row_start[row] += matrix.row_start[row - 1];
  }
  std::vector<std::int64_t> next(matrix.row_start.begin(), matrix.row_start.end() - 1);
  for (std::size_t entry = 0; entry < entries.row.size(); ++entry) {
    const auto row = static_cast<std::size_t>(entries.row[entry]);
    const auto place = static_cast<std::size_t>(next[row]++);
    matrix.column[place] = static_cast<std::int32_t>(entries.column[entry]);
    matrix.value[place] = entries.value[entry];
  }
  return matrix;
}
}  // namespace

SparseMatrix read_matrix(const h5::Object& parent,
                         const std::string& name,
                         const Expected& rows,
                         const Expected& columns,
                         Orientation orientation) {
  const h5::Object group = h5::open_group(parent, name);
  check_edges(group, rows, columns);
  Triplets entries = read_triplets(group, rows.count, columns.count);
  if (orientation == Orientation::plain) return compress(entries, rows.count, columns.count);
  std::swap(entries.row, entries.column);
  return compress(entries, columns.count, rows.count);
}

void write_matrix(const h5::Object& parent,
                  const std::string& name,
                  const SparseMatrix& matrix,
                  Orientation orientation) {
  const bool is_plain = orientation == Orientation::plain;
  const h5::Object group = h5::create_group(parent, name);
  write_integers(group, "nzmax", {static_cast<std::int64_t>(matrix.value.size())});
  write_integers(group, "m", {is_plain ? matrix.rows : matrix.columns});
  write_integers(group, "n", {is_plain ? matrix.columns : matrix.rows});
  write_integers(group, "nz", {is_plain ? by_rows : by_columns});
  write_integers(group, "p", matrix.row_start);
  write_integers(group, "i", {matrix.column.begin(), matrix.column.end()});
  write_reals(group, "x", matrix.value);
}

}  // namespace tetwarp::fclib
