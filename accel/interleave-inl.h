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

#include <rayloom/accel/kept_array.h>
#include <rayloom/accel/ray_run.h>
#include <rayloom/accel/recent_occluders.h>
#include <rayloom/accel/traverse-inl.h>
#include <rayloom/accel/visitor.h>

#include <type_traits>

#ifdef HWY_TARGET_INCLUDE
HWY_BEFORE_NAMESPACE();
#define RAYLOOM_LANES HWY_NAMESPACE
#else
#define RAYLOOM_LANES scalar
#endif

#if !defined(HWY_TARGET_INCLUDE) || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::RAYLOOM_LANES {

/// Lies on the stack under the entries of a level: a leaf where the header is, whose lines may be asked for.
inline constexpr uint32_t level_end = node_ref::leaf_bit;

/// One ray on its way.
struct alignas(64) Task {
  uint32_t ref;   ///< what comes next
  uint32_t base;  ///< number of stack entries under those of the current level
  bool ended;
  bool begun;         ///< false: it tries RecentOccluders first, and levels[0] is not ready but for its block
  bool in_triangles;  ///< whether the leaves of the current level are triangles, not instances
  Level* level;       ///< the one of `levels` that `ref` belongs to
  size_t index;       ///< of the ray and its result
  // For tasks with hints: the rays to take next, up to `last`; the instance that occluded the task's last ray that was
  // occluded, a leaf of the top level or 0, and a node or leaf of its tree, or 0; what has been visited last.
  size_t next = 0, last = 0;
  uint32_t occluder = 0, place = 0;
  uint32_t node, leaf;
  /// Leaves of the top level that the ray has tried before all others, then 0. A vector's worth, more than
  /// RecentOccluders::push() pushes; one left out would only be visited twice.
  uint32_t tried[16] = {};
  Search search;
  InstanceRules rules;
  Level levels[2];  ///< the request's structure, and a bottom level entered from it
  TraversalStack stack;
  std::byte apart[768];  ///< keeps what tasks use at the same time out of the same cache sets, which repeat every 4 KiB

  void pop() { ref = stack.pop_ref(); }

  /// False, and nothing has changed, if the ray misses everything.
  bool enter(uint32_t slot, const std::byte* block, const BoundsLanes& bounds, uint32_t start, const Ray& ray) {
    level = std::construct_at(&levels[slot], block, bounds, ray, search);
    if (!level->ray.valid) return false;
    stack.push(level_end, 0);
    base = stack.size();
    ref = start;
    in_triangles = level->header().kind == StructureKind::triangles;
    return true;
  }
  template <Order order>
  void leave() {
    level = &levels[0];
    if (order == Order::distance) level->shorten(search);  // else the first hit has ended it all
    base = 1;
    in_triangles = false;
  }
  /// The lowest entry is a level_end.
  void end_if(bool hit) {
    ended |= hit;
    stack.resize(hit ? 1 : stack.size());
  }
};

/// Traces rays whose structure has a root that they want. `instances`: it is a top level. Result: Hit, or for
/// Order::stored a byte that tells whether the ray hits anything. `lazy`: structures may be. `hints`: rays that only
/// ask whether they hit anything try RecentOccluders first.
template <Order order, bool instances, class Result, bool lazy = false, bool hints = false>
class Interleaver {
  static_assert(!hints || (instances && !std::is_same_v<Result, Hit>), "which hit is found depends on what is tried");

 public:
  Interleaver(AddressSpace addresses, const RayRun& rays, Result* results)
      : addresses_(addresses), rays_(rays), results_(results), tasks_(std::min(rays.count, width)) {}

  void run() {
    for (size_t i = 0; i < std::min(rays_.count, width); ++i) {
      Task& task = tasks_.emplace_back();
      task.search = Search(*rays_.shared);
      task.rules = rules_;
      if (start_next(task)) set_ends(file(task, ends()));
    }
    while (nodes_->count + leaves_->count + others_->count != 0) {
      const bool leaves_now = leaves_->count >= enough || nodes_->count < enough;
      const List* const leaves = leaves_now ? &take(leaves_, spare_leaves_) : nullptr;  // asked for a round ago
      visit_nodes();
      if (leaves) visit_leaves(*leaves);
      visit_others();
    }
  }
  /// How many rays: all, or so many first ones that hints have shown not to be worth it.
  size_t traced() const { return next_; }

 private:
  static constexpr size_t width = 32;  ///< rays on their way: fewer hide less, more outgrow the first cache
  static constexpr size_t rays_ahead = hints ? 2 : 16;  ///< asked for before their turn
  /// Of neighbouring rays that a task with hints takes: longer ones are farther apart from other tasks' in memory.
  static constexpr size_t longest_run = 8;
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

  /// Without instances there is but one level, in a place known beforehand.
  static Level& level_of(Task& task) { return instances ? *task.level : task.levels[0]; }
  static const std::byte* address_of(Task& task) { return level_of(task).block + node_ref::offset(task.ref); }

  /// Puts the task on the list of what it needs next, without a branch.
  [[gnu::always_inline]] static Ends file(Task& task, Ends ends, bool really = true) {
    if (lazy) task.ref = past_built_part(level_of(task).block, task.ref);
    const uint32_t ref = task.ref;
    const bool inner = !node_ref::is_leaf(ref) & really;
    const bool triangles = node_ref::is_leaf(ref) & (ref != level_end) & (!instances | task.in_triangles) & really;
    Prefetch{level_of(task).block}(ref);
    *ends.nodes = *ends.leaves = *ends.others = &task;
    return {ends.nodes + inner, ends.leaves + triangles, ends.others + (!inner & !triangles & really)};
  }

  void visit_nodes() {
    const List& round = take(nodes_, spare_nodes_);
    Ends to = ends();
    for (uint32_t i = 0; i < round.count; ++i) {
      Task& task = *round.task[i];
      const Level& level = level_of(task);
      const Node8& node = level.node(task.ref);
      if (hints) task.node = task.ref;
      push_children<order>(test_node(BoxLanes(level.ray), node, level.t_near, level.t_far), node, task.stack);
      task.pop();
      to = file(task, to);
    }
    set_ends(to);
  }

  /// A leaf of which some triangle may be hit, popped from its task's stack.
  struct Met {
    Task* task;
    const TriangleLeaf* leaf;
    LeafMasks masks;
  };

  /// First all filters, without a branch that depends on a ray, then what they leave open.
  void visit_leaves(const List& round) {
    Ends to = ends();
    uint32_t met = 0;
    for (uint32_t i = 0; i < round.count; ++i) {
      Task& task = *round.task[i];
      const auto* leaf = reinterpret_cast<const TriangleLeaf*>(address_of(task));
      const LeafMasks masks = test_triangles(TriangleLanes(level_of(task).ray), *leaf, level_of(task).depths);
      const bool hit = occludes(task, masks), open = !hit & (masks.possible != 0 || is_stub(*leaf));
      // Member by member: GCC assembles a whole one on the stack and waits for it to come back.
      met_[met].task = &task;
      met_[met].leaf = leaf;
      met_[met].masks.possible = masks.possible;
      met_[met].masks.certain = masks.certain;
      met += open;
      if (hints) task.leaf = task.ref;
      task.end_if(hit);
      task.pop();
      to = file(task, to, !open);
    }
    for (uint32_t i = 0; i < met; ++i) to = finish_leaf(met_[i], to);
    set_ends(to);
  }

  /// Whether it stands for a part of a lazy structure.
  static bool is_stub(const TriangleLeaf& leaf) { return lazy && leaf.count == 0; }

  /// Whether a ray that needs no hit, but to know whether there is one, has its answer.
  static bool occludes(const Task& task, const LeafMasks& masks) {
    if constexpr (std::is_same_v<Result, Hit>) return false;
    return task.rules.hits.accepts_all & ((masks.certain & masks.inside) != 0);
  }

  static Ends finish_leaf(const Met& met, Ends to) {
    Task& task = *met.task;
    task.stack.restore_popped();
    if (is_stub(*met.leaf)) {
      task.ref = lazy_part_root(level_of(task).block, met.leaf);
      return file(task, to, true);
    }
    Visitor none;
    const TriangleLeaves leaves{task.rules};
    const Offer offer =
        leaves.offer_lanes(level_of(task), met.leaf, met.masks.possible, met.masks.certain, task.search, none);
    if (offer != Offer::rejected) note(offer, task);
    task.pop();
    return file(task, to, true);
  }

  void write_result(Task& task) {
    if constexpr (std::is_same_v<Result, Hit>)
      results_[task.index] = task.search.hit();
    else
      results_[task.index] = task.ended;
    if (hints && task.ended) note_occluder(task);
  }

  void note_occluder(Task& task) {
    task.occluder = leaf_ref(task.rules.instance);
    task.place = place_of_hit(task);
    recent_.note_occluder(task.occluder);
  }

  /// The node of the leaf where a ray has ended or, if that is not the last one visited, the leaf: the next ray often
  /// ends there. 0: the instance is entered at a leaf.
  static uint32_t place_of_hit(const Task& task) {
    if (node_ref::is_leaf(task.node)) return 0;
    const Node8& node = task.levels[1].node(task.node);
    bool found = false;
    for (int i = 0; i < 8; ++i) found |= node.child[i] == task.leaf;
    return found ? task.node : task.leaf;
  }

  /// Of a leaf of the request's structure.
  uint32_t leaf_ref(const std::byte* leaf) const {
    return node_ref::leaf_bit | static_cast<uint32_t>((leaf - rays_.shared->structure) / granule_bytes);
  }

  static void note(Offer offer, Task& task) {
    if (offer == Offer::ended) return task.end_if(true);
    level_of(task).shorten(task.search);
    if (order == Order::distance) drop_farther(task.stack, task.base, level_of(task).t_far);
  }

  void visit_others() {
    const List& round = take(others_, spare_others_);
    Ends to = ends();
    for (uint32_t i = 0; i < round.count; ++i) to = visit_other(*round.task[i], to);
    set_ends(to);
  }

  Ends visit_other(Task& task, Ends to) {
    if (instances && task.ref != level_end) {
      enter_instance(task);
    } else if (instances && task.level == &task.levels[1] && !task.ended) {
      leave_instance(task);
      try_hint(task);
    } else if (!(hints && !task.begun && !task.ended && begin_missed(task))) {
      write_result(task);
      if (!start_next(task)) return to;
      try_hint(task);
    }
    return file(task, to);
  }

  /// Enters the instance that a ray tries next: its record need not be waited for.
  void try_hint(Task& task) {
    if (hints && !task.begun && task.ref != level_end) enter_instance(task);
  }

  /// At the root, for a ray that recent occluders do not occlude.
  bool begin_missed(Task& task) {
    recent_.note_missed();
    task.begun = true;
    return task.enter(0, rays_.shared->structure, bounds_, root_, task.search.ray());
  }

  /// True: the ray visits first what occluded others.
  bool try_recent(Task& task) {
    task.begun = false;
    task.level = &task.levels[0];
    task.level->block = rays_.shared->structure;
    task.base = 1;
    task.in_triangles = false;
    task.stack.push(level_end, 0);
    recent_.push(task.stack, task.occluder);
    note_tried(task);
    task.pop();
    return true;
  }

  /// All that lies on the stack: a ray that they do not occlude passes them by later.
  static void note_tried(Task& task) {
    const uint32_t *const refs = task.stack.refs() + 1, count = task.stack.size() - 1;
    for (uint32_t i = 0; i < std::size(task.tried); ++i) task.tried[i] = i < count ? refs[i] : 0;
  }

  static bool has_tried(const Task& task) {
    bool same = false;
    for (const uint32_t ref : task.tried) same |= ref == task.ref;
    return same;
  }

  /// False: there is none.
  bool take_ray(Task& task) {
    if (hints && task.next == task.last && !take_run(task)) return false;
    if (!hints && next_ == rays_.count) return false;
    task.index = hints ? task.next++ : next_++;
    return true;
  }

  /// Short ones at the end, so that tasks end together.
  bool take_run(Task& task) {
    const size_t left = rays_.count - next_;
    if (left == 0 || recent_.given_up()) return false;
    task.next = next_;
    task.last = next_ += std::clamp<size_t>(left / (2 * width), 1, longest_run);
    return true;
  }

  /// Gives the task the next ray that does not miss at once; false if there is none.
  bool start_next(Task& task) {
    while (take_ray(task)) {
      const Ray& ray = rays_[task.index];
      __builtin_prefetch(reinterpret_cast<const std::byte*>(&ray) + rays_ahead * rays_.stride);
      task.search.restart(ray);
      task.stack.resize(0);
      task.ended = false;
      if (hints && !recent_.empty() && try_recent(task)) return true;
      if (hints) task.begun = true;
      if (task.enter(0, rays_.shared->structure, bounds_, root_, ray)) return true;
      write_result(task);
    }
    return false;
  }

  /// To where an instance is entered, or past it.
  void enter_instance(Task& task) {
    const auto& instance = *reinterpret_cast<const InstanceRecord*>(address_of(task));
    const TraceRequest& request = *rays_.shared;
    const std::byte* const block = addresses_.host(instance.bottom_level_address);
    const StructureHeader& header = header_of(block);
    const bool again = hints && task.begun && has_tried(task);
    if (!again && passes<lazy>(instance, request, header)) {
      Ray ray;
      object_ray_lanes(instance, task.search.ray(), ray);
      if (task.enter(1, block, BoundsLanes(header, 1), entry_of<lazy>(instance, header), ray)) {
        set_rules(task.rules, instance, request, rules_.hits);
        if (hints) begin_at_place(task);
        return;
      }
    }
    task.level = &task.levels[0];
    task.pop();
  }

  /// Before all of an instance comes the part where the task's last ray has ended.
  void begin_at_place(Task& task) {
    task.node = task.ref;
    if (task.begun || task.place == 0 || task.occluder != leaf_ref(task.rules.instance)) return;
    task.stack.push(task.ref, 0);
    task.ref = task.place;
  }

  void leave_instance(Task& task) {
    task.template leave<order>();
    if (order == Order::distance) drop_farther(task.stack, task.base, level_of(task).t_far);
    task.pop();
  }

  AddressSpace addresses_;
  const RayRun& rays_;
  Result* results_;
  const InstanceRules rules_{rays_.shared->ray_flags};  ///< of a bottom level without instance
  const BoundsLanes bounds_{header_of(rays_.shared->structure),
                            instances ? header_of(rays_.shared->structure).pad_scale : 1};
  const uint32_t root_ = start_of<lazy>(header_of(rays_.shared->structure));
  size_t next_ = 0;
  RecentOccluders recent_;
  KeptArray<Task> tasks_;
  Met met_[width];
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
