#include <rayloom/hwmodel/presets.h>

namespace rayloom::hwmodel {

namespace {

using enum Confidence;

// An NVIDIA TU102 as sold (RTX 2080 Ti). NVIDIA publishes neither box nor triangle rates nor the size of the RT core's
// buffer: these are readings of its marketing rate or choices, and say so.
constexpr PresetValue turing[] = {
    {"clock.core_mhz", 1545, vendor, "NVIDIA Turing whitepaper: 2080 Ti reference boost clock"},
    {"dispatcher.launch_overhead", 0, assumed, "launch cost outside the kernel is not modelled"},
    {"dispatcher.interval", 1, assumed, "one warp a clock"},
    {"dispatcher.latency", 20, assumed, "no published figure"},
    {"sm.count", 68, vendor, "NVIDIA Turing whitepaper: 2080 Ti"},
    {"sm.sub_partitions", 4, vendor, "NVIDIA Turing whitepaper: four processing blocks an SM"},
    {"sm.warp_slots", 32, vendor, "CUDA programming guide, compute capability 7.5: 32 warps an SM"},
    {"sm.bundle", 16, assumed, "granularity of this model, not of the hardware"},
    {"sm.dependency_latency", 4, measured, "dependent ALU instructions on Volta and Turing, microbenchmarks"},
    {"sm.special_interval", 4, derived, "special function units at a quarter of the ALU rate"},
    {"sm.memory_interval", 4, derived, "load/store units at a quarter of the ALU rate"},
    {"sm.trace_call_operations", 8, assumed, "to be calibrated"},
    {"sm.shader_call_operations", 4, assumed, "to be calibrated"},
    {"rt.warp_entries", 4, simulator, "Vulkan-Sim RTX2060 configuration: gpgpu_rt_max_warps"},
    {"rt.scheduler", 0, simulator, "Vulkan-Sim: first warp that is not stalled, by age"},
    {"rt.schedule_latency", 1, assumed, "one clock to pick"},
    {"rt.ray_bytes", 32, derived, "a RayDesc"},
    {"rt.accept_bytes_per_cycle", 128, assumed, "one register-file row a clock"},
    {"rt.fetch_bytes_per_cycle", 64, assumed, "no published figure; 32 to 128 are plausible"},
    {"rt.box_width", 8, derived, "10.5 clocks a ray at 10 Grays/s fit one 8-wide node a clock"},
    {"rt.box_interval", 1, derived, "as rt.box_width"},
    {"rt.box_latency", 10, simulator, "between Arches (12) and Vulkan-Sim (8); synthesised designs 13"},
    {"rt.triangle_rate", 1, derived, "10 Grays/s fit 1; NVIDIA gives only the doubling from Turing to Ampere"},
    {"rt.triangle_latency", 22, simulator, "Arches; synthesised designs 37"},
    {"rt.transform_interval", 4, assumed, "no published figure"},
    {"rt.transform_latency", 5, simulator, "synthesised in a follow-up of Vulkan-Sim"},
    {"rt.pop_cycles", 1, simulator, "Arches: POP_CULL takes one scheduler slot"},
    {"rt.callback_latency", 20, assumed, "to be calibrated"},
    {"rt.return_interval", 1, simulator, "Vulkan-Sim: at most one warp leaves a clock"},
    {"rt.return_latency", 4, assumed, "no published figure"},
    {"l1.kilobytes", 64, derived, "of 96 KB L1 and shared memory (whitepaper), the larger L1 split"},
    {"l1.line_bytes", 128, measured, "microbenchmarks of Volta and Turing: 128-byte lines, 32-byte sectors"},
    {"l1.ways", 4, assumed, "no published figure"},
    {"l1.latency", 32, measured, "RTX 2070, third-party microbenchmark"},
    {"l1.access_interval", 1, assumed, "one line a clock"},
    {"l1.mshr_entries", 256, simulator, "Arches"},
    {"l1.mshr_waiters", 8, assumed, "Arches has 16 subentries"},
    {"crossbar.latency", 80, assumed, "part of l2.latency; only the split is free"},
    {"crossbar.bytes_per_cycle", 32, assumed, "one sector a clock each way"},
    {"l2.slices", 22, derived, "two for each of 11 memory controllers, 5.5 MB in all"},
    {"l2.kilobytes_per_slice", 256, vendor, "NVIDIA Turing whitepaper: 5.5 MB in 22 slices"},
    {"l2.ways", 16, measured, "microbenchmarks of Volta and Turing"},
    {"l2.latency", 236, measured, "RTX 2070, third-party microbenchmark"},
    {"l2.bytes_per_cycle", 64, measured, "microbenchmarks of Volta and Turing"},
    {"l2.mshr_entries", 192, simulator, "Arches"},
    {"l2.mshr_waiters", 16, assumed, "Arches has 4 subentries"},
    {"dram.channels", 22, vendor, "352 bits in 16-bit GDDR6 channels"},
    {"dram.latency", 600, derived, "RTX 2070: 1000 to 1200 with a TLB miss of 472, third-party microbenchmark"},
    {"dram.bandwidth_mb_per_second", 616000, vendor, "352 bits at 14 Gb/s"},
};

constexpr PresetDefinition definitions[] = {
    {"turing", "like an NVIDIA RTX 2080 Ti (TU102); cycle-approximate, not calibrated", turing},
};

}  // namespace

std::span<const PresetDefinition> preset_definitions() { return definitions; }

}  // namespace rayloom::hwmodel
