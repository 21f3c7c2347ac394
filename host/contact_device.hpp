/// @file contact_device.hpp
/// What the contact solver asks of a device: sweeps. Structure, stopping shares, polish and the
/// final judgement stay with the host.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact_monitor.hpp"
#include "host/contact_structure.hpp"
#include "host/contact_system.hpp"
#include "kernels/contact_progress.hpp"

namespace tetwarp {

struct IslandOutcome;

/// Islands to sweep: places in structure and system, largest first.
struct SweepTask {
  std::vector<SweepIsland> islands;
  SweepLimit limit;
  ContactSwitches switches;
};

/// Colored projected Gauss-Seidel sweeps on a device.
class ContactDevice {
 public:
  virtual ~ContactDevice() = default;

  /// Sweeps each island to its end; other contacts keep their impulses. Every contact is visited in
  /// every sweep.
  /// @param impulse  [3 slots]; in: to start from; out: the best seen
  /// @return one per island of the task
  /// @throws CudaError
  virtual std::vector<SweepProgress> sweep(const SweepTask& task,
                                           const ContactStructure& structure,
                                           const ContactSystem<double>& system,
                                           std::vector<double>& impulse) = 0;
  virtual std::vector<SweepProgress> sweep(const SweepTask& task,
                                           const ContactStructure& structure,
                                           const ContactSystem<float>& system,
                                           std::vector<float>& impulse) = 0;
  /// The device's name.
  virtual std::string name() const = 0;
};

/// @throws CudaError  no such device answers; the text is the runtime's reason
std::unique_ptr<ContactDevice> make_contact_device(int device);

/// Whether a method starts with colored sweeps, which a device can do; others stay on the host.
inline bool starts_with_sweeps(ContactMethod method) {
  return method == ContactMethod::automatic || method == ContactMethod::gauss_seidel ||
         method == ContactMethod::newton;
}

/// Runs the sweeps of all islands whose blocks A does not couple on a device, in the precision of
/// the options, and notes in `outcomes` what they took. What follows (polish, other methods, the
/// final measure) starts from the impulses returned, in float64 on the host: method `automatic`
/// leaves it half of its sweeps, and an island that no longer gets better after 100.
/// @param rules    of each island with contacts
/// @param impulse  [3 slots], or empty: none
std::vector<double> sweep_on_device(ContactDevice& device,
                                    const ContactOptions& options,
                                    const ContactStructure& structure,
                                    const ContactSystem<double>& system,
                                    const std::vector<StopRule>& rules,
                                    std::vector<double> impulse,
                                    std::vector<IslandOutcome>& outcomes);

}  // namespace tetwarp
