/// @file choices.hpp
/// Words of Python as enumerators.
#pragma once
#include <stdexcept>
#include <string>
#include <tetwarp/names.hpp>

namespace tetwarp::python {

/// @param argument  its name in the message
/// @throws std::invalid_argument  that lists the words
template <class Enum>
Enum choice(const char* argument, const std::string& word) {
  try {
    return parse<Enum>(word);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string(argument) + ": " + error.what());
  }
}

}  // namespace tetwarp::python
