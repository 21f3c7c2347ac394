/// @file checks.hpp
/// Checks that the fields of a contact problem share. Each throws ContactProblemError, whose text
/// is one line: field, index, what is wrong, what would mend it.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// Shortest text that reads back as the same number.
std::string text_of(double value);

/// "[index]: "
std::string at(std::int64_t index);

/// `meaning` says what the expected count counts.
void check_size(const std::string& field,
                std::size_t size,
                std::int64_t expected,
                const char* meaning);

void check_finite(const std::string& field, std::span<const double> values);

/// Finite and 0 or more; `remedy` ends the message.
void check_not_negative(const std::string& field,
                        std::span<const double> values,
                        const char* remedy);

/// Row starts, columns and values that can be walked without leaving the arrays.
void check_rows(const std::string& field, const SparseMatrix& matrix);

/// Symmetric to 1e-9 of the largest entry in either row; both triangles are stored.
/// @pre has_sorted_rows(system)
void check_symmetric(const SparseMatrix& system);

/// Each diagonal block of the system has a Cholesky factorization, no pivot of which is below 1e-14
/// of its diagonal entry. (Blocks only: the whole is factorized by whoever needs it.)
/// @param starts  first dof of each block, then the dof count
/// @pre has_sorted_rows(system)
void check_positive_blocks(const SparseMatrix& system, std::span<const std::int32_t> starts);

}  // namespace tetwarp
