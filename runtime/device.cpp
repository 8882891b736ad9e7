#include <rayloom/base/error.h>
#include <rayloom/runtime/device.h>
#include <rayloom/runtime/device_removed.h>
#include <rayloom/runtime/execute.h>

#include <cstring>
#include <type_traits>

namespace rayloom {
namespace {

std::byte* checked(const DeviceMemory& memory, uint64_t address, uint64_t bytes, const char* command) {
  if (!memory.holds(address, bytes)) throw InputError(command, "", "a buffer was freed before the list executed");
  return memory.host(address);
}

/// Runs one command; dispatches add their report.
class Executor {
 public:
  Executor(const DeviceMemory& memory, const DispatchOptions& options, detail::ValidationLog& log)
      : memory_(memory), options_(options), log_(log) {}

  void operator()(const detail::BuildCommand& command) { detail::build_acceleration_structure(command, memory_, log_); }
  void operator()(const detail::CopyCommand& command) {
    std::memmove(checked(memory_, command.destination, command.bytes, "CopyBufferRegion"),
                 checked(memory_, command.source, command.bytes, "CopyBufferRegion"), command.bytes);
  }
  void operator()(const detail::FillCommand& command) {
    std::byte* const target = checked(memory_, command.destination, command.bytes, "FillBuffer");
    for (uint64_t i = 0; i < command.bytes; i += 4) std::memcpy(target + i, &command.value, 4);
  }
  void operator()(const detail::UploadCommand& command) {
    std::byte* const target = checked(memory_, command.destination, command.data.size(), "WriteBuffer");
    if (!command.data.empty()) std::memcpy(target, command.data.data(), command.data.size());
  }
  void operator()(const detail::DispatchCommand& command) {
    report_.dispatches.push_back(detail::dispatch_rays(command, options_, memory_, log_));
  }

  ExecutionReport& report() { return report_; }

 private:
  const DeviceMemory& memory_;
  const DispatchOptions& options_;
  detail::ValidationLog& log_;
  ExecutionReport report_;
};

}  // namespace

ShaderMemoryScope::ShaderMemoryScope(const Device& device) : outer_(detail::shader_memory) {
  detail::shader_memory = device.memory().shader_memory();
}

Device::Device(DeviceOptions options)
    : memory_(std::make_shared<DeviceMemory>(options.address_space_bytes)),
      validation_(std::make_shared<ValidationCallback>(std::move(options.validation))) {}

void Device::check_alive() const {
  if (!removed_reason_.empty()) throw DeviceRemoved(removed_reason_);
}

std::shared_ptr<const StateObject> Device::CreateStateObject(const STATE_OBJECT_DESC& desc) {
  check_alive();
  return std::make_shared<const StateObject>(desc, validation_);
}

RAYTRACING_ACCELERATION_STRUCTURE_PREBUILD_INFO Device::GetRaytracingAccelerationStructurePrebuildInfo(
    const BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS& inputs) const {
  return detail::prebuild_info(inputs, detail::copy_geometries(inputs));
}

ExecutionReport Device::execute(const CommandList& list, const DispatchOptions& options) {
  check_alive();
  detail::ValidationLog log(*validation_);
  Executor executor(*memory_, options, log);
  try {
    for (const detail::Command& command : list.commands()) {
      std::visit(executor, command);
      log.flush();
    }
  } catch (const DeviceRemoved& removed) {
    log.flush();
    removed_reason_ = removed.what();
    throw;
  } catch (...) {
    log.flush();
    throw;
  }
  return std::move(executor.report());
}

}  // namespace rayloom
