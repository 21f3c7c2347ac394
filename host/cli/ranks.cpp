/// @file ranks.cpp
/// What mpirun tells its children before they say a word: Open MPI's and MPICH's names.
#include "host/cli/ranks.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <initializer_list>
#include <thread>

namespace tetwarp::cli {

namespace {

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

void wait_for_turn() {
  constexpr int longest = 20;
  std::this_thread::sleep_for(std::min(launched_rank(), longest) * std::chrono::milliseconds(100));
}

}  // namespace tetwarp::cli
