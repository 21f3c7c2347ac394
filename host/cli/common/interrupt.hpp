/// @file interrupt.hpp
/// Ctrl-C and SIGTERM. The command prints a line at once, removes its temporary files and exits
/// with code 130: without an InterruptFlag at once; with one at the next check of the flag, but at
/// most 0.7 s after the signal.
#pragma once

namespace tetwarp::cli {

/// Exit code after SIGINT or SIGTERM.
constexpr int interrupted_exit_code = 130;

/// Installs the handlers. Also ignores SIGXFSZ: beyond a file size limit writes then fail as on a
/// full disk, with a message, and temporary files are removed.
void install_interrupt_handlers();

/// From now on the first signal ends the process at once, without a line and regardless of an
/// InterruptFlag. For processes under mpirun, which sends signals also after errors.
void exit_on_first_signal();

/// While one exists the first signal sets a flag, so that the caller can finish its files, for
/// example the report of a batch. The second signal ends the process at once. So does a timer if
/// the flag is not checked in time.
class InterruptFlag {
 public:
  InterruptFlag();
  ~InterruptFlag();
  InterruptFlag(const InterruptFlag&) = delete;
  InterruptFlag& operator=(const InterruptFlag&) = delete;
};

/// While one exists a signal does not end the process, so that files that are changed in place are
/// complete; the process then ends when the last one is destroyed. For work that takes little time.
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
