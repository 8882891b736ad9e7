#include <rayloom/hwmodel/engine.h>

#include <catch2/catch.hpp>
#include <string>
#include <vector>

using namespace rayloom::hwmodel;

namespace {

/// Writes down what it gets; may pass events on, or wait for ever.
class Probe : public Component {
 public:
  using Component::Component;
  using Component::schedule;
  void handle(const Event& event) override {
    log->push_back(name() + "@" + std::to_string(now()) + ":" + std::to_string(event.a));
    if (forward && event.a > 0) schedule(now() + event.b, *forward, EventKind::schedule, event.a - 1, event.b);
  }
  void describe_waiting(std::vector<std::string>& lines) const override {
    if (waits) lines.push_back(name() + " waits for nobody");
  }
  std::vector<std::string>* log = nullptr;
  Probe* forward = nullptr;
  bool waits = false;
};

}  // namespace

TEST_CASE("events come by time, then component, then order of scheduling") {
  Engine engine;
  std::vector<std::string> log;
  Probe a(engine, "a"), b(engine, "b");
  a.log = b.log = &log;
  b.schedule(5, b, EventKind::schedule, 1);
  b.schedule(5, a, EventKind::schedule, 2);
  b.schedule(5, a, EventKind::schedule, 3);
  a.schedule(2, b, EventKind::schedule, 4);
  engine.run();
  CHECK(log == std::vector<std::string>{"b@2:4", "a@5:2", "a@5:3", "b@5:1"});
  CHECK(engine.events_handled() == 4);
}

TEST_CASE("an event of this clock for an earlier component comes next") {
  Engine engine;
  std::vector<std::string> log;
  Probe a(engine, "a"), b(engine, "b"), c(engine, "c");
  a.log = b.log = c.log = &log;
  b.forward = &a;
  a.schedule(7, b, EventKind::schedule, 1, 0);
  a.schedule(7, c, EventKind::schedule, 0);
  engine.run();
  CHECK(log == std::vector<std::string>{"b@7:1", "a@7:0", "c@7:0"});
}

TEST_CASE("a scheduling into the past is a fault") {
  Engine engine;
  std::vector<std::string> log;
  Probe a(engine, "a");
  a.log = &log;
  a.schedule(3, a, EventKind::schedule);
  engine.run();
  CHECK_THROWS_AS(a.schedule(2, a, EventKind::schedule), std::logic_error);
}

TEST_CASE("work left without events is a deadlock that names who waits") {
  Engine engine;
  std::vector<std::string> log;
  Probe a(engine, "the bus"), b(engine, "the driver");
  a.log = b.log = &log;
  b.waits = true;
  a.schedule(11, a, EventKind::schedule);
  CHECK_THROWS_WITH(engine.run(), Catch::Contains("cycle 11") && Catch::Contains("the driver waits for nobody"));
}
