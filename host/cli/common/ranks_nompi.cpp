/// @file ranks_nompi.cpp
/// Ranks in a build without MPI: always one.
#include <stdexcept>

#include "host/cli/common/ranks.hpp"

namespace tetwarp::cli {

Ranks Ranks::start() {
  if (launched_count() > 1) {
    throw std::runtime_error(
        "this build does not support MPI; start it without mpirun, or build it with "
        "TETWARP_MPI=ON");
  }
  return {};
}

void Ranks::finish() {}
void Ranks::wait_for_all() const {}
void Ranks::share(std::span<std::byte>) const {}
double Ranks::smallest(double number) const {
  return number;
}
void Ranks::send(std::span<const std::byte>) {}
void Ranks::finish_sending() {}
void Ranks::receive(int, std::span<std::byte>) const {}
std::vector<std::string> Ranks::gather(const std::string& text) const {
  return {text};
}
void abort_ranks(int) {}

}  // namespace tetwarp::cli
