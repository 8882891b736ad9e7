#include "accessors.h"

#include <rayloom/base/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rayloom::scenes::gltf {
namespace {

/// Columns and rows of a type; columns of matrices start at multiples of four bytes (glTF 2.0, 3.6.2.4).
struct Shape {
  uint64_t columns, rows;
};

Shape shape_of(int type) {
  switch (type) {
    case TINYGLTF_TYPE_VEC2:
      return {1, 2};
    case TINYGLTF_TYPE_VEC3:
      return {1, 3};
    case TINYGLTF_TYPE_VEC4:
      return {1, 4};
    case TINYGLTF_TYPE_MAT2:
      return {2, 2};
    case TINYGLTF_TYPE_MAT3:
      return {3, 3};
    case TINYGLTF_TYPE_MAT4:
      return {4, 4};
    default:
      return {1, 1};
  }
}

uint64_t component_bytes(int component_type) {
  return static_cast<uint64_t>(tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(component_type)));
}

uint64_t element_bytes(const tinygltf::Accessor& accessor) {
  const Shape shape = shape_of(accessor.type);
  const uint64_t column = shape.rows * component_bytes(accessor.componentType);
  return shape.columns == 1 ? column : shape.columns * ((column + 3) / 4 * 4);
}

uint64_t stride_of(const tinygltf::Accessor& accessor, const tinygltf::BufferView& view) {
  return view.byteStride != 0 ? view.byteStride : element_bytes(accessor);
}

std::string accessor_name(size_t index) { return fmt::format("accessors[{}]", index); }

/// `count` elements of `bytes`, `stride` apart, from `offset` on, must lie inside `view`. No sum can overflow: offset
/// and length are below 2^53, count * stride is compared by division.
void check_range(const Document& document, const std::string& object, const tinygltf::BufferView& view, uint64_t offset,
                 uint64_t count, uint64_t stride, uint64_t bytes) {
  const bool fits = offset + bytes <= view.byteLength && (count - 1) <= (view.byteLength - offset - bytes) / stride;
  if (fits) return;
  throw InputError(document.file, object,
                   fmt::format("{} elements of {} bytes, {} apart from byte {} on, reach beyond the view's {} bytes",
                               count, bytes, stride, offset, view.byteLength));
}

void check_alignment(const Document& document, const std::string& object, uint64_t offset, uint64_t component) {
  if (offset % component == 0) return;
  throw InputError(document.file, object,
                   fmt::format("byte offset {} is not a multiple of the component size {}", offset, component));
}

void check_sparse(const Document& document, const tinygltf::Accessor& accessor, const std::string& object) {
  const auto& sparse = accessor.sparse;
  const auto& views = document.model.bufferViews;
  const auto count = static_cast<uint64_t>(sparse.count);
  if (count > accessor.count) {
    throw InputError(document.file, object + ".sparse",
                     fmt::format("count {} exceeds the accessor's count {}", count, accessor.count));
  }
  const uint64_t index_bytes = component_bytes(sparse.indices.componentType);
  check_range(document, object + ".sparse.indices", views[static_cast<size_t>(sparse.indices.bufferView)],
              static_cast<uint64_t>(sparse.indices.byteOffset), count, index_bytes, index_bytes);
  const uint64_t value_bytes = element_bytes(accessor);
  check_range(document, object + ".sparse.values", views[static_cast<size_t>(sparse.values.bufferView)],
              static_cast<uint64_t>(sparse.values.byteOffset), count, value_bytes, value_bytes);
}

void check_accessor(const Document& document, size_t index) {
  const tinygltf::Accessor& accessor = document.model.accessors[index];
  const std::string object = accessor_name(index);
  if (accessor.sparse.isSparse) check_sparse(document, accessor, object);
  if (accessor.bufferView == document.zero_view) return;
  const tinygltf::BufferView& view = document.model.bufferViews[static_cast<size_t>(accessor.bufferView)];
  const uint64_t bytes = element_bytes(accessor), stride = stride_of(accessor, view);
  if (stride < bytes) {
    throw InputError(document.file, object,
                     fmt::format("byteStride {} is less than the element's {} bytes", stride, bytes));
  }
  check_range(document, object, view, accessor.byteOffset, accessor.count, stride, bytes);
  check_alignment(document, object, view.byteOffset + accessor.byteOffset, component_bytes(accessor.componentType));
}

template <typename T>
T load(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

uint32_t load_uint(const std::byte* bytes, int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<uint8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<uint16_t>(bytes);
    default:
      return load<uint32_t>(bytes);
  }
}

/// Integers to floats as glTF 2.0, 3.6.2.2 says: c / 255, max(c / 127, -1) and so on.
float load_float(const std::byte* bytes, int component_type, bool normalized) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const float value = load<int8_t>(bytes);
      return normalized ? std::max(value / 127.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<uint8_t>(bytes) / (normalized ? 255.0f : 1.0f);
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const float value = load<int16_t>(bytes);
      return normalized ? std::max(value / 32767.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<uint16_t>(bytes) / (normalized ? 65535.0f : 1.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<float>(load<uint32_t>(bytes));
    default:
      return load<float>(bytes);
  }
}

const std::byte* view_bytes(const Document& document, int view, uint64_t offset) {
  const tinygltf::BufferView& source = document.model.bufferViews[static_cast<size_t>(view)];
  return document.buffers[static_cast<size_t>(source.buffer)].data() + source.byteOffset + offset;
}

void substitute_sparse(const Document& document, const tinygltf::Accessor& accessor, const std::string& object,
                       std::byte* elements) {
  const auto& sparse = accessor.sparse;
  const uint64_t bytes = element_bytes(accessor), index_bytes = component_bytes(sparse.indices.componentType);
  const std::byte* indices =
      view_bytes(document, sparse.indices.bufferView, static_cast<uint64_t>(sparse.indices.byteOffset));
  const std::byte* values =
      view_bytes(document, sparse.values.bufferView, static_cast<uint64_t>(sparse.values.byteOffset));
  for (uint64_t i = 0; i < static_cast<uint64_t>(sparse.count); ++i) {
    const uint32_t index = load_uint(indices + i * index_bytes, sparse.indices.componentType);
    if (index >= accessor.count) {
      throw InputError(document.file, object + ".sparse.indices",
                       fmt::format("index {} is out of range, the accessor has {} elements", index, accessor.count));
    }
    std::memcpy(elements + index * bytes, values + i * bytes, bytes);
  }
}

}  // namespace

int component_count(int type) {
  const Shape shape = shape_of(type);
  return static_cast<int>(shape.columns * shape.rows);
}

void check_accessors(const Document& document) {
  for (size_t i = 0; i < document.model.accessors.size(); ++i) check_accessor(document, i);
}

Budget::Budget(const Document& document)
    : document_(document), limit_((uint64_t{64} << 20) + 256 * document.input_bytes) {}

void Budget::take(uint64_t count, uint64_t bytes_each, const std::string& object) {
  if (count <= (limit_ - taken_) / bytes_each) {
    taken_ += count * bytes_each;
    return;
  }
  throw InputError(document_.file, object,
                   fmt::format("{} more elements ask for more memory than a file of {} bytes may ({} bytes)", count,
                               document_.input_bytes, limit_));
}

/// Tightly packed elements with the sparse part substituted; zeros where there is no view.
std::vector<std::byte> AccessorReader::gather(int index, const std::string& user) const {
  const tinygltf::Accessor& accessor = at(index);
  const uint64_t bytes = element_bytes(accessor);
  budget_.take(accessor.count, bytes, user);
  std::vector<std::byte> elements(accessor.count * bytes);
  if (accessor.bufferView != document_.zero_view) {
    const std::byte* source = view_bytes(document_, accessor.bufferView, accessor.byteOffset);
    const uint64_t stride = stride_of(accessor, document_.model.bufferViews[static_cast<size_t>(accessor.bufferView)]);
    for (uint64_t i = 0; i < accessor.count; ++i) std::memcpy(&elements[i * bytes], source + i * stride, bytes);
  }
  if (accessor.sparse.isSparse) {
    substitute_sparse(document_, accessor, accessor_name(static_cast<size_t>(index)), elements.data());
  }
  return elements;
}

void AccessorReader::read_floats(int index, const std::string& user, float* out, size_t per_element) const {
  const tinygltf::Accessor& accessor = at(index);
  const std::vector<std::byte> elements = gather(index, user);
  const uint64_t component = component_bytes(accessor.componentType), bytes = element_bytes(accessor);
  for (uint64_t i = 0; i < accessor.count; ++i) {
    for (size_t c = 0; c < per_element; ++c) {
      const float value = load_float(&elements[i * bytes + c * component], accessor.componentType, accessor.normalized);
      if (!std::isfinite(value)) {
        throw InputError(document_.file, user,
                         fmt::format("accessors[{}]: element {} holds {}, it must be finite", index, i, value));
      }
      out[i * per_element + c] = value;
    }
  }
}

std::vector<uint32_t> AccessorReader::read_uints(int index, const std::string& user) const {
  const tinygltf::Accessor& accessor = at(index);
  const std::vector<std::byte> elements = gather(index, user);
  const uint64_t component = component_bytes(accessor.componentType);
  budget_.take(elements.size() / component, sizeof(uint32_t), user);
  std::vector<uint32_t> values(elements.size() / component);
  for (size_t i = 0; i < values.size(); ++i) {
    values[i] = load_uint(&elements[i * component], accessor.componentType);
  }
  return values;
}

}  // namespace rayloom::scenes::gltf
