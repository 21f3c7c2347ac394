/// @file fclib_left_out.hpp
/// What of an FCLIB file is not read.
#pragma once
#include <string>
#include <vector>

#include "io/h5/h5.hpp"

namespace tetwarp::fclib {

/// ContactFileHeader::not_read of an open file.
std::vector<std::string> left_out(const h5::Object& file);

}  // namespace tetwarp::fclib
