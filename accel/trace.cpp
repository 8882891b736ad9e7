#include <rayloom/accel/simd/kernel.h>
#include <rayloom/accel/trace.h>
#include <rayloom/base/error.h>
#include <rayloom/base/float_environment.h>

#include <atomic>
#include <cassert>
#include <string>

namespace rayloom::accel {
namespace {

const Kernel* kernel_of(Isa isa) { return isa == Isa::scalar ? &scalar_kernel : highway_kernel(isa); }

Isa fastest_isa() {
  if (isa_supported(Isa::avx512)) return Isa::avx512;
  return isa_supported(Isa::avx2) ? Isa::avx2 : Isa::scalar;
}

struct Choice {
  std::atomic<Isa> isa;
  std::atomic<const Kernel*> kernel;
  explicit Choice(Isa first) : isa(first), kernel(kernel_of(first)) {}
};

Choice& choice() {
  static Choice current(fastest_isa());
  return current;
}

const Kernel& current_kernel() { return *choice().kernel.load(std::memory_order_relaxed); }

/// Whether the caller already runs in the fixed FloatEnvironment: entering it costs more than a short ray.
bool environment_is_fixed() {
#if defined(__x86_64__)
  constexpr uint32_t exception_flags = 0x3F;
  return (_mm_getcsr() & ~exception_flags) == FloatEnvironment::fixed_mxcsr;  // nothing here uses the x87
#else
  return false;
#endif
}

}  // namespace

Hit trace(AddressSpace addresses, const TraceRequest& request) {
  if (environment_is_fixed()) return current_kernel().trace_one(addresses, request);
  const FloatEnvironment environment;
  return current_kernel().trace_one(addresses, request);
}

void trace(AddressSpace addresses, std::span<const TraceRequest> requests, std::span<Hit> hits) {
  assert(requests.size() == hits.size());
  const FloatEnvironment environment;
  current_kernel().trace_many(addresses, requests, hits);
}

void trace(AddressSpace addresses, const TraceRequest& shared, std::span<const Ray> rays, std::span<Hit> hits) {
  assert(rays.size() == hits.size());
  const FloatEnvironment environment;
  current_kernel().trace_rays(addresses, {&shared, rays.data(), sizeof(Ray), rays.size()}, hits.data());
}

void occluded(AddressSpace addresses, const TraceRequest& shared, std::span<const Ray> rays,
              std::span<uint8_t> results) {
  assert(rays.size() == results.size());
  const FloatEnvironment environment;
  TraceRequest any_hit = shared;
  any_hit.ray_flags |= ray_flag::accept_first_hit_and_end_search;
  current_kernel().occlude_rays(addresses, {&any_hit, rays.data(), sizeof(Ray), rays.size()}, results.data());
}

std::string_view isa_name(Isa isa) {
  constexpr std::string_view names[] = {"scalar", "avx2", "avx512"};
  return names[static_cast<uint8_t>(isa)];
}

bool isa_supported(Isa isa) { return kernel_of(isa) != nullptr; }

Isa current_isa() { return choice().isa; }

void set_isa(Isa isa) {
  const Kernel* kernel = kernel_of(isa);
  if (!kernel) throw InputError("instruction set " + std::string(isa_name(isa)) + " is not supported by this CPU");
  choice().isa = isa;
  choice().kernel = kernel;
}

}  // namespace rayloom::accel
