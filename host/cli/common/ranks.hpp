/// @file ranks.hpp
/// The processes of one job that mpirun has started, on one machine or several. All of MPI is in
/// ranks_mpi.cpp; a build without it has ranks_nompi.cpp.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tetwarp::cli {

/// The ranks of a job and their messages. Used by one thread at a time. An error in MPI ends all
/// ranks.
class Ranks {
 public:
  /// One process alone; makes no MPI call.
  Ranks() = default;

  /// All processes that mpirun has started with this one; initializes MPI. Without mpirun one
  /// process alone. Throws std::runtime_error when there are several and this build has no MPI.
  static Ranks start();

  /// Finalizes MPI after success: waits for the other ranks.
  void finish();

  int rank() const { return rank_; }
  int count() const { return count_; }
  bool is_root() const { return rank_ == 0; }

  /// Waits until every rank has called this.
  void wait_for_all() const;

  /// Copies the bytes of the root to every rank.
  void share(std::span<std::byte> bytes) const;
  template <class T>
  requires std::is_trivially_copyable_v<T> T shared(T value)
  const {
    share(std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }

  /// The smallest of the numbers of all ranks, at every rank.
  double smallest(double number) const;

  /// Begins to send to the root. The memory must not change until finish_sending().
  void send(std::span<const std::byte> bytes);
  void finish_sending();
  /// Receives what a rank sends; waits for it.
  void receive(int from, std::span<std::byte> bytes) const;

  /// The texts of all ranks in their order, at the root; empty at the others.
  std::vector<std::string> gather(const std::string& text) const;

 private:
  Ranks(int rank, int count) : rank_(rank), count_(count) {}

  int rank_ = 0;
  int count_ = 1;
  std::vector<int> sends_;  ///< MPI requests that are not finished, as Fortran handles
};

/// Number of processes that mpirun has started, from its environment variables; 1 without mpirun.
int launched_count();

/// Rank of this process, from the same source; 0 without mpirun.
int launched_rank();

/// Rank among the processes on this machine, from the same source.
int launched_local_rank();

/// Sleeps 0.1 s per rank, at most 2 s. Called before an error is printed: when several ranks find
/// the same error, the lowest prints it and ends the others before they print.
void delay_by_rank();

/// Ends all ranks between MPI_Init and MPI_Finalize; else does nothing.
void abort_ranks(int exit_code);

}  // namespace tetwarp::cli
