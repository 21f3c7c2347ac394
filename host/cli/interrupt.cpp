#include "host/cli/interrupt.hpp"

#include <unistd.h>

#include <csignal>
#include <tetwarp/error.hpp>

#include "io/finished_file.hpp"

namespace tetwarp::cli {
namespace {
volatile std::sig_atomic_t flag = 0;
volatile std::sig_atomic_t flag_scopes = 0;  // InterruptFlag objects that exist

// Makes async-signal-safe calls only.
void handle(int) {
  if (flag_scopes > 0 && flag == 0) {
    flag = 1;
    return;
  }
  remove_unfinished_files();
  _exit(interrupted_exit_code);
}
}  // namespace

void install_interrupt_handlers() {
  struct sigaction action = {};
  action.sa_handler = handle;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
}

void exit_on_first_signal() {
  flag_scopes = -1'000'000;  // far below zero: scopes cannot make it positive
}

InterruptFlag::InterruptFlag() {
  flag_scopes = flag_scopes + 1;
}
InterruptFlag::~InterruptFlag() {
  flag_scopes = flag_scopes - 1;
}

bool is_interrupted() {
  return flag != 0;
}

void stop_if_interrupted() {
  if (is_interrupted()) throw Cancelled();
}

}  // namespace tetwarp::cli
