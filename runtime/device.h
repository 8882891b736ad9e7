#pragma once

// The device: owns simulated memory, makes buffers and state objects, executes command lists. Several devices may live
// side by side; each may be used from one thread at a time (its dispatches use many).

#include <rayloom/runtime/buffer.h>
#include <rayloom/runtime/command_list.h>
#include <rayloom/runtime/dispatch.h>
#include <rayloom/runtime/dxr_types.h>
#include <rayloom/runtime/state_object.h>
#include <rayloom/runtime/validation.h>

#include <memory>
#include <span>
#include <string>

namespace rayloom {

struct DeviceOptions {
  uint64_t address_space_bytes = DeviceMemory::default_bytes;
  ValidationCallback validation = {};  ///< empty: the validation layer is off
};

class Device {
 public:
  explicit Device(DeviceOptions options = {});

  Buffer create_buffer(uint64_t bytes) { return Buffer(memory_, bytes); }
  /// A buffer with a copy of `data`.
  template <class T>
  Buffer upload(std::span<const T> data) {
    Buffer buffer = create_buffer(data.size_bytes());
    buffer.upload(data);
    return buffer;
  }
  template <class Container>
  Buffer upload(const Container& data) {
    return upload(std::span<const typename Container::value_type>(data));
  }

  std::shared_ptr<const StateObject> CreateStateObject(const STATE_OBJECT_DESC& desc);
  /// Looks at counts, flags and the null-ness of addresses alone (PB-02). Only pGeometryDescs is read.
  RAYTRACING_ACCELERATION_STRUCTURE_PREBUILD_INFO GetRaytracingAccelerationStructurePrebuildInfo(
      const BUILD_RAYTRACING_ACCELERATION_STRUCTURE_INPUTS& inputs) const;

  /// Runs the commands in order and returns when all are done. Throws what a shader threw, DeviceRemoved, or InputError
  /// for a command whose device memory does not hold what it says.
  ExecutionReport execute(const CommandList& list, const DispatchOptions& options = {});

  accel::AddressSpace addresses() const { return memory_->addresses(); }
  const DeviceMemory& memory() const { return *memory_; }
  void set_validation_callback(ValidationCallback callback) { *validation_ = std::move(callback); }
  const ValidationCallback& validation_callback() const { return *validation_; }
  /// Why the device was removed; empty while it is alive (ERR-01).
  const std::string& GetDeviceRemovedReason() const { return removed_reason_; }

 private:
  void check_alive() const;

  std::shared_ptr<DeviceMemory> memory_;
  std::shared_ptr<ValidationCallback> validation_;  ///< state objects speak to it too
  std::string removed_reason_;
};

}  // namespace rayloom
