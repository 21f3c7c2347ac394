/// @file ranks_mpi.cpp
/// Ranks by MPI. Return codes are not checked: by default an error in MPI ends the job.
#include <mpi.h>

#include <algorithm>
#include <cstdint>

#include "host/cli/common/interrupt.hpp"
#include "host/cli/common/ranks.hpp"

namespace tetwarp::cli {
namespace {
constexpr std::size_t max_message = std::size_t{1} << 30;  // [byte]; counts of MPI are ints

/// Calls part(begin, size) for parts of at most max_message bytes.
template <class Part>
void for_parts(std::size_t bytes, const Part& part) {
  for (std::size_t begin = 0; begin < bytes; begin += max_message) {
    part(begin, static_cast<int>(std::min(max_message, bytes - begin)));
  }
}
}  // namespace

Ranks Ranks::start() {
  if (launched_count() <= 1) return {};
  int provided = 0, rank = 0, count = 1;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &count);
  exit_on_first_signal();  // mpirun kills a second after SIGTERM
  return {rank, count};
}

void Ranks::finish() {
  if (count_ > 1) MPI_Finalize();
}

void Ranks::wait_for_all() const {
  if (count_ > 1) MPI_Barrier(MPI_COMM_WORLD);
}

void Ranks::share(std::span<std::byte> bytes) const {
  if (count_ == 1) return;
  for_parts(bytes.size(), [&](std::size_t begin, int size) {
    MPI_Bcast(bytes.data() + begin, size, MPI_BYTE, 0, MPI_COMM_WORLD);
  });
}

double Ranks::smallest(double number) const {
  if (count_ > 1) {
    MPI_Allreduce(MPI_IN_PLACE, &number, 1, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
  }
  return number;
}

void Ranks::send(std::span<const std::byte> bytes) {
  for_parts(bytes.size(), [&](std::size_t begin, int size) {
    MPI_Request request;
    MPI_Isend(bytes.data() + begin, size, MPI_BYTE, 0, 0, MPI_COMM_WORLD, &request);
    sends_.push_back(MPI_Request_c2f(request));
  });
}

void Ranks::finish_sending() {
  for (const int send : sends_) {
    MPI_Request request = MPI_Request_f2c(send);
    MPI_Wait(&request, MPI_STATUS_IGNORE);
  }
  sends_.clear();
}

void Ranks::receive(int from, std::span<std::byte> bytes) const {
  for_parts(bytes.size(), [&](std::size_t begin, int size) {
    MPI_Recv(bytes.data() + begin, size, MPI_BYTE, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  });
}

std::vector<std::string> Ranks::gather(const std::string& text) const {
  if (count_ == 1) return {text};
  std::uint64_t size = text.size();
  if (!is_root()) {
    MPI_Send(&size, sizeof size, MPI_BYTE, 0, 1, MPI_COMM_WORLD);
    for_parts(text.size(), [&](std::size_t begin, int part) {
      MPI_Send(text.data() + begin, part, MPI_BYTE, 0, 1, MPI_COMM_WORLD);
    });
    return {};
  }
  std::vector<std::string> all{text};
  for (int from = 1; from < count_; ++from) {
    MPI_Recv(&size, sizeof size, MPI_BYTE, from, 1, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    std::string& received = all.emplace_back(size, '\0');
    for_parts(received.size(), [&](std::size_t begin, int part) {
      MPI_Recv(received.data() + begin, part, MPI_BYTE, from, 1, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    });
  }
  return all;
}

void abort_ranks(int exit_code) {
  int has_begun = 0, has_ended = 0;
  MPI_Initialized(&has_begun);
  MPI_Finalized(&has_ended);
  if (has_begun != 0 && has_ended == 0) MPI_Abort(MPI_COMM_WORLD, exit_code);
}

}  // namespace tetwarp::cli
