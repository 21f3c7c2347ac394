/// @file interruption.cpp
/// Refuses a call of an object in which another call runs.
#include "python/interruption.hpp"

#include <stdexcept>
#include <string>

namespace tetwarp::python {

OneCall::OneCall(std::atomic<bool>& is_running, const char* object) : is_running_(is_running) {
  if (is_running_.exchange(true)) {
    throw std::runtime_error(std::string(object) + ": a call of this object is running");
  }
}

}  // namespace tetwarp::python
