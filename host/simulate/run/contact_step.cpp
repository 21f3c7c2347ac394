#include "host/simulate/run/contact_step.hpp"

#include <algorithm>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/base/stopwatch.hpp"
#include "host/simulate/run/expected_motion.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"

namespace tetwarp {
namespace {

/// Adds the seconds from its start to its end.
class Clock {
 public:
  explicit Clock(double& seconds) : seconds_(seconds) {}
  Clock(Clock&&) = delete;
  ~Clock() { seconds_ += stopwatch_.seconds(); }

 private:
  double& seconds_;
  Stopwatch stopwatch_;
};

bool are_finite(const std::vector<Point3>& list) {
  return std::all_of(list.begin(), list.end(), [](const Point3& x) { return is_finite(x); });
}

std::unique_ptr<Detector> make_detector(const CollisionSurfaces& surfaces,
                                        const ContactStepOptions& options) {
  const DetectorOptions of = {.threads = options.threads,
                              .device = options.device,
                              .reuse_pairs = options.skip.pairs,
                              .skip_flat_edges = options.skip.flat_edges};
  return options.backend == Backend::cuda ? make_cuda_detector(surfaces, of)
                                          : make_cpu_detector(surfaces, of);
}

/// Every material twice: the second ones without adhesion of surfaces that are near at the start.
ContactTrackerOptions tracker_options(const SceneSurfaces& surfaces, int threads) {
  ContactTrackerOptions of;
  of.materials = surfaces.materials;
  of.materials.insert(of.materials.end(), surfaces.materials.begin(), surfaces.materials.end());
  for (std::size_t m = surfaces.materials.size(); m < of.materials.size(); ++m) {
    of.materials[m].initial_intensity = 0;
  }
  of.match_distance = surfaces.surfaces.thickness;
  of.touch_distance = surfaces.surfaces.thickness;
  of.threads = threads;
  return of;
}

ContactSystemOptions system_options(const Scene& scene,
                                    const ContactStepOptions& options,
                                    std::function<bool(const ContactProgress&)> progress) {
  ContactSystemOptions of;
  of.solver.tolerance = scene.solver.contact_tolerance;
  of.solver.law = scene.solver.pyramid ? FrictionLaw::pyramid : FrictionLaw::cone;
  of.solver.rule = scene.solver.restrictive ? AdhesionRule::restrictive : AdhesionRule::parallel;
  of.solver.backend = options.backend;
  of.solver.device = options.device;
  of.solver.threads = options.threads;
  // Islands that these sweeps do not solve follow with Newton's method: a few contacts with
  // friction between two bodies, as of a stone on an edge, may take thousands of sweeps. A step
  // that is not solved is divided. Very tight tolerances take many sweeps also where all is well,
  // and so do many contacts, see SolverIslands.
  of.solver.max_sweeps = scene.solver.contact_tolerance < 1e-6 ? 5000 : 300;
  of.solver.max_newton = 20000;
  // A solver that remembers systems would not go on from a checkpoint bit for bit.
  of.solver.skip.constant_systems = false;
  if (options.progress) of.solver.progress = std::move(progress);
  of.skips_islands = options.skip.islands;
  of.factors = options.factors;
  return of;
}

}  // namespace

void add_part(const ContactPart& part, ContactPart& sum) {
  sum.is_completed = sum.is_completed && part.is_completed;
  sum.converged = sum.converged && part.converged;
  sum.residual = std::max(sum.residual, part.residual);
  sum.contacts = part.contacts;
  sum.islands = part.islands;
  sum.passes += part.passes;
  sum.sweeps += part.sweeps;
  sum.outer_iterations += part.outer_iterations;
  sum.clamped_islands += part.clamped_islands;
  sum.stalled_scripts += part.stalled_scripts;
  sum.smallest_fraction = std::min(sum.smallest_fraction, part.smallest_fraction);
  sum.detection_seconds += part.detection_seconds;
  sum.contact_seconds += part.contact_seconds;
}

ContactStep::ContactStep(const Scene& scene,
                         const Model& model,
                         const SceneSurfaces& surfaces,
                         const ContactStepOptions& options)
    : scene_(scene),
      model_(model),
      surfaces_(surfaces),
      options_(options),
      material_count_(static_cast<std::int32_t>(surfaces.materials.size())),
      detector_(make_detector(surfaces.surfaces, options)),
      tracker_options_(tracker_options(surfaces, options.threads)),
      pair_contacts_(surfaces, options.threads),
      tracker_(tracker_options_),
      system_(surfaces,
              model,
              system_options(scene,
                             options,
                             [this](const ContactProgress&) {
                               was_ended_ = was_ended_ || !options_.progress();
                               return !was_ended_;
                             })),
      groups_(model, surfaces.surfaces),
      places_(surfaces, model, options.threads),
      motions_(static_cast<std::size_t>(std::max(1, scene.solver.max_passes))) {}

void ContactStep::set_places(const ModelState& state,
                             const SurfacePlaces& of,
                             std::vector<BodyPlace>& places) const {
  places.resize(surfaces_.surfaces.bodies.size());
  for (std::size_t b = 0; b < places.size(); ++b) {
    places[b] = {};
    const CollisionBody& body = surfaces_.surfaces.bodies[b];
    if (body.is_rigid) {
      const auto rigid = static_cast<std::size_t>(surfaces_.body_rigid[b]);
      places[b].pose = {state.position[static_cast<std::size_t>(model_.node_count) + rigid],
                        state.rotation[rigid]};
    } else {
      places[b].vertices = {of.vertices.data() + body.first_vertex,
                            static_cast<std::size_t>(body.vertex_end - body.first_vertex)};
    }
  }
}

void ContactStep::move_surfaces(std::span<const double> fraction, SurfaceMotion& motion) {
  if (&motion != final_) std::swap(motion.start, final_->start);
  final_ = &motion;
  frame_motion({surfaces_, model_, *start_, velocity_, time_step_, fraction}, motion);
  if (resident_ == nullptr) return move_vertices(fraction, motion);
  motion.resident = view_of(resident_->move(
      is_free_ ? std::span<const Point3>{} : std::span(velocity_), time_step_, fraction));
}

/// Of surfaces that move on a device, only what the end check finds needs them on the host.
void ContactStep::move_vertices(std::span<const double> fraction, SurfaceMotion& motion) const {
  vertex_motion({surfaces_, model_, *start_, velocity_, time_step_, fraction}, options_.threads,
                motion);
}

void ContactStep::report(bool is_first) {
  std::vector<ReportedContact>& reports =
      pair_contacts_.find(detector_->touches(), final_->start.vertices, tracker_.start_records());
  for (ReportedContact& report : reports) {
    const double gap = dot(report.normal, minus(report.point_a_world, report.point_b_world));
    if (!is_first || gap > surfaces_.surfaces.thickness) report.material += material_count_;
  }
  set_places(*start_, final_->start, start_places_);
  contacts_ = &tracker_.begin_step(reports, start_places_, time_step_);
}

bool ContactStep::solve(BodyStepper& stepper, ContactPart& part) {
  const Clock clock(part.contact_seconds);
  velocity_ = free_velocity_;
  is_free_ = contacts_->empty();
  if (is_free_) return false;
  const ContactSolveOutcome outcome =
      system_.solve(stepper, *start_, tracker_, *contacts_, velocity_, &change_);
  part.converged = outcome.converged;
  part.residual = outcome.residual;
  part.sweeps += outcome.sweeps;
  part.outer_iterations += outcome.outer_iterations;
  part.is_completed = !was_ended_;
  return part.is_completed && are_finite(velocity_);
}

void ContactStep::find_velocities(bool is_first, BodyStepper& stepper, ContactPart& part) {
  velocity_ = free_velocity_;
  // Axes of the pyramid follow the motion without contact. The expected motion is not the final
  // one, so that it takes a second detection.
  const bool is_expected =
      options_.skip.hits && !scene_.solver.pyramid && has_change() && motions_.size() > 1;
  if (is_expected) expect_contacts(model_, *start_, change_, velocity_);
  is_free_ = !is_expected;
  for (std::size_t pass = 0; pass < motions_.size(); ++pass) {
    bool is_new = false;
    {
      const Clock clock(part.detection_seconds);
      move_surfaces({}, motions_[pass]);
      const std::int64_t added = detector_->find_touches(motions_[pass]);
      ++part.passes;
      has_pairs_ = has_pairs_ || added > 0;
      part.woken = detector_->reached();
      if (!part.woken.empty()) return;
      is_new = added > 0 || (pass == 0 && (is_expected || !tracker_.records().empty()));
      if (!is_new) return;
      report(is_first);
    }
    const bool was_free = is_free_;
    const bool is_solved = solve(stepper, part);
    const bool lets_go = contacts_->empty() && !was_free;  // this pass was another motion
    if (!is_solved && !lets_go) return;
  }
  const Clock clock(part.detection_seconds);
  move_surfaces({}, clamped_);
}

void ContactStep::keep_apart(ContactPart& part) {
  const Clock clock(part.detection_seconds);
  static const std::vector<TrackedContact> none;
  groups_.begin(contacts_ == nullptr ? none : *contacts_, sleeping_links());
  part.islands = groups_.island_count();
  // A motion without pairs has passed a detection at a larger distance already.
  if (!has_pairs_) return;
  bool is_whole = true;
  for (;;) {
    const std::vector<TouchingPair>& hits = detector_->check(*final_);
    // The groups see in the whole motion which bodies move.
    if (resident_ != nullptr && is_whole && !hits.empty()) move_vertices({}, *final_);
    if (!groups_.stop(hits, *final_)) break;
    is_whole = false;
    move_surfaces(fractions(), clamped_);
  }
  part.smallest_fraction = groups_.smallest_fraction();
  if (groups_.all_move()) return;
  part.clamped_islands = groups_.stopped_islands();
  part.stalled_scripts = stalled_scripts();
}

bool ContactStep::has_change() const {
  return change_.size() == index_of(model_.block_count());
}

std::vector<Point3> ContactStep::guess(const ModelState& start, double time_step) {
  set_time_step(time_step);
  if (!has_change()) return {};
  return differences(start.velocity, change_);
}

ContactPart ContactStep::advance(const ModelState& start,
                                 double time_step,
                                 bool is_first,
                                 BodyStepper& stepper,
                                 StepSeconds& seconds) {
  ContactPart part;
  start_ = &start;
  set_time_step(time_step);
  was_ended_ = false;
  contacts_ = nullptr;
  has_pairs_ = false;
  block_impulses_.assign(static_cast<std::size_t>(model_.block_count()), {0, 0, 0});
  body_impulses_.assign(surfaces_.surfaces.bodies.size(), {0, 0, 0});
  groups_.begin({}, {});
  stepper.get_velocities(free_velocity_);
  if (are_finite(free_velocity_)) {
    {
      const Clock clock(part.detection_seconds);
      final_ = &motions_[0];
      places_.take(start, final_->start);
      resident_ = stepper.resident_surfaces();
      if (resident_ != nullptr) resident_->begin(binding_of(surfaces_));
      detector_->begin_step();
    }
    find_velocities(is_first, stepper, part);
    if (!part.is_completed || !part.woken.empty()) return part;
    if (are_finite(velocity_)) keep_apart(part);
    if (contacts_ == nullptr || contacts_->empty()) {
      change_.clear();
    } else {
      part.contacts = static_cast<std::int64_t>(contacts_->size());
      system_.set_velocities(velocity_, stepper);
      sum_impulses();
    }
  }
  add_sleeping(start, time_step, part);
  seconds.update += stepper.move(
      time_step, groups_.all_move() ? std::span<const double>{} : std::span(fractions()));
  return part;
}

}  // namespace tetwarp
