/// @file contact_step.cpp
/// A part of a step: passes, end check, impulses, contacts that sleep.
#include "host/simulate/contact_step/contact_step.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/contact_step/added_seconds.hpp"
#include "host/simulate/contact_step/adhesion_record.hpp"

namespace tetwarp {
namespace {

std::unique_ptr<Detector> make_detector(const CollisionSurfaces& surfaces,
                                        const ContactStepOptions& options) {
  const DetectorOptions of = {.threads = options.threads,
                              .device = options.device,
                              .reuse_pairs = options.skip.pairs,
                              .skip_flat_edges = options.skip.flat_edges};
  return options.backend == Backend::cuda ? make_cuda_detector(surfaces, of)
                                          : make_cpu_detector(surfaces, of);
}

}  // namespace

ContactStep::ContactStep(const Scene& scene,
                         const Model& model,
                         const SceneSurfaces& surfaces,
                         const ContactStepOptions& options)
    : scene_(scene),
      model_(model),
      surfaces_(surfaces),
      options_(options),
      detector_(make_detector(surfaces.surfaces, options)),
      history_(surfaces, options.threads),
      sleeping_(surfaces, model, options.threads),
      motion_(surfaces, model, options.threads, std::max(1, scene.solver.max_passes)),
      passes_({scene, model, surfaces, *detector_, history_, motion_}, options),
      end_check_(surfaces, model, *detector_, motion_),
      points_(surfaces, options.threads) {}

bool ContactStep::can_touch(const CollisionSurfaces& surfaces) {
  std::vector<std::int32_t> solid;
  for (std::size_t b = 0; b < surfaces.bodies.size(); ++b) {
    const CollisionBody& body = surfaces.bodies[b];
    if (body.touches_itself && body.triangle_end > body.first_triangle) return true;
    const bool has_parts = body.vertex_end > body.first_vertex || body.plane_end > body.first_plane;
    if (has_parts) solid.push_back(static_cast<std::int32_t>(b));
  }
  const auto is_free = [&](std::int32_t b) { return at(surfaces.bodies, b).has_unknowns; };
  for (std::size_t i = 0; i < solid.size(); ++i) {
    for (std::size_t j = i + 1; j < solid.size(); ++j) {
      const std::array<std::int32_t, 2> pair{solid[i], solid[j]};
      if (!is_free(pair[0]) && !is_free(pair[1])) continue;
      if (!std::ranges::binary_search(surfaces.forbidden, pair)) return true;
    }
  }
  return false;
}

std::vector<Point3> ContactStep::guess(const ModelState& start, double time_step) {
  history_.set_time_step(time_step);
  if (std::ssize(history_.change()) != model_.block_count()) return {};
  return differences(start.velocity, history_.change());
}

ContactPart ContactStep::advance(const ModelState& start,
                                 double time_step,
                                 bool is_first,
                                 BodyStepper& stepper) {
  ContactPart part;
  history_.set_time_step(time_step);
  history_.begin_part();
  impulses_.reset(index_of(model_.block_count()), surfaces_.surfaces.bodies.size());
  end_check_.begin(nullptr, {});
  if (motion_.take_velocities(stepper)) {
    begin(start, time_step, stepper, part);
    passes_.run(is_first, stepper, part);
    if (!part.is_completed || !part.woken.empty()) return part;
    if (motion_.is_finite()) keep_apart(part);
    take_solution(stepper, part);
  }
  add_sleeping(start, part);
  part.seconds.update = stepper.move(
      time_step, end_check_.all_move() ? std::span<const double>{} : std::span(fractions()));
  return part;
}

void ContactStep::begin(const ModelState& start,
                        double time_step,
                        BodyStepper& stepper,
                        ContactPart& part) {
  const AddedSeconds seconds(part.seconds.detection);
  motion_.begin(start, time_step, stepper);
  detector_->begin_step();
}

void ContactStep::keep_apart(ContactPart& part) {
  const AddedSeconds seconds(part.seconds.detection);
  end_check_.begin(history_.contacts(), sleeping_links());
  part.islands = end_check_.island_count();
  // A motion without pairs has passed a detection at a larger distance already.
  if (passes_.has_pairs()) end_check_.run(part);
}

/// Gives the velocities with contact to the stepper, and sums the impulses.
void ContactStep::take_solution(BodyStepper& stepper, ContactPart& part) {
  const std::vector<TrackedContact>* const contacts = history_.contacts();
  if (contacts == nullptr || contacts->empty()) return history_.change().clear();
  part.contacts = std::ssize(*contacts);
  passes_.system().set_velocities(motion_.velocity(), stepper);
  impulses_.add_contacts(*contacts, passes_.system());
}

void ContactStep::add_sleeping(const ModelState& start, ContactPart& part) {
  part.contacts += std::ssize(sleeping_.list());
  sleeping_.add_impulses(start, history_.time_step(), impulses_);
}

void ContactStep::end(const ModelState& after, ContactPart& part) {
  const AddedSeconds seconds(part.seconds.contact);
  const std::vector<double> before = intensities();
  if (history_.contacts() == nullptr) {
    points_.clear();
  } else {
    end_contacts(after);
  }
  if (!options_.sleeps) return points_.finish();
  points_.finish_with(sleeping_.list(), history_);
  rest_ = contact_rest(surfaces_, history_, points_.solved(), before, passes_.system().solution(),
                       fractions());
}

/// Of the contacts of the part, before it ends; needed where bodies may sleep.
std::vector<double> ContactStep::intensities() const {
  std::vector<double> all;
  if (!options_.sleeps || history_.contacts() == nullptr) return all;
  for (const ContactRecord& record : history_.tracker().records()) all.push_back(record.intensity);
  return all;
}

void ContactStep::end_contacts(const ModelState& after) {
  static const ContactSolution nothing;
  const ContactSolution& solution =
      history_.contacts()->empty() ? nothing : passes_.system().solution();
  const std::vector<BodyPlace>& bodies = motion_.bodies_in(after);
  points_.make(history_, solution, motion_.bodies_at_start(), bodies);
  points_.set_intensities(history_.end_part(solution, bodies).intensity);
}

ContactMemory ContactStep::memory() const {
  return {history_.time_step(), history_.tracker().records(), history_.change(), sleeping_.list()};
}

void ContactStep::set_memory(const ContactMemory& memory) {
  const auto& [time_step, records, change, sleeping] = memory;
  history_.restore(time_step, records, change);
  sleeping_.set(sleeping);
}

void ContactStep::set_still(std::span<const std::uint8_t> is_still) {
  if (is_still.empty() && sleeping_.still().empty()) return;
  sleeping_.set_still(is_still);
  detector_->set_still(sleeping_.still());
}

void ContactStep::thaw(std::span<const std::uint8_t> is_still) {
  set_still(is_still);
  if (sleeping_.list().empty()) return;
  history_.add_records(sleeping_.thaw(history_.time_step()));
}

void ContactStep::freeze(std::span<const std::uint8_t> is_still) {
  set_still(is_still);
  if (sleeping_.still().empty() || history_.contacts() == nullptr) return;
  history_.set_records(sleeping_.freeze(history_, points_.solved()));
}

void ContactStep::record(const ModelState& state, StepRecord& record) {
  const double cap = 100 * surfaces_.surfaces.thickness;
  const MotionView on_device = motion_.surfaces_on_device();
  record.smallest_distance =
      detector_->closest(motion_.surfaces_in(state), cap, on_device).distance;
  add_bonds(history_, sleeping_, motion_.bodies_in(state), scene_.time_step, record);
}

}  // namespace tetwarp
