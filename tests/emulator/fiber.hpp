/// @file fiber.hpp
/// A coroutine with its own stack: a call that can be suspended and resumed. Only the first switch
/// to a stack is one of ucontext, which makes a system call; the others are jumps of the compiler,
/// which cost less than those of the C library, unless the thread sanitizer follows them.
#pragma once
#include <ucontext.h>

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

#include "tests/emulator/race_order.hpp"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#endif

namespace tetwarp::simt {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool has_address_sanitizer = true;
#else
constexpr bool has_address_sanitizer = false;
#endif

/// One suspended or running call. resume() and suspend() must happen on the same OS thread.
class Fiber {
 public:
  Fiber() : stack_(new std::byte[stack_bytes]) {}
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Prepares a call of `entry`, which must not throw. A call that is still suspended is abandoned.
  void start(std::function<void()> entry) {
    entry_ = std::move(entry);
    if (std::exchange(is_idle_, false)) return;
    is_new_ = true;
#if defined(__SANITIZE_ADDRESS__)
    __asan_unpoison_memory_region(stack_.get(), stack_bytes);
#endif
    getcontext(&beginning_);
    beginning_.uc_stack.ss_sp = stack_.get();
    beginning_.uc_stack.ss_size = stack_bytes;
    beginning_.uc_link = nullptr;
    makecontext(&beginning_, &Fiber::run, 0);
  }

  /// Runs the call until it suspends itself or returns.
  void resume() {
    resumed = this;
    const Switch to_fiber(stack_.get(), stack_bytes);
    owner_race_ = race_.take_over();
    if constexpr (has_thread_sanitizer) {
      is_new_ = false;
      swapcontext(&owner_context_, &beginning_);
    } else if (__builtin_setjmp(owner_.data()) == 0) {
      if (std::exchange(is_new_, false)) setcontext(&beginning_);
      jump(own_);
    }
    to_fiber.came_back();
  }

  /// Called from inside the call: returns control to the caller of resume().
  void suspend() {
    const Switch to_owner(owner_stack_.bottom, owner_stack_.size);
    RaceThread::give_back(owner_race_);
    if constexpr (has_thread_sanitizer) {
      swapcontext(&beginning_, &owner_context_);
    } else if (__builtin_setjmp(own_.data()) == 0) {
      jump(owner_);
    }
    to_owner.came_back(&owner_stack_);
  }

  const RaceThread& race() const {
    return race_;
  }

  static constexpr std::size_t stack_bytes = std::size_t{128} * 1024;
  const std::byte* stack() const {
    return stack_.get();
  }

 private:
  using Place = std::array<void*, 5>;  ///< of __builtin_setjmp()
  /// Not inlined: a function must not jump to a place of its own.
  [[gnu::noinline, noreturn]] static void jump(Place& place) {
    __builtin_longjmp(place.data(), 1);
  }

  struct StackRange {
    const void* bottom = nullptr;
    std::size_t size = 0;
  };

  /// Announces a switch of stacks to the address sanitizer; does nothing without one.
  class Switch {
   public:
#if defined(__SANITIZE_ADDRESS__)
    Switch(const void* bottom, std::size_t size) {
      __sanitizer_start_switch_fiber(&saved_, bottom, size);
    }
    void came_back(StackRange* left = nullptr) const {
      arrived(saved_, left);
    }
    static void arrived(void* saved, StackRange* left) {
      __sanitizer_finish_switch_fiber(saved, left ? &left->bottom : nullptr,
                                      left ? &left->size : nullptr);
    }

   private:
    void* saved_ = nullptr;
#else
    Switch(const void*, std::size_t) {}
    void came_back(StackRange* = nullptr) const {}
    static void arrived(void*, StackRange*) {}
#endif
  };

  static void run() {
    Fiber& self = *resumed;
    Switch::arrived(nullptr, &self.owner_stack_);
    for (;;) {
      self.entry_();
      self.is_idle_ = true;
      self.suspend();
    }
  }

  static inline thread_local Fiber* resumed =
      nullptr;  ///< argument of run(), which makecontext() cannot pass

  std::unique_ptr<std::byte[]> stack_;
  std::function<void()> entry_;
  bool is_idle_ = false;    ///< run() waits for the next call
  bool is_new_ = false;     ///< run() has to be entered at its beginning
  ucontext_t beginning_{};  ///< with the thread sanitizer: where the call was suspended
  ucontext_t owner_context_{};
  RaceThread race_;
  void* owner_race_ = nullptr;
  Place own_{};
  Place owner_{};
  StackRange owner_stack_;
};

}  // namespace tetwarp::simt
