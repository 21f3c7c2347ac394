/// @file interrupt.hpp
/// Ctrl-C and SIGTERM. The command prints a line at once, removes its temporary files and exits
/// with code 130: at the next check of a flag while an InterruptFlag exists, but no later than 0.7
/// s after the signal; at once elsewhere.
#pragma once

namespace tetwarp::cli {

/// Exit code after SIGINT or SIGTERM.
constexpr int interrupted_exit_code = 130;

/// Installs the handlers. Also ignores SIGXFSZ: beyond a file size limit writes then fail as on a
/// full disk, with a message, and temporary files are removed.
void install_interrupt_handlers();

/// From now on the first signal ends the process at once and without a line, whether or not an
/// InterruptFlag exists: for processes under mpirun, which sends signals after errors, too.
void exit_on_first_signal();

/// While one exists the first signal sets a flag, so that the work in hand can be ended in order:
/// e.g. the report of a batch is written. The second signal ends the process at once, and so does a
/// timer where the flag is not checked in time.
class InterruptFlag {
 public:
  InterruptFlag();
  ~InterruptFlag();
  InterruptFlag(const InterruptFlag&) = delete;
  InterruptFlag& operator=(const InterruptFlag&) = delete;
};

/// While one exists a signal does not end the process, so that a file that is changed in place is
/// left complete; the process ends when the last one is gone. For short work.
class SignalHold {
 public:
  SignalHold();
  ~SignalHold();
  SignalHold(const SignalHold&) = delete;
  SignalHold& operator=(const SignalHold&) = delete;
};

/// True once a signal has set the flag.
bool is_interrupted();

/// Throws tetwarp::Cancelled once a signal has set the flag.
void stop_if_interrupted();

}  // namespace tetwarp::cli
