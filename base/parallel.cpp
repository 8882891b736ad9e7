#include <rayloom/base/parallel.h>

#include <rayloom/base/float_environment.h>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#if RAYLOOM_TSAN
#include <sanitizer/tsan_interface.h>
#endif

namespace rayloom {

/// An arena of its own is what honours more threads than cores: TBB's implicit one is sized by the machine.
struct detail::ThreadArena {
  /// A thread at work for an arena: known to be in it, counted, and in the fixed float environment.
  class Work {
   public:
    explicit Work(ThreadArena& arena) : outer_(std::exchange(current, &arena)) { arena.mark_thread(); }
    ~Work() { current = outer_; }
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

   private:
    ThreadArena* outer_;
    FloatEnvironment environment_;
  };

  explicit ThreadArena(unsigned wanted)
      : threads(wanted != 0 ? wanted : static_cast<unsigned>(tbb::info::default_concurrency())),
        arena(static_cast<int>(threads)),
        seen(std::make_unique<std::atomic<bool>[]>(threads)) {}

  void mark_thread() {
    const auto slot = static_cast<unsigned>(tbb::this_task_arena::current_thread_index());
    if (slot < threads && !seen[slot].load(std::memory_order_relaxed)) seen[slot].store(true);
  }

  /// Runs `function` in the arena. Where it already runs in it, task_arena::execute would lift the isolation of the
  /// chunk that calls (see run_chunk).
  template <typename Function>
  void execute(Function&& function) {
    if (current == this) return function();
    arena.execute(function);
  }

  static thread_local ThreadArena* current;
  unsigned threads;
  tbb::task_arena arena;
  std::unique_ptr<std::atomic<bool>[]> seen;
};

thread_local detail::ThreadArena* detail::ThreadArena::current = nullptr;

namespace {

// ThreadSanitizer cannot see into TBB's library, so this file is compiled without it and says itself which work comes
// before which: what released an address happens before what acquires it afterwards.
void tsan_release([[maybe_unused]] void* address) {
#if RAYLOOM_TSAN
  __tsan_release(address);
#endif
}
void tsan_acquire([[maybe_unused]] void* address) {
#if RAYLOOM_TSAN
  __tsan_acquire(address);
#endif
}

/// The innermost limit. TBB takes the smallest of all living global_controls, so there is only one, remade on change.
class Parallel {
 public:
  static Parallel& instance() {
    static auto* const parallel = new Parallel;  // never destroyed: workers may outlive static destructors
    return *parallel;
  }
  detail::ThreadArena& state() { return *current_; }

  std::unique_ptr<detail::ThreadArena> exchange(std::unique_ptr<detail::ThreadArena> next) {
    allowed_.reset();
    allowed_.emplace(tbb::global_control::max_allowed_parallelism, next->threads);
    current_.swap(next);
    return next;
  }

 private:
  std::optional<tbb::global_control> allowed_;
  std::unique_ptr<detail::ThreadArena> current_ = std::make_unique<detail::ThreadArena>(0);
};

}  // namespace

ThreadLimit::ThreadLimit(unsigned threads)
    : outer_(Parallel::instance().exchange(std::make_unique<detail::ThreadArena>(threads))) {}
ThreadLimit::~ThreadLimit() { Parallel::instance().exchange(std::move(outer_)); }

unsigned thread_limit() { return Parallel::instance().state().threads; }

unsigned threads_seen() {
  const auto& state = Parallel::instance().state();
  return static_cast<unsigned>(std::count(state.seen.get(), state.seen.get() + state.threads, true));
}

namespace {

/// Keeps the exception of the lowest throwing chunk, so that which error a loop reports does not depend on timing.
class LowestError {
 public:
  bool reached(uint64_t chunk) const { return chunk > lowest_.load(std::memory_order_relaxed); }

  void keep(uint64_t chunk, std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (chunk >= lowest_.load(std::memory_order_relaxed)) return;
    lowest_.store(chunk, std::memory_order_relaxed);
    error_ = std::move(error);
  }

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic<uint64_t> lowest_{std::numeric_limits<uint64_t>::max()};
  std::exception_ptr error_;
  std::mutex mutex_;
};

}  // namespace

void detail::parallel_chunks(uint64_t count, uint64_t grain, ChunkFunction function, void* body) {
  if (count == 0) return;
  grain = std::max<uint64_t>(grain, 1);
  if (count <= grain) {
    // On the spot: a thread of the caller's own must not wait for a place among workers, who may be waiting for it.
    const FloatEnvironment environment;
    return function(body, 0, count);
  }
  auto& state = Parallel::instance().state();
  LowestError errors;
  const auto run_chunk = [&](uint64_t chunk) {
    if (errors.reached(chunk)) return;
    const detail::ThreadArena::Work work(state);
    const uint64_t begin = chunk * grain;
    tsan_acquire(body);
    try {
      // Isolated: a thread waiting for a loop or group inside this chunk must not pick up another chunk of ours.
      tbb::this_task_arena::isolate([&] { function(body, begin, begin + std::min(grain, count - begin)); });
    } catch (...) {
      errors.keep(chunk, std::current_exception());
    }
    tsan_release(&errors);
  };
  const uint64_t chunks = (count - 1) / grain + 1;
  tsan_release(body);
  state.execute([&] { tbb::parallel_for(uint64_t{0}, chunks, run_chunk); });
  tsan_acquire(&errors);
  errors.rethrow();
}

struct TaskGroup::State {
  detail::ThreadArena& limit = Parallel::instance().state();
  tbb::task_group group;
};

TaskGroup::TaskGroup() : state_(std::make_unique<State>()) {}

TaskGroup::~TaskGroup() {
  try {
    wait();
  } catch (...) {  // whoever wanted the exception would have waited
  }
}

void TaskGroup::run_task(TaskFunction call, TaskFunction destroy, void* task) {
  const std::shared_ptr<void> owned(task, [destroy](void* finished) {
    tsan_acquire(finished);  // the last owner may be the thread that spawned the task
    destroy(finished);
  });
  auto& state = *state_;
  tsan_release(task);
  state.limit.execute([&] {
    state.group.run([owned, call, &state] {
      const detail::ThreadArena::Work work(state.limit);
      tsan_acquire(owned.get());
      call(owned.get());
      tsan_release(owned.get());
      tsan_release(&state);
    });
  });
}

void TaskGroup::wait() {
  state_->limit.execute([&] { state_->group.wait(); });
  tsan_acquire(state_.get());
}

}  // namespace rayloom
