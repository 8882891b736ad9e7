#pragma once

// Memory for stacks. To map and unmap one, other threads of the process must be interrupted; a dispatch that did so for
// each of its fibers spent milliseconds on it. So stacks that are given back are kept and handed out again.

#include <cstddef>

namespace rayloom::detail {

std::size_t page_bytes();

/// Readable and writable memory of `bytes`, a multiple of page_bytes(), above a guard page. Its contents mean nothing.
/// Throws std::bad_alloc. Thread-safe.
std::byte* take_stack(std::size_t bytes);
/// `stack` is from take_stack(bytes). As many as the number of cores allows are kept, the latest ones.
void give_back_stack(std::byte* stack, std::size_t bytes) noexcept;

}  // namespace rayloom::detail
