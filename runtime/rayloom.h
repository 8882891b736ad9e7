#pragma once

// Everything a DXR program needs.

#include <rayloom/runtime/acceleration_structure.h>
#include <rayloom/runtime/device.h>
#include <rayloom/runtime/device_removed.h>
#include <rayloom/runtime/interlocked.h>
#include <rayloom/runtime/shader_table.h>
#include <rayloom/runtime/texture_views.h>
