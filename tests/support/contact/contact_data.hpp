/// @file contact_data.hpp
/// The folder of contact problems with certified solutions.
#pragma once
#include <cstdlib>
#include <filesystem>

namespace tetwarp::test {

/// Named by the environment variable TETWARP_CONTACT_DATA, or by that macro; empty: neither is.
inline std::filesystem::path contact_data_folder() {
  if (const char* folder = std::getenv("TETWARP_CONTACT_DATA")) return folder;
#ifdef TETWARP_CONTACT_DATA
  return TETWARP_CONTACT_DATA;
#else
  return {};
#endif
}

}  // namespace tetwarp::test
