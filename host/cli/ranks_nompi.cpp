/// @file ranks_nompi.cpp
/// Ranks of a build without MPI: one.
#include <stdexcept>

#include "host/cli/ranks.hpp"

namespace tetwarp::cli {

Ranks Ranks::start() {
  if (launched_count() > 1) {
    throw std::runtime_error(
        "this build knows no MPI; start it without mpirun, or build it with TETWARP_MPI=ON");
  }
  return {};
}

void Ranks::finish() {}
void Ranks::meet() const {}
void Ranks::share(std::span<std::byte>) const {}
double Ranks::least(double number) const {
  return number;
}
void Ranks::send(std::span<const std::byte>) {}
void Ranks::finish_sending() {}
void Ranks::receive(int, std::span<std::byte>) const {}
std::vector<std::vector<std::byte>> Ranks::gather(std::span<const std::byte> bytes) const {
  return {{bytes.begin(), bytes.end()}};
}
void abort_ranks(int) {}

}  // namespace tetwarp::cli
