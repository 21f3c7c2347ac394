/// @file ranks.cpp
/// What is known of ranks before MPI_Init: environment variables that mpirun of Open MPI and of
/// MPICH sets.
#include "host/cli/common/ranks.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <initializer_list>
#include <thread>

namespace tetwarp::cli {
namespace {
/// The value of the first of these environment variables that is set.
int number_of(std::initializer_list<const char*> names, int otherwise) {
  for (const char* name : names) {
    const char* const text = std::getenv(name);
    if (text != nullptr) return std::atoi(text);
  }
  return otherwise;
}
}  // namespace

int launched_rank() {
  return number_of({"OMPI_COMM_WORLD_RANK", "PMI_RANK"}, 0);
}

int launched_local_rank() {
  return number_of({"OMPI_COMM_WORLD_LOCAL_RANK", "MPI_LOCALRANKID"}, launched_rank());
}

int launched_count() {
  return number_of({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}, 1);
}

void delay_by_rank() {
  constexpr int max_steps = 20;
  std::this_thread::sleep_for(std::min(launched_rank(), max_steps) *
                              std::chrono::milliseconds(100));
}

}  // namespace tetwarp::cli
