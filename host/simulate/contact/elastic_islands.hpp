/// @file elastic_islands.hpp
/// ElasticIslands: contact islands of single elastic and rigid bodies that a device solves.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/simulate/contact/contact_islands.hpp"
#include "host/simulate/contact/contact_rows.hpp"
#include "host/simulate/contact/elastic_list_maker.hpp"
#include "host/simulate/resident_elastic.hpp"
#include "host/simulate/stepper.hpp"

namespace tetwarp {

/// The two-level iteration where a device steps the bodies: contacts and their laws go there,
/// impulses and velocities come back; A stays.
class ElasticIslands {
 public:
  /// @param model  kept by the caller
  ElasticIslands(const Model& model,
                 const ContactOptions& options,
                 std::shared_ptr<RestFactors> factors);

  /// Which coupling islands a device can take: single rigid bodies, and single elastic bodies whose
  /// inverses are of moderate size.
  const std::vector<std::uint8_t>& possible() const { return is_possible_; }

  /// @param stepper   after its solve(), with resident_elastic()
  /// @param state     at the start of the step
  /// @param takes     [coupling islands] which are taken; all of them are possible
  /// @param contacts  on them, ascending
  /// @param laws      of all contacts
  /// @param change    how contacts changed the velocities in the step before, or empty
  /// @param velocity  out, if there is a result: with contact in the islands, [block_count]
  TwoLevelOutcome solve(BodyStepper& stepper,
                        const ModelState& state,
                        const ContactIslands& islands,
                        const ContactRows& rows,
                        const std::vector<std::uint8_t>& takes,
                        const std::vector<std::int32_t>& contacts,
                        const ContactProblem& laws,
                        const std::vector<Point3>& change,
                        std::vector<Point3>& velocity);

  /// r and u of the contacts of the last solve(), [3 contacts].
  const std::vector<double>& impulse() const { return impulse_; }
  const std::vector<double>& contact_velocity() const { return contact_velocity_; }

 private:
  void set_start(const ModelState& state,
                 const std::vector<std::int32_t>& contacts,
                 const ContactProblem& laws,
                 const std::vector<Point3>& change);
  void take_results(const ResidentResults& results, std::vector<Point3>& velocity);

  ContactOptions options_;
  std::shared_ptr<RestFactors> factors_;
  std::vector<std::uint8_t> is_possible_;
  ElasticListMaker maker_;
  ContactProblem laws_;  ///< of its contacts
  ElasticStart start_;
  std::vector<double> impulse_, contact_velocity_;
};

}  // namespace tetwarp
