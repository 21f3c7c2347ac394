/// @file checks.hpp
/// Checks of single fields of a contact problem, for check_problem(). Each throws
/// ContactProblemError, whose text is one line: field, index, what is wrong, how to correct it.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// The shortest decimal text that is read as exactly this number.
std::string text_of(double value);

/// "[index]: "
std::string at(std::int64_t index);

/// @param meaning  what the expected number of entries is; the message ends with it
void check_size(const std::string& field,
                std::size_t size,
                std::int64_t expected,
                const char* meaning);

void check_finite(const std::string& field, std::span<const double> values);

/// All values finite and 0 or more.
/// @param remedy  the message ends with it
void check_not_negative(const std::string& field,
                        std::span<const double> values,
                        const char* remedy);

/// Row starts and columns lie within the arrays and the matrix; values are finite.
void check_rows(const std::string& field, const SparseMatrix& matrix);

/// Symmetric up to 1e-9 of the largest entry in either row, with both triangles stored.
/// @pre has_sorted_rows(system)
void check_symmetric(const SparseMatrix& system);

/// Each diagonal block of the system has a Cholesky factorization with pivots above 1e-14 of their
/// diagonal entries. The system as a whole is not factorized here; see SystemFactor.
/// @param starts  first dof of each block, then the dof count
/// @pre has_sorted_rows(system)
void check_positive_blocks(const SparseMatrix& system, std::span<const std::int32_t> starts);

}  // namespace tetwarp
