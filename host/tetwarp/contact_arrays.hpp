/// @file contact_arrays.hpp
/// The numbers of a contact problem in arrays of the caller, in host memory or on a GPU, and arrays
/// for its results.
#pragma once
#include <cstdint>
#include <span>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// The numbers of a ContactProblem whose index arrays are known from
/// ContactSolver::set_structure(). Each member has the size, unit and meaning of the member of
/// ContactProblem that its comment names; those of the other form stay empty. Optional members may
/// be empty where they are empty there, too.
struct ContactArrays {
  std::span<const double> system;                ///< system.value
  std::span<const double> jacobian;              ///< jacobian.value
  std::span<const double> load;                  ///< load
  std::span<const double> velocity_offset;       ///< velocity_offset
  std::span<const double> delassus;              ///< delassus.value
  std::span<const double> free_velocity;         ///< free_velocity
  std::span<const double> friction;              ///< friction
  double time_step = 0;                          ///< adhesion.time_step
  std::span<const double> area;                  ///< adhesion.area, optional
  std::span<const double> stiffness;             ///< adhesion.stiffness, optional
  std::span<const double> tangential_stiffness;  ///< adhesion.tangential_stiffness, optional
  std::span<const double> intensity;             ///< adhesion.intensity, optional
  std::span<const double> gap;                   ///< adhesion.gap, optional
  std::span<const double> impulse_guess;         ///< impulse_guess, optional
  Memory memory = Memory::host;                  ///< of all arrays; `device`: that of
                                                 ///< ContactOptions::device, cuda only
};

/// Arrays that a solve writes, each optional.
struct ContactTarget {
  std::span<double> impulse;        ///< r, [3 contacts], N s
  std::span<double> velocity;       ///< u, [3 contacts], m/s
  std::span<double> body_velocity;  ///< v, [dofs], m/s; global form only
  Memory memory = Memory::host;     ///< of all arrays; the same as that of the problem
  /// cudaStream_t on which kernels run, to order them with the caller's work on device memory;
  /// null: a stream of the solver, which first waits for the default stream. cuda only.
  void* stream = nullptr;
};

/// What a change of adhesion reads besides the problem and its solution, and what it writes; in the
/// same memory as these. Outputs may be the arrays of the problem.
struct AdhesionArrays {
  std::span<const double> energy;               ///< as in AdhesionState, [contacts], optional
  std::span<const double> viscosity;            ///< the same
  std::span<const double> bonding_rate;         ///< the same
  std::span<const double> saturation_pressure;  ///< the same
  std::span<double> intensity;                  ///< out, as in AdhesionStep, [contacts]
  std::span<double> gap;                        ///< out, [3 contacts]
  std::span<std::uint8_t> debonded;             ///< out, [contacts], optional
};

}  // namespace tetwarp
