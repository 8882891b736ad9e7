// Many independent rays in one thread: while the bytes that one ray needs next are on their way, the others take their
// steps. Rays stand in lists by what they need next (node, triangle leaf, anything else), so that a round runs the same
// straight-line code for one ray after another, without a branch that depends on a ray, and the processor overlaps
// them. Each ray takes the way that traverse() takes. Re-included once per target as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_INTERLEAVE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_INTERLEAVE_INL_H
#undef RAYLOOM_ACCEL_INTERLEAVE_INL_H
#else
#define RAYLOOM_ACCEL_INTERLEAVE_INL_H
#endif
// clang-format on

#include <rayloom/accel/ray_run.h>
#include <rayloom/accel/traverse-inl.h>
#include <rayloom/accel/visitor.h>

#include <memory>
#include <type_traits>

#ifdef HWY_TARGET_INCLUDE
HWY_BEFORE_NAMESPACE();
#define RAYLOOM_LANES HWY_NAMESPACE
#else
#define RAYLOOM_LANES scalar
#endif

#if !defined(HWY_TARGET_INCLUDE) || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::RAYLOOM_LANES {

/// Lies on the stack under the entries of a level.
inline constexpr uint32_t level_end = no_index;

/// One ray on its way.
struct alignas(64) Task {
  uint32_t ref;   ///< what comes next
  uint32_t base;  ///< number of stack entries under those of the current level
  bool ended;
  bool in_triangles;  ///< whether the leaves of the current level are triangles, not instances
  Level* level;       ///< the one of `levels` that `ref` belongs to
  size_t index;       ///< of the ray and its result
  Search search;
  InstanceRules rules;
  Level levels[2];  ///< the request's structure, and a bottom level entered from it
  TraversalStack stack;
  std::byte apart[832];  ///< keeps what tasks use at the same time out of the same cache sets, which repeat every 4 KiB

  const std::byte* address() const { return level->block + node_ref::offset(ref); }
  void pop() { ref = stack.pop_ref(); }

  /// False, and nothing has changed, if the ray misses everything.
  bool enter(uint32_t slot, const std::byte* block, uint32_t start, const Ray& ray, float pad_scale) {
    level = std::construct_at(&levels[slot], block, ray, pad_scale, search);
    if (!level->ray.valid) return false;
    stack.push(level_end, 0);
    base = stack.size();
    ref = start;
    in_triangles = level->header().kind == StructureKind::triangles;
    return true;
  }
  void leave() {
    level = &levels[0];
    level->shorten(search);
    base = 1;
    in_triangles = false;
  }
  void end() {
    ended = true;
    stack.resize(0);
    stack.push(level_end, 0);
  }
};

/// Traces rays whose structure has a root that they want. `instances`: it is a top level. Result: Hit, or for
/// Order::stored a byte that tells whether the ray hits anything.
template <Order order, bool instances, class Result>
class Interleaver {
 public:
  Interleaver(AddressSpace addresses, const RayRun& rays, Result* results)
      : addresses_(addresses), rays_(rays), results_(results), tasks_(new Task[std::min(rays.count, width)]) {}

  void run() {
    for (size_t i = 0; i < std::min(rays_.count, width); ++i) start_next(tasks_[i]);
    while (nodes_->count + leaves_->count + others_->count != 0) {
      const bool leaves_now = leaves_->count >= enough || nodes_->count < enough;
      const List* const leaves = leaves_now ? &take(leaves_, spare_leaves_) : nullptr;  // asked for a round ago
      visit_nodes();
      if (leaves) visit_leaves(*leaves);
      visit_others();
    }
  }

 private:
  static constexpr size_t width = 32;    ///< rays on their way: fewer hide less, more outgrow the first cache
  static constexpr uint32_t enough = 8;  ///< leaves wait for one another while there are as many nodes

  struct List {
    uint32_t count = 0;
    Task* task[width + 1];
    Task** end() { return task + count; }
  };

  /// The tasks of a list, which is empty then: a task's next step may be of the same kind.
  static List& take(List*& list, List*& spare) {
    std::swap(list, spare);
    list->count = 0;
    return *spare;
  }

  /// The three lists' ends, in registers while a round files tasks.
  struct Ends {
    Task **nodes, **leaves, **others;
  };
  Ends ends() const { return {nodes_->end(), leaves_->end(), others_->end()}; }
  void set_ends(const Ends& ends) {
    nodes_->count = static_cast<uint32_t>(ends.nodes - nodes_->task);
    leaves_->count = static_cast<uint32_t>(ends.leaves - leaves_->task);
    others_->count = static_cast<uint32_t>(ends.others - others_->task);
  }

  /// Puts the task on the list of what it needs next, without a branch.
  [[gnu::always_inline]] static Ends file(Task& task, Ends ends) {
    const uint32_t ref = task.ref;
    const bool inner = !node_ref::is_leaf(ref);
    const bool triangles = !inner & (ref != level_end) & (!instances | task.in_triangles);
    Prefetch{task.level->block}(ref == level_end ? 0 : ref);
    *ends.nodes = *ends.leaves = *ends.others = &task;
    return {ends.nodes + inner, ends.leaves + triangles, ends.others + (!inner & !triangles)};
  }
  void file(Task& task) { set_ends(file(task, ends())); }

  void visit_nodes() {
    const List& round = take(nodes_, spare_nodes_);
    Ends to = ends();
    for (uint32_t i = 0; i < round.count; ++i) {
      Task& task = *round.task[i];
      const Level& level = *task.level;
      const Node8& node = level.node(task.ref);
      push_children<order>(test_node(BoxLanes(level.ray), node, level.t_near, level.t_far), node, task.stack);
      task.pop();
      to = file(task, to);
    }
    set_ends(to);
  }

  void visit_leaves(const List& round) {
    Ends to = ends();
    for (uint32_t i = 0; i < round.count; ++i) {
      Task& task = *round.task[i];
      const Offer offer = visit_leaf(task);
      if (offer != Offer::rejected) note(offer, task);
      task.pop();
      to = file(task, to);
    }
    set_ends(to);
  }

  static Offer visit_leaf(Task& task) {
    const TriangleLanes lanes(task.level->ray);
    const TriangleLeaves leaves{task.rules};
    if constexpr (std::is_same_v<Result, Hit>) {
      Visitor none;
      return leaves.visit(*task.level, lanes, task.address(), task.search, none);
    } else {
      return leaves.occludes(*task.level, lanes, task.address(), task.search) ? Offer::ended : Offer::rejected;
    }
  }

  void write_result(const Task& task) {
    if constexpr (std::is_same_v<Result, Hit>)
      results_[task.index] = task.search.hit();
    else
      results_[task.index] = task.ended;
  }

  void note(Offer offer, Task& task) {
    if (offer == Offer::ended) return task.end();
    task.level->shorten(task.search);
    if (order == Order::distance) drop_farther(task.stack, task.base, task.level->t_far);
  }

  void visit_others() {
    const List& round = take(others_, spare_others_);
    for (uint32_t i = 0; i < round.count; ++i) {
      Task& task = *round.task[i];
      if (instances && task.ref != level_end) {
        enter_instance(task);
      } else if (instances && task.level == &task.levels[1] && !task.ended) {
        leave_instance(task);
      } else {
        write_result(task);
        start_next(task);
      }
    }
  }

  /// Gives the task the next ray that does not miss at once, if there is one.
  void start_next(Task& task) {
    const std::byte* const block = rays_.shared->structure;
    const StructureHeader& header = header_of(block);
    const float pad_scale = instances ? header.pad_scale : 1;
    while (next_ != rays_.count) {
      const Ray& ray = rays_[next_];
      task.index = next_++;
      task.search = Search(*rays_.shared, ray);
      task.stack.resize(0);
      task.ended = false;
      if (task.enter(0, block, header.root, ray, pad_scale)) {
        task.rules = rules_;
        return file(task);
      }
      write_result(task);
    }
  }

  /// To where an instance is entered, or past it.
  void enter_instance(Task& task) {
    const auto& instance = *reinterpret_cast<const InstanceRecord*>(task.address());
    const TraceRequest& request = task.search.request();
    const std::byte* const block = addresses_.host(instance.bottom_level_address);
    const StructureHeader& header = header_of(block);
    if (!passes(instance, request, header) ||
        !task.enter(1, block, entry_of(instance, header), object_ray(instance, task.search.ray()), 1)) {
      task.level = &task.levels[0];
      task.pop();
    } else {
      task.rules = rules_of(instance, request);
    }
    file(task);
  }

  void leave_instance(Task& task) {
    task.leave();
    if (order == Order::distance) drop_farther(task.stack, task.base, task.level->t_far);
    task.pop();
    file(task);
  }

  AddressSpace addresses_;
  const RayRun& rays_;
  Result* results_;
  const InstanceRules rules_{0, 0, rays_.shared->ray_flags, nullptr};  ///< of a bottom level without instance
  size_t next_ = 0;
  std::unique_ptr<Task[]> tasks_;
  List lists_[6];
  List *nodes_ = &lists_[0], *spare_nodes_ = &lists_[1];
  List *leaves_ = &lists_[2], *spare_leaves_ = &lists_[3];
  List *others_ = &lists_[4], *spare_others_ = &lists_[5];
};

}  // namespace rayloom::accel::RAYLOOM_LANES
#endif  // target

#undef RAYLOOM_LANES
#ifdef HWY_TARGET_INCLUDE
HWY_AFTER_NAMESPACE();
#endif

#endif  // once a target
