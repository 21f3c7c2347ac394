/// @file structure.cpp
/// Makes a structure in either form, and compares the patterns of problems.
#include "host/contact/structure/structure.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "host/contact/structure/indices.hpp"
#include "host/contact/structure/structure_global.hpp"
#include "host/contact/structure/structure_local.hpp"
#include "host/contact/structure/structure_parts.hpp"

namespace tetwarp {
namespace {
std::vector<std::int64_t> zeros_of(const ContactProblem& problem) {
  std::vector<std::int64_t> zeros;
  for_each_deciding_number(problem, [&](std::size_t e) {
    if (problem.system.value[e] == 0) zeros.push_back(static_cast<std::int64_t>(e));
  });
  return zeros;
}

/// Whether no entry of a matrix is stored twice.
bool is_unique(const SparseMatrix& matrix) {
  std::vector<std::int32_t> row;
  for (std::size_t r = 0; r + 1 < matrix.row_start.size(); ++r) {
    const auto first = matrix.column.begin() + matrix.row_start[r];
    const auto last = matrix.column.begin() + matrix.row_start[r + 1];
    const auto is_late = [](std::int32_t a, std::int32_t b) { return a >= b; };
    if (std::adjacent_find(first, last, is_late) == last) continue;  // increasing, the usual case
    row.assign(first, last);
    std::sort(row.begin(), row.end());
    if (std::adjacent_find(row.begin(), row.end()) != row.end()) return false;
  }
  return true;
}

ContactStructure empty_structure(bool is_local) {
  static std::atomic<std::int64_t> made = 0;
  ContactStructure structure;
  structure.serial = ++made;
  structure.is_local = is_local;
  return structure;
}
}  // namespace

ContactIndices ContactStructure::indices() const {
  return make_indices(*this, [](const auto& array) { return view_of(array); });
}

ContactStructure make_structure(const ContactProblem& problem, const ContactSkipOptions& skip) {
  HostStages stages;
  return make_structure(problem, skip, stages);
}

ContactStructure make_structure(const ContactProblem& problem,
                                const ContactSkipOptions& skip,
                                StructureStages& stages) {
  ContactStructure structure = empty_structure(problem.is_local());
  if (structure.is_local) {
    fill_local_structure(problem, skip, stages, structure);
    structure.matrix_is_unique = is_unique(problem.delassus);
  } else {
    fill_global_structure(problem, skip, stages, structure);
    structure.matrix_is_unique = is_unique(problem.system);
    structure.jacobian_is_unique = is_unique(problem.jacobian);
  }
  return structure;
}

ContactStructure make_dense_structure(std::int64_t contacts) {
  ContactStructure structure = empty_structure(true);
  fill_dense_structure(contacts, structure);
  return structure;
}

ContactPattern pattern_of(const ContactProblem& problem) {
  return {problem.delassus.row_start, problem.delassus.column, problem.system.row_start,
          problem.system.column,      zeros_of(problem),       problem.jacobian.row_start,
          problem.jacobian.column,    problem.block_start};
}

bool has_pattern(const ContactProblem& problem, const ContactPattern& pattern) {
  return problem.delassus.row_start == pattern.delassus_row &&
         problem.delassus.column == pattern.delassus_column &&
         problem.system.row_start == pattern.system_row &&
         problem.system.column == pattern.system_column &&
         zeros_of(problem) == pattern.system_zeros &&
         problem.jacobian.row_start == pattern.jacobian_row &&
         problem.jacobian.column == pattern.jacobian_column &&
         problem.block_start == pattern.block_start;
}

}  // namespace tetwarp
