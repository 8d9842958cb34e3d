// Whole-buffer transfers between host and GPU, for loading, saving and tests; never inside a tick.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/gpu/buffer.hpp"

namespace palpate {

class Device;
class Queue;

/// Copies through a staging buffer of bounded size on `queue`, or in place (unifiedMemory()) after its earlier work,
/// and waits. For the thread that uses that queue.
void uploadBytes(Device& device, Queue& queue, const Buffer& to, std::span<const std::byte> bytes);
void downloadBytes(Device& device, Queue& queue, const Buffer& from, std::span<std::byte> bytes,
                   std::uint64_t offset = 0);
/// The same for generated data: make(offset, piece) writes it piece by piece, each while the previous one is copied; an
/// exception from it ends the transfer.
void uploadMade(Device& device, Queue& queue, const Buffer& to, std::uint64_t bytes,
                const std::function<void(std::uint64_t offset, std::span<std::byte> piece)>& make);
/// The default queue of the functions without a queue parameter.
Queue& latencyQueueOf(Device& device);

template <class T>
void upload(Device& device, Queue& queue, const Buffer& to, const std::vector<T>& values) {
  uploadBytes(device, queue, to, std::as_bytes(std::span(values)));
}
template <class T>
void upload(Device& device, const Buffer& to, const std::vector<T>& values) {
  upload(device, latencyQueueOf(device), to, values);
}
/// `count` values from the start of the buffer, after all earlier work of the queue.
template <class T>
std::vector<T> download(Device& device, Queue& queue, const Buffer& from, std::size_t count) {
  std::vector<T> values(count);
  downloadBytes(device, queue, from, std::as_writable_bytes(std::span(values)));
  return values;
}
template <class T>
std::vector<T> download(Device& device, const Buffer& from, std::size_t count) {
  return download<T>(device, latencyQueueOf(device), from, count);
}

}  // namespace palpate
