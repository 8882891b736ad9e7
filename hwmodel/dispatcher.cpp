#include <rayloom/hwmodel/dispatcher.h>

#include <utility>

namespace rayloom::hwmodel {

Dispatcher::Dispatcher(Engine& engine, const Config& config, std::vector<uint64_t> warps)
    : Component(engine, "dispatcher"), config_(config), warps_(std::move(warps)) {}

void Dispatcher::connect(std::vector<const Component*> sms, uint32_t slots) {
  sms_ = std::move(sms);
  for (uint32_t round = 0; round < slots; ++round)
    for (uint32_t sm = 0; sm < sms_.size(); ++sm) free_slots_.push_back(sm);
}

void Dispatcher::start() { begin_launch(0); }

void Dispatcher::begin_launch(uint32_t launch) {
  while (launch < warps_.size() && warps_[launch] == 0) ++launch;
  launch_ = launch;
  if (launch >= warps_.size()) return;
  schedule(now() + config_.launch_overhead, *this, EventKind::launch_begin);
}

void Dispatcher::handle(const Event& event) {
  if (event.kind == EventKind::launch_begin) {
    next_warp_ = 0;
    unfinished_ = warps_[launch_];
    ++stats_.launches;
    return hand_out();
  }
  free_slots_.push_back(event.b);
  if (--unfinished_ == 0) return begin_launch(launch_ + 1);
  hand_out();
}

void Dispatcher::hand_out() {
  while (!free_slots_.empty() && next_warp_ < warps_[launch_]) {
    const uint32_t sm = free_slots_.front();
    free_slots_.pop_front();
    const Cycle start = port_.reserve(now(), config_.interval);
    schedule(start + config_.latency, *sms_[sm], EventKind::warp_arrives, next_warp_++, launch_);
    ++stats_.warps;
  }
}

void Dispatcher::describe_waiting(std::vector<std::string>& lines) const {
  if (unfinished_ > 0)
    lines.push_back(name() + " waits for " + std::to_string(unfinished_) + " warps of launch " +
                    std::to_string(launch_));
}

}  // namespace rayloom::hwmodel
