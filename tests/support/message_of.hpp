/// @file message_of.hpp
/// The text of an exception.
#pragma once
#include <stdexcept>
#include <string>

namespace tetwarp::test {

/// The text of the Error that `op` throws; empty when it throws none.
template <class Error = std::invalid_argument, class Op>
std::string message_of(const Op& op) {
  try {
    op();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace tetwarp::test
