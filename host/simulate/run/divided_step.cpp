/// @file divided_step.cpp
/// Attempts with ever more parts of a step, until one is good.
#include "host/simulate/run/divided_step.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "host/base/step_second_fields.hpp"
#include "host/simulate/run/fastest_body.hpp"
#include "host/simulate/surfaces/round_shape.hpp"

namespace tetwarp {
namespace {

constexpr const char* fault_remedy =
    "; this is a fault of tetwarp, please report it with the scene; another time_step or thickness "
    "may avoid it";

/// No division of the step is good enough.
class StepFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace

DividedStep::DividedStep(const SimulatedScene& scene,
                         StepCount& count,
                         StepClock& clock,
                         MovingBodies& bodies)
    : scene_(scene), count_(count), clock_(clock), bodies_(bodies), division_(scene) {
  last_.sums.reset(scene.scene.bodies.size(), scene.scene.obstacles.size(),
                   scene.scene.couplings.size());
}

bool DividedStep::step() {
  stopwatch_ = {};
  seconds_ = {};
  count_.begin_step();
  clock_.begin_step();
  bodies_.begin_step();
  std::string what;
  try {
    const bool is_made = make();
    if (!is_made) go_back();
    return is_made;
  } catch (const StepFailed& error) {
    what = error.what();
  } catch (const ContactKeyError& error) {
    what = place_of_body(scene_.scene, error.key().body_a) + " and " +
           place_of_body(scene_.scene, error.key().body_b) + ": " + error.what() + fault_remedy;
  } catch (const std::logic_error& error) {
    what = fastest_body(scene_, bodies_.stepper()) + ": " + error.what() + fault_remedy;
  } catch (...) {
    go_back();
    throw;
  }
  go_back();
  throw std::runtime_error("step " + std::to_string(count_.done()) + ": " + what);
}

bool DividedStep::make() {
  int parts = division_.first_parts(bodies_.state().largest_spin());
  StepAttempt made = attempt(parts);
  while (made.is_given_up) {
    go_back();
    parts *= 2;
    made = attempt(parts);
  }
  if (!made.is_completed) return false;
  if (!made.is_finite) {
    throw StepFailed(failed_in(parts) +
                     "positions would not be finite; reduce time_step, the "
                     "stiffness or loads");
  }
  bodies_.end_step(made.is_good);
  clock_.end_step();
  accept(std::move(made));
  count_.end_step();
  return true;
}

void DividedStep::go_back() {
  bodies_.go_back();
  division_.forget_counts();
}

StepAttempt DividedStep::attempt(int parts) {
  StepAttempt made;
  made.sums.reset(scene_.scene.bodies.size(), scene_.scene.obstacles.size(),
                  scene_.scene.couplings.size());
  attempt_ = {};
  for (int first = 0, past = 0; first < parts; first = past) {
    past = clock_.is_over() ? parts : first + 1;  // the rest at once where there is no time
    if (!make_part(part_of(first, past, parts), parts, made)) break;
    ++made.parts;
  }
  add_all_seconds(made);
  return made;
}

/// @returns whether the next part may follow
bool DividedStep::make_part(const StepPart& of, int parts, StepAttempt& made) {
  ContactPart contact;
  try {
    contact = bodies_.advance(of, made);
  } catch (const TooManyPairs& error) {
    if (!division_.can_double(parts)) {
      throw StepFailed(failed_in(parts) + error.what() +
                       "; reduce time_step, the speeds or the thickness");
    }
    made.is_good = false;
    made.is_given_up = true;
    return false;
  }
  if (!made.is_completed) return false;
  made.is_good = division_.is_good(made, contact, of.time_step, bodies_.state()) && made.is_good;
  // An attempt with twice as many parts takes at least twice as long.
  made.is_given_up = !made.is_good && division_.can_double(parts) &&
                     (!made.is_finite || clock_.may_divide(2 * attempt_.seconds()));
  if (made.is_given_up || !made.is_finite) return false;
  bodies_.end_part(of, made.sums);
  return true;
}

/// Parts `first` to `past` of equal ones, as one.
StepPart DividedStep::part_of(int first, int past, int parts) const {
  const auto steps = static_cast<double>(count_.done());
  StepPart of;
  of.end_time =
      count_.time_of(past == parts ? steps + 1 : steps + static_cast<double>(past) / parts);
  of.time_step = (past - first) * (scene_.scene.time_step / parts);
  of.is_first = count_.done() == 0 && first == 0;
  return of;
}

void DividedStep::add_all_seconds(const StepAttempt& made) {
  add_seconds(made.outcome.seconds, seconds_);
  add_seconds(made.contact.seconds, seconds_);
}

void DividedStep::accept(StepAttempt made) {
  division_.accept(made);
  seconds_.total = stopwatch_.seconds();
  last_.outcome = made.outcome;
  last_.outcome.seconds = seconds_;
  last_.contact = std::move(made.contact);
  last_.sums = std::move(made.sums);
  last_.substeps = made.parts;
  last_.is_out_of_time = clock_.was_over();
  last_.work += last_.sums.work;
  last_.points.clear();
  if (bodies_.contact() != nullptr) bodies_.contact()->take_points(last_.points);
}

std::string DividedStep::failed_in(int parts) {
  return fastest_body(scene_, bodies_.stepper()) + " in " + std::to_string(parts) +
         (parts == 1 ? " part: " : " parts: ");
}

void DividedStep::restore(const LastStep& last, const DivisionState& division) {
  last_ = last;
  division_.set_state(division);
}

}  // namespace tetwarp
