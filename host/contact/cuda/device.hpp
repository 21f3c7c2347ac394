/// @file device.hpp
/// Interface of a device that runs stages of the contact solver. Newton's method stays on the host.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/budget.hpp"
#include "host/contact/structure/structure.hpp"
#include "host/contact/structure/system.hpp"
#include "kernels/contact/contact_adhesion.hpp"

namespace tetwarp {

struct IslandOutcome;

/// A problem whose arrays are in memory of the device, and where its results go.
struct ResidentProblem {
  const ContactProblem* pattern = nullptr;  ///< index arrays, in memory of the host
  ContactInput input;
  View<const double> guess;                       ///< [3 contacts], or empty
  View<double> impulse, velocity, body_velocity;  ///< out; empty: not written
  void* stream = nullptr;                         ///< cudaStream_t of the caller, or null
};

/// How the solve of such a problem ended.
struct ResidentEnd {
  bool is_solved = false;  ///< false: the host must solve it; nothing useful was written
  bool has_run = false;    ///< the islands were solved as solve_uncoupled() does
  std::vector<double> impulse, body_velocity;  ///< of a run that is not solved, as there
  ContactSavings savings;
  std::int64_t updates_skipped = 0;
  double balance = 0;  ///< ContactResidual::balance
};

/// A device that solves islands of contacts, with the methods of
/// kernels/contact/contact_methods.hpp. All vectors are in memory of the host.
class ContactDevice : public StructureStages {
 public:
  /// Limits of the running solve, for islands that run stage by stage; null: none.
  SolveBudget* budget = nullptr;

  /// Copies a problem to the device, for the calls that follow.
  /// @param structure  kept by the caller until the next set_problem()
  /// @return  rows and springs that the solve leaves out
  /// @throws CudaError
  virtual ContactSavings set_problem(const ContactOptions& options,
                                     const ContactStructure& structure,
                                     const ContactInput& input) = 0;

  /// Solves all islands whose blocks A does not couple, in the precision of the options, and
  /// measures the result in float64.
  /// @param impulse        [3 slots]; in: to start from; out: the best found
  /// @param body_velocity  out: velocities of these impulses, [dofs]; in islands without contacts
  ///                       the free motion; in coupled islands not set
  /// @param outcomes       out, [islands with contacts]: reason is `converged` within the tolerance
  /// @return  visits of frozen contacts that sweeps skipped
  virtual std::int64_t solve_uncoupled(const ContactOptions& options,
                                       std::vector<double>& impulse,
                                       std::vector<double>& body_velocity,
                                       std::vector<IslandOutcome>& outcomes) = 0;

  /// Solves one island whose blocks A couples; see solve_coupled_island().
  /// @param guess           impulses to start from, [3 slots]; empty: zero
  /// @param max_iterations  outer iterations
  /// @param impulse         out: the best, [3 slots], set in the island
  /// @param body_velocity   out: velocities of that impulse, [dofs], set in the island
  virtual void solve_coupled(const ContactOptions& options,
                             const ContactIsland& island,
                             const std::vector<double>& guess,
                             std::int64_t max_iterations,
                             std::vector<double>& impulse,
                             std::vector<double>& body_velocity,
                             IslandOutcome& outcome) = 0;

  /// Runs the stage "adhesion".
  /// @param body  input and output, views of host memory
  virtual void evolve(const ContactAdhesionOp& op) = 0;
  /// The same in memory of the device, on the caller's stream or, with null, after the default one.
  virtual void evolve_resident(const ContactAdhesionOp& op, void* stream) = 0;

  virtual std::string name() const = 0;

  /// Solves a problem without coupled islands; copies counts and sums to the host, and the pattern
  /// to the device if the structure has changed. Kernels run on the stream of the problem; with
  /// null they wait for the default stream. Returns when the results are written.
  /// @param outcomes  out, [islands with contacts]
  /// @return  not solved: an island has not converged, the numbers fail a check or need more than
  ///          sweeps (springs with other gaps than dt w_n), or the budget is over
  virtual ResidentEnd solve_resident(const ContactOptions& options,
                                     const ContactStructure& structure,
                                     const ResidentProblem& problem,
                                     std::vector<IslandOutcome>& outcomes) = 0;

  /// Whether the address is in memory of this device, or managed.
  virtual bool is_device_memory(const void* data) const = 0;

  /// Copies between the host and arrays of the device that a caller owns, after the work on its
  /// stream; returns when the copy is done.
  virtual void read(const double* device, std::int64_t size, double* host, void* stream) = 0;
  virtual void write(const double* host, std::int64_t size, double* device, void* stream) = 0;
};

/// @throws CudaError  the device cannot be used; the text is the reason given by the CUDA runtime
std::unique_ptr<ContactDevice> make_contact_device(int device);

}  // namespace tetwarp
