#pragma once

#include <stdexcept>
#include <string>

namespace rayloom {

/// The device is gone: a shader broke a rule for which DXR removes the device (ERR-01: recursion beyond the declared
/// depth, stack overflow). The message begins with the row's id. Every later use of that device throws it again.
class DeviceRemoved : public std::runtime_error {
 public:
  explicit DeviceRemoved(const std::string& reason) : std::runtime_error(reason) {}
};

}  // namespace rayloom
