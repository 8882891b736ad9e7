#pragma once

// A candidate function that writes down what it is asked and answers as told.

#include "structures.h"

#include <functional>

namespace rayloom::accel::test {

class Recorder {
 public:
  using Answer = std::function<Verdict(const Candidate&)>;

  explicit Recorder(Answer answer = [](const Candidate&) { return Verdict{}; }) : answer_(std::move(answer)) {}

  TraceRequest request(const Block& block, const Ray& ray, uint32_t ray_flags = ray_flag::none) {
    TraceRequest request = request_for(block, ray, ray_flags);
    request.candidate = [](void* user, const Candidate& candidate) noexcept {
      auto& self = *static_cast<Recorder*>(user);
      self.candidates.push_back(candidate);
      return self.answer_(candidate);
    };
    request.user = this;
    return request;
  }

  /// Who was asked, in order, and with which t.
  std::vector<std::array<uint32_t, 4>> trail() const {
    std::vector<std::array<uint32_t, 4>> list;
    for (const Candidate& c : candidates)
      list.push_back({c.instance_index, c.geometry_index, c.primitive_index, std::bit_cast<uint32_t>(c.t)});
    return list;
  }

  std::vector<Candidate> candidates;

 private:
  Answer answer_;
};

}  // namespace rayloom::accel::test
