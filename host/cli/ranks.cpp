/// @file ranks.cpp
/// What mpirun tells its children before they say a word: Open MPI's and MPICH's names.
#include "host/cli/ranks.hpp"

#include <cstdlib>
#include <initializer_list>

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

}  // namespace tetwarp::cli
