/// @file interrupt.hpp
/// Ctrl-C and SIGTERM. Unless a scope asks for politeness the command leaves at once, with exit
/// code 130 and without temporary files.
#pragma once

namespace tetwarp::cli {

/// Exit code after SIGINT or SIGTERM.
constexpr int interrupted_exit_code = 130;

/// Installs the handlers. Also ignores SIGXFSZ: a file size limit then is a write error like a full
/// disk, with a message and a clean-up.
void install_interrupt_handlers();

/// From now on the first signal is the last: politeness is for one process alone.
void leave_at_once();

/// While one exists the first signal only sets a flag; a second one leaves at once all the same.
class PoliteInterrupts {
 public:
  PoliteInterrupts();
  ~PoliteInterrupts();
  PoliteInterrupts(const PoliteInterrupts&) = delete;
  PoliteInterrupts& operator=(const PoliteInterrupts&) = delete;
};

/// True once a signal has set the flag.
bool is_interrupted();

/// Throws tetwarp::Cancelled once a signal has set the flag.
void stop_if_interrupted();

}  // namespace tetwarp::cli
