/// @file fclib_left_out.hpp
/// What of an FCLIB file is not read.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// Paths of groups and datasets that read_contact_problem() and read_contact_header() do not know,
/// and of those that the form of the problem has no place for. A file with a solution, which is a
/// copy, keeps them.
TETWARP_IO_EXPORT std::vector<std::string> fclib_left_out(const std::string& path);

}  // namespace tetwarp
