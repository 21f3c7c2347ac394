/// @file live_simulation.cpp
/// The thread of a live simulation.
#include "host/view/live_simulation.hpp"

#include <pthread.h>

#include <algorithm>
#include <ctime>
#include <exception>
#include <stdexcept>
#include <utility>

#include "host/base/point3.hpp"
#include "host/view/grab_handle.hpp"
#include "host/view/live_start.hpp"

namespace tetwarp::view {
namespace {
constexpr const char* replay_message = "a replay takes no input";

/// [s]
double seconds_of(const timespec& time) {
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return seconds_of(time);
}
}  // namespace

LiveSimulation::LiveSimulation(Scene scene,
                               const ViewOptions& options,
                               std::optional<InputLog> replay)
    : options_(options),
      simulator_(std::move(scene), simulate_options(options, replay)),
      looks_(simulator_),
      fingers_(simulator_, options),
      volumes_(rest_volumes(simulator_), options, simulator_.backend()),
      carrier_(simulator_),
      values_(simulator_, looks_),
      quantity_(quantity_of(options.colors)),
      start_(first_state(options, simulator_)),
      replay_(std::move(replay)),
      ends_at_counts_(has_limits(replay_)),
      is_paused_(options.paused) {
  carrier_.reset();
  fingers_.reset(carrier_);
  log_.scene = options.scene_words();
  log_.start = start_hash(start_);
  check_start(options, log_.start, replay_);
  if (replay_) last_tick_ = replay_->ticks;
  if (options.steps) last_tick_ = *options.steps;
}

LiveSimulation::~LiveSimulation() {
  end();
}

void LiveSimulation::begin() {
  thread_ = std::thread([this] {
    run();
    ended_seconds_ = processor_seconds();
  });
}

double LiveSimulation::thread_seconds() {
  clockid_t clock{};
  timespec time{};
  const bool runs = thread_.joinable() &&
                    pthread_getcpuclockid(thread_.native_handle(), &clock) == 0 &&
                    clock_gettime(clock, &time) == 0;
  return runs ? seconds_of(time) : ended_seconds_.load();
}

void LiveSimulation::end() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
  log_.ticks = tick_;
}

void LiveSimulation::give(const Order& order) {
  {
    const std::lock_guard lock(mutex_);
    const bool replaces =
        order.kind == OrderKind::pull && !orders_.empty() && orders_.back().kind == OrderKind::pull;
    if (replaces) {
      orders_.back() = order;
    } else {
      orders_.push_back(order);
    }
  }
  wake_.notify_all();
}

std::vector<Order> LiveSimulation::take_orders(bool waits) {
  std::unique_lock lock(mutex_);
  if (waits) wake_.wait(lock, [this] { return is_ending_ || !orders_.empty(); });
  return std::exchange(orders_, {});
}

bool LiveSimulation::may_step() const {
  return !has_failed_ && tick_ < last_tick_ && (!is_paused_ || single_steps_ > 0);
}

void LiveSimulation::run() {
  try {
    loop();
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

/// A frame of an earlier state, or without any, that says why no more follow.
void LiveSimulation::fail(const std::string& problem) {
  LiveFrame& frame = frames_.back();
  frame.message = problem;
  frame.has_failed = frame.is_last = true;
  frames_.publish();
}

void LiveSimulation::loop() {
  due_ = Clock::now();
  while (true) {
    repeat_input();
    const bool steps = may_step();
    if (!is_sent_) tell_listener();
    if (!is_published_ && (!steps || !frames_.is_waiting())) publish();
    for (const Order& order : take_orders(!steps)) follow(order);
    const bool has_steps = may_step();
    {
      const std::lock_guard lock(mutex_);
      if (is_ending_ && orders_.empty() && !(has_steps && is_paused_)) return;
    }
    if (!has_steps) continue;
    take_step();
    wait_for_time();
  }
}

/// Orders that change the simulation become events, which are recorded.
void LiveSimulation::follow(const Order& order) {
  InputEvent event{.tick = tick_};
  switch (order.kind) {
    case OrderKind::pause:
      is_paused_ = !is_paused_;
      due_ = Clock::now();
      note_change();
      return;
    case OrderKind::step:
      single_steps_ = is_paused_ ? single_steps_ + 1 : 0;
      is_paused_ = true;
      note_change();
      return;
    case OrderKind::volumes_on:
    case OrderKind::volumes_off:
      warps_ = order.kind == OrderKind::volumes_on;
      note_change();
      return;
    case OrderKind::values:
      quantity_ = order.quantity;
      note_change();
      return;
    case OrderKind::restart:
      event.kind = InputKind::restart;
      break;
    case OrderKind::grab:
      if (carrier_.may_carry(order.body)) {
        note_change();
        message_ = replay_ ? replay_message : carrier_.take_up(order.body, order.point);
        return;
      }
      event.kind = InputKind::grab;
      event.handle = grab_handle(simulator_, options_, order.body, order.point);
      break;
    case OrderKind::pull:
      pulled_ = order.time;
      carrier_.pull(order.point);
      note_change();
      if (!held_) return;
      event.kind = InputKind::move;
      event.displacement = minus(order.point, held_->start);
      break;
    case OrderKind::release:
      carrier_.let_go();
      note_change();
      if (!held_) return;
      event.kind = InputKind::release;
      break;
  }
  if (replay_) {
    message_ = replay_message;
    note_change();
    return;
  }
  try_to_act(event);
}

void LiveSimulation::act(const InputEvent& event) {
  note_change();
  message_.clear();
  if (event.kind == InputKind::grab) {
    PointHandle handle = event.handle;
    handle.name = handle_name;
    simulator_.add_handle(handle);
    held_ = Held{body_of(handle.body), handle.center, handle.center, handle.stiffness};
  } else if (event.kind == InputKind::move) {
    simulator_.move_handle(handle_name, event.displacement);
    if (held_) held_->target = plus(held_->start, event.displacement);
  } else if (event.kind == InputKind::carry) {
    simulator_.move_script(event.handle.body, event.displacement, {0, 0, 0});
    const std::size_t body = body_of(event.handle.body);
    carrier_.note({body, event.displacement});
    fingers_.follow(body, event.displacement);
  } else if (event.kind == InputKind::limit) {
    limit_ = event.limit;
    return;  // the step notes it
  } else if (event.kind == InputKind::release) {
    simulator_.release_handle(handle_name);
    held_.reset();
  } else {
    simulator_.restore(start_);
    held_.reset();
    carrier_.reset();
    fingers_.reset(carrier_);
    has_failed_ = false;
  }
  log_.events.push_back(event);
}

/// Input that cannot be is left out, and the window says why.
void LiveSimulation::try_to_act(const InputEvent& event) {
  try {
    act(event);
  } catch (const std::exception& error) {
    message_ = error.what();
  }
}

/// Acts as the events that were recorded before the next step. The first that cannot be ends it.
void LiveSimulation::repeat_input() {
  if (!replay_) return;
  const std::vector<InputEvent>& events = replay_->events;
  while (next_event_ < events.size() && events[next_event_].tick <= tick_) {
    try {
      act(events[next_event_++]);
    } catch (const std::exception& error) {
      message_ = options_.replay + ": its input before step " + std::to_string(tick_ + 1) +
                 " cannot be repeated: " + error.what();
      has_failed_ = true;
      next_event_ = events.size();
    }
  }
}

std::size_t LiveSimulation::body_of(const std::string& name) const {
  const std::vector<Body>& bodies = simulator_.scene().bodies;
  const auto found = std::ranges::find(bodies, name, &Body::name);
  if (found == bodies.end()) throw std::invalid_argument("there is no body '" + name + "'");
  return static_cast<std::size_t>(found - bodies.begin());
}

void LiveSimulation::take_step() {
  if (const auto way = carrier_.next()) {
    const std::string& name = simulator_.scene().bodies[way->body].name;
    try_to_act({tick_, InputKind::carry, {.body = name}, way->displacement});
  }
  note_change();
  single_steps_ = std::max<std::int64_t>(single_steps_ - 1, 0);
  try {
    const double start = processor_seconds();
    if (ends_at_counts_) {
      simulator_.step(std::exchange(limit_, {}).value_or(StepLimit{}));
    } else {
      simulator_.step();
    }
    seconds_.steps += processor_seconds() - start;
    count_step();
  } catch (const std::exception& error) {
    message_ = error.what();
    has_failed_ = true;
  }
}

void LiveSimulation::count_step() {
  followed_ = pulled_;
  const StepLimit limit = simulator_.step_limit();
  if (limit != StepLimit{}) {
    log_.events.push_back({.tick = tick_, .kind = InputKind::limit, .limit = limit});
  }
  ++tick_;
  if (simulator_.record().out_of_time) ++late_steps_;
  const Clock::time_point now = Clock::now();
  recent_.push_back(now);
  std::erase_if(recent_,
                [&](Clock::time_point end) { return now - end > std::chrono::seconds(1); });
}

/// A scene does not run faster than its time.
void LiveSimulation::wait_for_time() {
  if (options_.fast || replay_) return;
  const auto step = std::chrono::duration<double>(simulator_.scene().time_step);
  const Clock::time_point now = Clock::now();
  due_ = std::max(due_ + std::chrono::duration_cast<Clock::duration>(step), now);
  if (due_ == now) return;
  if (!is_sent_) tell_listener();
  if (!is_published_ && !frames_.is_waiting()) publish();
  std::unique_lock lock(mutex_);
  wake_.wait_until(lock, due_, [this] { return is_ending_; });
}

void LiveSimulation::note_change() {
  is_published_ = is_sent_ = has_values_ = false;
}

void LiveSimulation::tell_listener() {
  is_sent_ = true;
  if (!listener_) return;
  LiveFrame frame;
  fill(frame);
  listener_(simulator_, frame);
}

void LiveSimulation::publish() {
  LiveFrame& frame = frames_.back();
  fill(frame);
  frame.points.resize(simulator_.scene().bodies.size());
  for (std::size_t b = 0; b < frame.points.size(); ++b) {
    frame.points[b] = looks_.positions(b);
  }
  if (warps_) {
    const double start = processor_seconds();
    volumes_.warp(
        [this](std::size_t volume) {
          const std::size_t body = volumes_.sources()[volume].body.body;
          return VolumeNodes{&simulator_.body(body).mesh, simulator_.node_positions(body),
                             simulator_.positions(body)};
        },
        frame.volumes);
    seconds_.warps += processor_seconds() - start;
    ++seconds_.warp_count;
  } else {
    frame.volumes.clear();
  }
  frames_.publish();
  is_published_ = true;
}

/// All but points and volumes.
void LiveSimulation::fill(LiveFrame& frame) {
  frame.step = simulator_.step_index();
  frame.tick = tick_;
  frame.time = simulator_.time();
  const StepRecord& record = simulator_.record();
  // Impulses are those of the last part of a step.
  const double part = simulator_.scene().time_step /
                      static_cast<double>(std::max<std::int64_t>(record.substeps, 1));
  frame.contacts.clear();
  const std::vector<ContactPoint> contacts = simulator_.contacts();
  for (const ContactPoint& contact : contacts) {
    frame.contacts.push_back({contact.position, times(1 / part, contact.impulse)});
  }
  frame.grab.reset();
  if (held_) {
    const Point3 force = record.bodies.empty() ? Point3{} : record.bodies[held_->body].handle_force;
    frame.grab =
        GrabView{minus(held_->target, times(1 / held_->stiffness, force)), held_->target, force};
  }
  if (!frame.grab) frame.grab = fingers_.view(record, carrier_.held());
  if (!frame.grab) frame.grab = carrier_.view(contacts, part);
  frame.input = followed_;
  frame.is_paused = is_paused_;
  frame.is_converged = record.converged;
  frame.is_last = tick_ >= last_tick_;
  frame.steps_per_second = static_cast<double>(recent_.size());
  frame.late_steps = late_steps_;
  frame.message = message_;
  frame.has_failed = has_failed_;
  fill_values(frame);
}

/// Once for the window and for screens.
void LiveSimulation::fill_values(LiveFrame& frame) {
  if (!has_values_) {
    shown_values_ = values_.of(quantity_);
    range_.include(quantity_, shown_values_);
    has_values_ = true;
  }
  frame.quantity = quantity_;
  frame.values = shown_values_;
  frame.range = range_;
}

}  // namespace tetwarp::view
