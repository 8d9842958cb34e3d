// Whole-buffer transfers between host and GPU, for loading, saving and tests; never inside a tick.
#pragma once

#include <span>
#include <vector>

#include "engine/gpu/buffer.hpp"

namespace palpate {

class Device;

/// Copies through a staging buffer of bounded size, on the touch queue, and waits.
void uploadBytes(Device& device, const Buffer& to, std::span<const std::byte> bytes);
void downloadBytes(Device& device, const Buffer& from, std::span<std::byte> bytes, std::uint64_t offset = 0);

template <class T>
void upload(Device& device, const Buffer& to, const std::vector<T>& values) {
  uploadBytes(device, to, std::as_bytes(std::span(values)));
}
/// `count` values from the start of the buffer, after all earlier work of the touch queue.
template <class T>
std::vector<T> download(Device& device, const Buffer& from, std::size_t count) {
  std::vector<T> values(count);
  downloadBytes(device, from, std::as_writable_bytes(std::span(values)));
  return values;
}

}  // namespace palpate
