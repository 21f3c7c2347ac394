/// @file message_of.hpp
/// The text of an exception.
#pragma once
#include <stdexcept>
#include <string>

namespace tetwarp::test {

/// The text of the Error that `body` throws; empty when it throws none.
template <class Error = std::invalid_argument, class Body>
std::string message_of(const Body& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace tetwarp::test
