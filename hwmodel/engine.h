#pragma once

// Runs components until nothing is left to do.

#include <rayloom/hwmodel/event_queue.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace rayloom::hwmodel {

class Engine;

/// A piece of the machine. Its number, given by the engine, breaks ties between events of one clock.
class Component {
 public:
  Component(Engine& engine, std::string name);
  virtual ~Component() = default;
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;

  virtual void handle(const Event& event) = 0;
  /// Adds a line "who waits for whom" for each piece of unfinished work held here; none when idle.
  virtual void describe_waiting(std::vector<std::string>& lines) const = 0;

  uint32_t id() const { return id_; }
  const std::string& name() const { return name_; }

 protected:
  Cycle now() const;
  void schedule(Cycle time, const Component& target, EventKind kind, uint64_t a = 0, uint32_t b = 0, uint32_t c = 0,
                uint16_t detail = 0);

 private:
  Engine& engine_;
  std::string name_;
  uint32_t id_;
};

/// The event queue ran dry while work was outstanding: a fault of the model. Names the waits.
class Deadlock : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Sees every event before it is handled; must not change anything. For timelines and for tests of determinism.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void on_event(const Event& event, const Component& target) = 0;
};

class Engine {
 public:
  Cycle now() const { return now_; }
  uint64_t events_handled() const { return events_handled_; }

  /// Handles events until none is left, then throws Deadlock if a component still waits.
  void run(Observer* observer = nullptr);

 private:
  friend class Component;
  void push(const Event& event);
  void check_nothing_waits() const;

  EventQueue queue_;
  std::vector<Component*> components_;
  Cycle now_ = 0;
  uint64_t events_handled_ = 0;
};

}  // namespace rayloom::hwmodel
