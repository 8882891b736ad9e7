#include <rayloom/hwmodel/engine.h>

#include <utility>

namespace rayloom::hwmodel {

Component::Component(Engine& engine, std::string name)
    : engine_(engine), name_(std::move(name)), id_(static_cast<uint32_t>(engine.components_.size())) {
  engine.components_.push_back(this);
}

Cycle Component::now() const { return engine_.now_; }

void Component::schedule(Cycle time, const Component& target, EventKind kind, uint64_t a, uint32_t b, uint32_t c,
                         uint16_t detail) {
  engine_.push({time, 0, a, b, c, target.id_, kind, detail});
}

void Engine::push(const Event& event) {
  if (event.time < now_) throw std::logic_error("hwmodel: an event was scheduled in the past");
  queue_.push(event);
}

void Engine::run(Observer* observer) {
  while (!queue_.empty()) {
    const Event event = queue_.pop();
    now_ = event.time;
    ++events_handled_;
    Component& target = *components_[event.component];
    if (observer) observer->on_event(event, target);
    target.handle(event);
  }
  check_nothing_waits();
}

void Engine::check_nothing_waits() const {
  std::vector<std::string> lines;
  for (const Component* component : components_) component->describe_waiting(lines);
  if (lines.empty()) return;
  std::string text = "hwmodel: deadlock at cycle " + std::to_string(now_) + ", no event is left but:";
  for (const std::string& line : lines) text += "\n  " + line;
  throw Deadlock(text);
}

}  // namespace rayloom::hwmodel
