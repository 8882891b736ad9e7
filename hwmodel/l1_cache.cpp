#include <rayloom/hwmodel/l1_cache.h>

#include <algorithm>

namespace rayloom::hwmodel {

L1Cache::L1Cache(Engine& engine, uint32_t sm, const Config& config, const CrossbarConfig& crossbar)
    : Component(engine, "L1 " + std::to_string(sm)),
      config_(config),
      crossbar_(crossbar),
      sm_(sm),
      tags_(config.kilobytes * 1024 / (config.line_bytes * config.ways), config.ways),
      mshrs_(config.mshr_entries, config.mshr_waiters) {}

uint32_t L1Cache::new_transaction() {
  if (free_transactions_.empty()) {
    transactions_.emplace_back();
    return static_cast<uint32_t>(transactions_.size() - 1);
  }
  const uint32_t index = free_transactions_.back();
  free_transactions_.pop_back();
  return index;
}

void L1Cache::load(std::span<const LineRequest> lines, RequestClass request_class, const Component& client,
                   EventKind answer, uint32_t token) {
  const uint32_t index = new_transaction();
  const auto line_count = static_cast<uint32_t>(lines.size());
  transactions_[index] = {&client, answer, request_class, token, line_count, now(), 0, ServedBy::l1};
  for (const LineRequest& request : lines) {
    const Cycle time = port_.reserve(now(), config_.access_interval);
    stats_.accesses[request_class] += sector_count(request.sectors);
    ++stats_.line_accesses[request_class];
    if (access(index, request, time)) continue;
    ++stats_.mshr_full;
    blocked_.push_back({index, request, time});
  }
}

// Looks `request` up; false when it needs an MSHR and there is none.
bool L1Cache::access(uint32_t transaction, const LineRequest& request, Cycle time) {
  const RequestClass request_class = transactions_[transaction].request_class;
  const SectorMask missing = request.sectors & ~tags_.lookup(request.line);
  if (missing) {
    const auto [outcome, ask] = mshrs_.add(request.line, missing, transaction);
    if (outcome == MshrTable<uint32_t>::Outcome::full) return false;
    stats_.mshr_peak = std::max<uint64_t>(stats_.mshr_peak, mshrs_.size());
    stats_.misses[request_class] += sector_count(ask);
    stats_.half_misses[request_class] += sector_count(missing & ~ask);
    if (ask) request_from_l2({{request.line, ask}, request_class, false}, time);
  }
  stats_.hits[request_class] += sector_count(request.sectors & ~missing);
  if (!missing) line_done(transaction, time + config_.latency, ServedBy::l1);
  return true;
}

void L1Cache::store(std::span<const LineRequest> lines, RequestClass request_class) {
  for (const LineRequest& request : lines) {
    const Cycle time = port_.reserve(now(), config_.access_interval);
    stats_.stores[request_class] += sector_count(request.sectors);
    request_from_l2({request, request_class, true}, time);
  }
}

void L1Cache::request_from_l2(const MemoryMessage& message, Cycle time) {
  const uint32_t bytes = message.store ? sector_count(message.request.sectors) * sector_bytes : 1;
  const Cycle beats = (bytes + crossbar_.bytes_per_cycle - 1) / crossbar_.bytes_per_cycle;
  const Cycle start = request_port_.reserve(time, beats);
  schedule(start + beats - 1 + crossbar_.latency, *l2_, EventKind::memory_request, message.request.line,
           message.packed(), sm_);
}

void L1Cache::line_done(uint32_t index, Cycle time, ServedBy served_by) {
  Transaction& transaction = transactions_[index];
  transaction.ready = std::max(transaction.ready, time);
  transaction.served_by = std::max(transaction.served_by, served_by);
  if (--transaction.pending > 0) return;
  schedule(transaction.ready, *transaction.client, transaction.answer, transaction.token,
           static_cast<uint32_t>(transaction.mshr_wait), 0, static_cast<uint16_t>(transaction.served_by));
  free_transactions_.push_back(index);
}

void L1Cache::handle(const Event& event) {
  const auto sectors = static_cast<SectorMask>(event.b);
  tags_.fill(event.a, sectors, false);
  mshrs_.filled(event.a, sectors,
                [&](uint32_t transaction) { line_done(transaction, now(), static_cast<ServedBy>(event.detail)); });
  retry_blocked();
}

void L1Cache::retry_blocked() {
  while (!blocked_.empty()) {
    const Blocked blocked = blocked_.front();
    const Cycle waited = now() > blocked.since ? now() - blocked.since : 0;
    Transaction& transaction = transactions_[blocked.transaction];
    const Cycle before = transaction.mshr_wait;
    transaction.mshr_wait = std::max(before, waited);
    if (!access(blocked.transaction, blocked.request, std::max(now(), blocked.since))) {
      transaction.mshr_wait = before;
      return;
    }
    stats_.mshr_wait_cycles += waited;
    blocked_.pop_front();
  }
}

void L1Cache::describe_waiting(std::vector<std::string>& lines) const {
  for (const auto& entry : mshrs_.entries())
    lines.push_back(name() + " waits for L2: line " + std::to_string(entry.line));
  for (const Blocked& blocked : blocked_)
    lines.push_back(name() + " waits for an MSHR of its own: line " + std::to_string(blocked.request.line) + " for " +
                    transactions_[blocked.transaction].client->name());
}

}  // namespace rayloom::hwmodel
