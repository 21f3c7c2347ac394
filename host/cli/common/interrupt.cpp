/// @file interrupt.cpp
/// The handlers of signals.
#include "host/cli/common/interrupt.hpp"

#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <string_view>
#include <tetwarp/error.hpp>

#include "host/cli/common/ranks.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/read_check.hpp"

namespace tetwarp::cli {
namespace {
constexpr suseconds_t grace = 700'000;  // microseconds between the first signal and the end

volatile std::sig_atomic_t flag = 0;
volatile std::sig_atomic_t flag_scopes = 0;  // InterruptFlag objects that exist
volatile std::sig_atomic_t holds = 0;        // number of SignalHold objects
volatile std::sig_atomic_t ends_after_hold = 0;
volatile std::sig_atomic_t is_silent = 0;    // one of several ranks
volatile std::sig_atomic_t is_terminal = 0;  // standard error shows a progress bar

// Handlers make async-signal-safe calls only. setitimer() is such a call on Linux, where it is a
// plain system call.

void say(std::string_view line) {
  constexpr std::string_view clear = "\r\033[K";
  if (is_silent != 0) return;
  if (is_terminal != 0 && write(STDERR_FILENO, clear.data(), clear.size()) < 0) return;
  if (write(STDERR_FILENO, line.data(), line.size()) < 0) return;
}

void end_process(int) {
  if (holds > 0) {
    ends_after_hold = 1;
    return;
  }
  remove_unfinished_files();
  _exit(interrupted_exit_code);
}

void handle(int signal) {
  if (flag == 0 && flag_scopes > 0) {
    flag = 1;
    say("tetwarp: interrupted, stopping\n");
    const itimerval timer{{0, 0}, {0, grace}};
    setitimer(ITIMER_REAL, &timer, nullptr);
    return;
  }
  if (flag == 0) say("tetwarp: interrupted\n");
  end_process(signal);
}

void install_handler(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}
}  // namespace

void install_interrupt_handlers() {
  is_terminal = isatty(STDERR_FILENO);
  // When a rank has printed an error and ended, mpirun ends the others by a signal.
  is_silent = launched_count() > 1;
  set_read_check(stop_if_interrupted);
  install_handler(SIGINT, handle);
  install_handler(SIGTERM, handle);
  install_handler(SIGALRM, end_process);
  std::signal(SIGXFSZ, SIG_IGN);
}

void exit_on_first_signal() {
  flag_scopes = -1'000'000;  // InterruptFlag objects cannot make it positive
}

InterruptFlag::InterruptFlag() {
  flag_scopes = flag_scopes + 1;
}
InterruptFlag::~InterruptFlag() {
  flag_scopes = flag_scopes - 1;
}

SignalHold::SignalHold() {
  holds = holds + 1;
}
SignalHold::~SignalHold() {
  holds = holds - 1;
  if (holds == 0 && ends_after_hold != 0) end_process(0);
}

bool is_interrupted() {
  return flag != 0;
}

void stop_if_interrupted() {
  if (is_interrupted()) throw Cancelled();
}

}  // namespace tetwarp::cli
