/// @file ranks_mpi.cpp
/// Ranks by MPI. Its errors end the job by themselves: MPI_ERRORS_ARE_FATAL is the default.
#include <mpi.h>

#include <algorithm>
#include <cstdint>

#include "host/cli/interrupt.hpp"
#include "host/cli/ranks.hpp"

namespace tetwarp::cli {

namespace {

constexpr std::size_t longest_message = std::size_t{1} << 30;  // counts are ints

/// part(begin, size) for parts that MPI can count.
template <class Part>
void for_parts(std::size_t bytes, const Part& part) {
  for (std::size_t begin = 0; begin < bytes; begin += longest_message) {
    part(begin, static_cast<int>(std::min(longest_message, bytes - begin)));
  }
}

}  // namespace

Ranks Ranks::start() {
  if (launched_count() <= 1) return {};
  int provided = 0, rank = 0, count = 1;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &count);
  leave_at_once();  // mpirun waits a second before it kills
  return {rank, count};
}

void Ranks::finish() {
  if (count_ > 1) MPI_Finalize();
}

void Ranks::meet() const {
  if (count_ > 1) MPI_Barrier(MPI_COMM_WORLD);
}

void Ranks::share(std::span<std::byte> bytes) const {
  if (count_ == 1) return;
  for_parts(bytes.size(), [&](std::size_t begin, int size) {
    MPI_Bcast(bytes.data() + begin, size, MPI_BYTE, 0, MPI_COMM_WORLD);
  });
}

double Ranks::least(double number) const {
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

std::vector<std::vector<std::byte>> Ranks::gather(std::span<const std::byte> bytes) const {
  if (count_ == 1) return {{bytes.begin(), bytes.end()}};
  std::vector<std::vector<std::byte>> all;
  if (!is_root()) {
    const std::uint64_t size = bytes.size();
    MPI_Send(&size, sizeof size, MPI_BYTE, 0, 1, MPI_COMM_WORLD);
    MPI_Send(bytes.data(), static_cast<int>(size), MPI_BYTE, 0, 1, MPI_COMM_WORLD);
    return all;
  }
  all.emplace_back(bytes.begin(), bytes.end());
  for (int from = 1; from < count_; ++from) {
    std::uint64_t size = 0;
    MPI_Recv(&size, sizeof size, MPI_BYTE, from, 1, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    all.emplace_back(size);
    MPI_Recv(all.back().data(), static_cast<int>(size), MPI_BYTE, from, 1, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
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
