/// @file fclib_numbers.hpp
/// Numbers and texts of FCLIB files.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/h5/h5.hpp"
#include "io/h5/h5_read.hpp"

namespace tetwarp::fclib {

/// A number of rows or entries that a file must have, and the reason, for messages.
struct Expected {
  std::int64_t count = 0;
  std::string reason;  ///< "three per contact"
};

/// Number of elements of a dataset of numbers of any shape. Throws IoError beyond 2^31 - 1, the
/// largest number of rows that can be indexed.
std::int64_t element_count(const h5::Dataset& dataset);

/// The one number of a dataset of integers.
std::int64_t read_integer(const h5::Object& parent, const std::string& name);

/// All numbers of a dataset of integers.
std::vector<std::int64_t> read_integers(const h5::Object& parent, const std::string& name);

/// All numbers of a dataset. Throws IoError when one is not finite.
std::vector<double> read_reals(const h5::Object& parent, const std::string& name);

/// The same, throwing IoError before reading unless it has as many as expected.
std::vector<double> read_reals(const h5::Object& parent,
                               const std::string& name,
                               const Expected& expected);

/// A text; empty when the child is missing or holds no single text.
std::string read_text(const h5::Object& parent, const std::string& name);

/// Numbers as int32, FCLIB's integers. Throws IoError when one does not fit.
void write_integers(const h5::Object& parent,
                    const std::string& name,
                    const std::vector<std::int64_t>& values);
void write_reals(const h5::Object& parent,
                 const std::string& name,
                 const std::vector<double>& values);
void write_text(const h5::Object& parent, const std::string& name, const std::string& text);

}  // namespace tetwarp::fclib
