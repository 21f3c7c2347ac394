/// @file screens_zmq.cpp
/// Server and processes of the screens.
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <span>
#include <sstream>
#include <stdexcept>
#include <tetwarp/error.hpp>
#include <thread>
#include <utility>
#include <vector>

#include "host/view/link/room_pvx.hpp"
#include "host/view/link/screen_link.hpp"
#include "host/view/link/screen_server.hpp"
#include "host/view/link/sockets.hpp"
#include "host/view/screens/room_file.hpp"
#include "host/view/screens/scene_sharer.hpp"
#include "host/view/window/head_sender.hpp"
#include "host/view/window/screen_window.hpp"
#include "host/view/window/screens.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/text_file.hpp"

namespace tetwarp::view {
namespace {
constexpr double start_seconds = 10;
constexpr auto end_wait = std::chrono::seconds(10);  // for a screen to end by itself

Room read_room(const ViewOptions& options) {
  const std::string& file = options.screens;
  const std::vector<std::string> shipped = room_names();
  std::error_code error;
  Room room;
  if (std::ranges::count(shipped, file) > 0 && !std::filesystem::exists(file, error)) {
    room = parse_room(room_text(file), file);
  } else if (file.ends_with(".pvx")) {
    room = parse_pvx(read_text(file), file);
  } else {
    room = parse_room(read_text(file), file);
  }
  for (const std::string& note : room.notes) std::cerr << file << ": " << note << "\n";
  if (!options.address.empty()) room.address = options.address;
  return room;
}

ScreenKeys keys_of(const ViewOptions& options, bool is_master) {
  return options.key.empty() ? ScreenKeys{} : read_screen_keys(options.key, is_master);
}

/// The file of a screen beside that of the master: NAME_WORD.EXTENSION.
std::string beside(const std::string& file, const std::string& word) {
  if (file.empty()) return {};
  const std::filesystem::path path(file);
  return path.parent_path() / (path.stem().string() + "_" + word + path.extension().string());
}

/// Strings as execve() takes them; they must outlive the list.
std::vector<char*> pointers_of(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// This program again, which ends when this process does.
pid_t start_child(const ViewOptions& options, const std::string& display) {
  std::vector<std::string> words = words_of(options), variables;
  words.insert(words.begin(), "tetwarp-view");
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const bool is_display = std::strncmp(*variable, "DISPLAY=", 8) == 0;
    if (!is_display || display.empty()) variables.emplace_back(*variable);
  }
  if (!display.empty()) variables.push_back("DISPLAY=" + display);
  const std::vector<char*> arguments = pointers_of(words), environment = pointers_of(variables);
  const std::string program = std::filesystem::read_symlink("/proc/self/exe");
  const pid_t parent = getpid(), child = fork();
  if (child < 0) {
    throw std::runtime_error("a screen or tracker cannot be started: " +
                             std::string(strerror(errno)));
  }
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(1);
    execve(program.c_str(), arguments.data(), environment.data());
    _exit(127);
  }
  return child;
}

/// Has a process end by itself, and ends it if it does not.
void end_child(pid_t child) {
  kill(child, SIGTERM);
  const auto latest = std::chrono::steady_clock::now() + end_wait;
  while (waitpid(child, nullptr, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > latest) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}
}  // namespace

class MasterScreens::Impl {
 public:
  Impl(LiveSimulation& simulation, const ViewScene& scene, const ViewOptions& options)
      : simulation_(simulation), room_(read_room(options)), sharer_(simulation, scene, options) {
    server_.emplace(room_, bytes_of(sharer_.scene()), keys_of(options, true));
    simulation.set_listener([this](const Simulator& simulator, const LiveFrame& frame) {
      server_->set_state(bytes_of(sharer_.state(simulator, frame)));
    });
    ViewOptions of_screen;
    of_screen.join = server_->address();
    of_screen.key = beside(options.key, "screen");
    of_screen.backend = options.backend;
    of_screen.device = options.device;
    of_screen.threads = options.threads;
    of_screen.ends_with_master = true;
    for (const Screen& screen : room_.screens) {
      if (!screen.host.empty()) continue;
      of_screen.screen = screen.name;
      of_screen.screenshot = beside(options.screenshot, screen.name);
      children_.push_back(start_child(of_screen, screen.display));
    }
    started_screens_ = children_.size();
    if (!room_.tracker.empty()) children_.push_back(start_child(tracker_options(of_screen), ""));
  }
  ~Impl() {
    simulation_.end();  // its thread uses the server
    server_.reset();
    for (const pid_t child : children_) end_child(child);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void wait_for_screens() {
    const Stopwatch watch;
    const auto has_ended = [](pid_t child) {
      siginfo_t how{};
      waitid(P_PID, static_cast<id_t>(child), &how, WEXITED | WNOHANG | WNOWAIT);
      return how.si_pid == child;
    };
    const auto screens = std::span(children_).first(started_screens_);
    while (server_->counts().screens < static_cast<std::int64_t>(screens.size()) &&
           std::ranges::none_of(screens, has_ended) && watch.seconds() < start_seconds) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  const Room& room() const { return room_; }
  ScreenServer& server() { return *server_; }

 private:
  ViewOptions tracker_options(const ViewOptions& of_screen) const {
    ViewOptions options;
    options.join = of_screen.join;
    options.key = of_screen.key;
    options.tracker = room_.tracker;
    return options;
  }

  LiveSimulation& simulation_;
  Room room_;
  SceneSharer sharer_;
  std::optional<ScreenServer> server_;
  std::vector<pid_t> children_;
  std::size_t started_screens_ = 0;  ///< the first of the children
};

MasterScreens::MasterScreens(LiveSimulation& simulation,
                             const ViewScene& scene,
                             const ViewOptions& options)
    : impl_(std::make_unique<Impl>(simulation, scene, options)) {}

MasterScreens::~MasterScreens() = default;

void MasterScreens::wait_for_screens() {
  impl_->wait_for_screens();
}

void MasterScreens::set_view(const MasterView& view) {
  const RoomPlace place = place_of_camera(impl_->room(), view.camera);
  impl_->server().set_view(
      place, {static_cast<std::uint8_t>(view.volumes), view.shows_contacts, view.level, view.width,
              view.slices, view.cut, view.curve, view.rays});
}

const Room& MasterScreens::room() const {
  return impl_->room();
}

std::string MasterScreens::status() const {
  const ScreenCounts counts = impl_->server().counts();
  std::ostringstream text;
  text << counts.screens << " of " << impl_->room().screens.size() << " screens   "
       << static_cast<double>(counts.frame_bytes) / 1000 << " kB a frame   " << counts.frames
       << " frames";
  if (counts.ready_frames > 0) {
    const double each = counts.ready_seconds / static_cast<double>(counts.ready_frames);
    text << "   all ready after " << std::lround(1e6 * each) << " us";
  }
  if (counts.late > 0) text << "   " << counts.late << " late";
  if (counts.lost > 0) text << "   " << counts.lost << " lost";
  if (counts.has_lost_head) text << "   the head is not tracked";
  if (counts.malformed > 0) text << "   " << counts.malformed << " bad messages";
  return text.str();
}

void show_screen(const ViewOptions& options, const volatile std::sig_atomic_t& is_interrupted) {
  ScreenWindow window(options, keys_of(options, false));
  window.run(is_interrupted);
}

void send_head(const ViewOptions& options, const volatile std::sig_atomic_t& is_interrupted) {
  ScreenLink link(options.join, keys_of(options, false));
  if (!link.wait_for_master(start_seconds)) {
    throw std::runtime_error("no master at " + options.join);
  }
  if (options.tracker == "-") return send_head_lines(std::cin, link);
  send_tracked_head(options.tracker, link, is_interrupted);
}

void write_screen_keys(const std::string& name) {
  const std::string master_file = name + ".key", screen_file = name + "_screen.key";
  for (const std::string& file : {master_file, screen_file}) check_no_file(file);
  const ScreenKeys keys = make_screen_keys();
  umask(077);
  write_finished_file(master_file, master_text(keys));
  write_finished_file(screen_file, screen_text(keys));
}

}  // namespace tetwarp::view
