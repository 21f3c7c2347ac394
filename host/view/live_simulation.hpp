/// @file live_simulation.hpp
/// LiveSimulation: a simulation that steps in its own thread and takes orders between steps.
#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/view/body_carrier.hpp"
#include "host/view/finger_pair.hpp"
#include "host/view/input_log.hpp"
#include "host/view/live_frame.hpp"
#include "host/view/live_volumes.hpp"
#include "host/view/look/look_surfaces.hpp"
#include "host/view/triple_buffer.hpp"
#include "host/view/view_options.hpp"

namespace tetwarp::view {

/// Processor time of the thread, without those that help it.
struct LiveSeconds {
  double steps = 0, warps = 0;
  std::int64_t warp_count = 0;
};

enum class OrderKind {
  pause,
  step,
  restart,
  grab,
  pull,
  release,
  volumes_on,
  volumes_off,
  values  ///< of another quantity
};

/// An input of the user: a key or an action of the mouse.
struct Order {
  OrderKind kind = OrderKind::pause;
  std::size_t body = 0;  ///< of a grab
  Point3 point{};        ///< grab: on the surface; pull: where that point is to be [world]
  SurfaceQuantity quantity = SurfaceQuantity::none;  ///< of values
  InputTime time = std::chrono::steady_clock::now();
};

/// Owns the Simulator and the Warpers; only its thread uses them once it has begun.
class LiveSimulation {
 public:
  /// @param scene   checked by its reader
  /// @param replay  what to repeat, in place of grabs and restarts of the user
  /// @throws std::invalid_argument  as Simulator, and where steps that a limit of time ended could
  ///                                not be repeated: several threads, back end cuda
  /// @throws IoError  the replay is of another scene or another start
  LiveSimulation(Scene scene, const ViewOptions& options, std::optional<InputLog> replay);
  LiveSimulation(const LiveSimulation&) = delete;
  LiveSimulation& operator=(const LiveSimulation&) = delete;
  ~LiveSimulation();

  /// Of the start; not to be used after begin().
  const Simulator& simulator() const { return simulator_; }
  const LiveVolumes& volumes() const { return volumes_; }
  /// What is drawn of its bodies.
  const LookSurfaces& looks() const { return looks_; }
  /// Called by the thread with every state, after each step and each order that changes it, with a
  /// frame that lacks points and volumes. To be set before begin().
  using Listener = std::function<void(const Simulator& simulator, const LiveFrame& frame)>;
  void set_listener(Listener listener) { listener_ = std::move(listener); }

  void begin();
  /// Processor time of the thread so far, without those that help it [s].
  double thread_seconds();
  /// Never waits. Of successive pulls only the last one acts.
  void give(const Order& order);
  TripleBuffer<LiveFrame>& frames() { return frames_; }
  /// Ends the thread after the running step and the single steps that were ordered.
  void end();

  /// The steps made, and what the user did before them: after end(); scene and start at any time.
  const InputLog& log() const { return log_; }
  const LiveSeconds& seconds() const { return seconds_; }
  /// Steps that max_step_seconds ended.
  std::int64_t late_steps() const { return late_steps_; }
  std::vector<std::byte> checkpoint() const { return simulator_.checkpoint(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Held {
    std::size_t body;
    Point3 start;      ///< where it was taken
    Point3 target;     ///< where it is to be
    double stiffness;  ///< [N/m]
  };

  void run();
  void loop();
  void fail(const std::string& problem);
  std::vector<Order> take_orders(bool waits);
  void follow(const Order& order);
  void act(const InputEvent& event);
  void try_to_act(const InputEvent& event);
  void repeat_input();
  bool may_step() const;
  void take_step();
  std::size_t body_of(const std::string& name) const;
  void wait_for_time();
  void count_step();
  void fill(LiveFrame& frame);
  void fill_values(LiveFrame& frame);
  void tell_listener();
  void publish();
  void note_change();

  ViewOptions options_;
  Simulator simulator_;
  LookSurfaces looks_;
  FingerPair fingers_;
  LiveVolumes volumes_;
  BodyCarrier carrier_;
  SurfaceValues values_;
  SurfaceQuantity quantity_;
  std::vector<std::vector<float>> shown_values_;  ///< of the state, if they are not stale
  bool has_values_ = false;
  ValueRange range_;
  std::vector<std::byte> start_;
  std::optional<InputLog> replay_;
  std::size_t next_event_ = 0;      ///< of the replay
  bool ends_at_counts_;             ///< the steps of the replay
  std::optional<StepLimit> limit_;  ///< of its next step
  std::int64_t last_tick_ = std::numeric_limits<std::int64_t>::max();
  InputLog log_;
  LiveSeconds seconds_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Order> orders_;  ///< guarded by the mutex
  bool is_ending_ = false;     ///< guarded by the mutex

  std::int64_t tick_ = 0, late_steps_ = 0;
  std::int64_t single_steps_ = 0;  ///< to take while paused
  bool is_paused_ = false, has_failed_ = false, warps_ = true;
  bool is_published_ = false;  ///< whether the state is in a frame
  bool is_sent_ = false;       ///< whether the listener has got it
  Listener listener_;
  std::optional<Held> held_;
  std::optional<InputTime> pulled_, followed_;  ///< newest pull; that of the last step
  std::string message_;
  Clock::time_point due_;                  ///< of the next step
  std::vector<Clock::time_point> recent_;  ///< ends of the steps of the last second

  TripleBuffer<LiveFrame> frames_;
  std::atomic<double> ended_seconds_ = 0;  ///< processor time of the thread, once it has ended
  std::thread thread_;
};

}  // namespace tetwarp::view
