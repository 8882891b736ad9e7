#pragma once

// Parallel loops and task groups on oneTBB, which stays out of this header. Work is cut at boundaries that depend on
// the work alone, never on the number of threads, and each piece runs in the fixed FloatEnvironment: what a loop
// computes has the same bits for any thread count.

#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>

namespace rayloom {

namespace detail {
struct ThreadArena;
using ChunkFunction = void (*)(void* body, uint64_t begin, uint64_t end);
void parallel_chunks(uint64_t count, uint64_t grain, ChunkFunction function, void* body);
}  // namespace detail

/// Calls body(begin, end) for [0, grain), [grain, 2 grain), ... up to `count`, in any order, from several threads;
/// returns when all are done. `grain` 0 counts as 1. Should chunks throw, the exception of the lowest throwing chunk is
/// rethrown; every chunk below it has run, those above it may not have. Loops may nest; a thread that waits for an
/// inner loop takes no work from the outer one.
template <typename Body>
void parallel_for(uint64_t count, uint64_t grain, Body&& body) {
  using Function = std::remove_reference_t<Body>;
  detail::parallel_chunks(
      count, grain,
      [](void* function, uint64_t begin, uint64_t end) { (*static_cast<Function*>(function))(begin, end); },
      const_cast<void*>(static_cast<const void*>(std::addressof(body))));
}

/// Tasks that may spawn tasks, as a recursive builder does. A waiting thread works on other tasks, on top of its own
/// stack: spawn halves of large work only, and keep no thread-local state across wait().
class TaskGroup {
 public:
  TaskGroup();
  ~TaskGroup();  ///< waits; an exception not collected by wait() is lost
  TaskGroup(const TaskGroup&) = delete;
  TaskGroup& operator=(const TaskGroup&) = delete;

  /// Runs a copy of `function` at some time before wait() returns. May be called from a task of this group.
  template <typename Function>
  void run(Function&& function) {
    using Task = std::decay_t<Function>;
    run_task([](void* task) { (*static_cast<Task*>(task))(); }, [](void* task) { delete static_cast<Task*>(task); },
             new Task(std::forward<Function>(function)));
  }
  /// Waits for all tasks. Rethrows the first exception a task threw; tasks not started by then are dropped.
  void wait();

 private:
  using TaskFunction = void (*)(void*);
  void run_task(TaskFunction call, TaskFunction destroy, void* task);

  struct State;
  std::unique_ptr<State> state_;
};

/// Runs both functions, perhaps at the same time, and returns when both are done.
template <typename A, typename B>
void parallel_invoke(A&& a, B&& b) {
  TaskGroup group;
  group.run([&a] { a(); });
  b();
  group.wait();
}

/// While it lives, loops and groups of the whole process use `threads` threads, the calling one included; more than the
/// machine has cores is honoured too, 0 means as many as cores. The innermost limit holds. Make and destroy limits
/// outside of parallel work, in LIFO order.
class ThreadLimit {
 public:
  explicit ThreadLimit(unsigned threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  std::unique_ptr<detail::ThreadArena> outer_;
};

/// How many threads a loop may use now: the innermost ThreadLimit, or the cores this process may run on.
unsigned thread_limit();

/// How many different threads have run a chunk or task since the innermost ThreadLimit was made (or the process began),
/// for tests that must know what was really used. Short loops need not wake every thread.
unsigned threads_seen();

}  // namespace rayloom
