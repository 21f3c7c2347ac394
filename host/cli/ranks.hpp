/// @file ranks.hpp
/// The processes of one job that mpirun has started, on one machine or several. All of MPI is in
/// ranks_mpi.cpp; a build without it has ranks_nompi.cpp.
#pragma once
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace tetwarp::cli {

/// Used by one thread at a time. What goes wrong in MPI ends all ranks.
class Ranks {
 public:
  /// One process alone: asks nobody.
  Ranks() = default;

  /// All that mpirun has started together with this one; without mpirun one alone, and MPI is not
  /// touched. Throws std::runtime_error when there are several and this build knows no MPI.
  static Ranks start();

  /// Says goodbye, once all is well: waits for the others.
  void finish();

  int rank() const { return rank_; }
  int count() const { return count_; }
  bool is_root() const { return rank_ == 0; }

  /// Waits until every rank is here.
  void meet() const;

  /// The root's bytes, everywhere.
  void share(std::span<std::byte> bytes) const;
  template <class T>
  requires std::is_trivially_copyable_v<T> T shared(T value)
  const {
    share(std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }

  /// The least of all ranks' numbers, everywhere.
  double least(double number) const;

  /// Begins to send to the root; the memory stays until finish_sending().
  void send(std::span<const std::byte> bytes);
  void finish_sending();
  /// Waits for what a rank sends.
  void receive(int from, std::span<std::byte> bytes) const;

  /// Brings the bytes of every rank to the root, in the order of ranks; elsewhere nothing.
  std::vector<std::vector<std::byte>> gather(std::span<const std::byte> bytes) const;

 private:
  Ranks(int rank, int count) : rank_(rank), count_(count) {}

  int rank_ = 0;
  int count_ = 1;
  std::vector<int> sends_;  ///< under way, by the numbers that MPI has for Fortran
};

/// How many processes mpirun has started, by what it tells its children; 1 without.
int launched_count();

/// Of this process among those of mpirun, by what mpirun tells its children; 0 without.
int launched_rank();

/// The same among those on this machine.
int launched_local_rank();

/// Lets lower ranks speak first: what several find wrong is then told by one, who ends the others.
void wait_for_turn();

/// Ends all ranks where there are several and this one is not done; else comes back.
void abort_ranks(int exit_code);

}  // namespace tetwarp::cli
