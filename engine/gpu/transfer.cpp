#include "engine/gpu/transfer.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <string>

#include "engine/core/parallel.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/unified_memory.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kStagingBytes = 32ull << 20;

/// Two staging buffers, used alternately: the host works on one while the GPU copies to or from the other.
class StagingPair {
 public:
  struct Stage {
    explicit Stage(const StagingPair& pair)
        : buffer(pair.device_, pair.bytes_, pair.memory_, "staging"), list(pair.device_, pair.queue_, pair.name_) {}
    Buffer buffer;
    CommandList list;
    std::optional<Queue::Ticket> copying;
  };

  StagingPair(Device& device, Queue& queue, Memory memory, std::uint64_t bytes, const std::string& name)
      : device_(device), queue_(queue), memory_(memory), bytes_(std::min(bytes, kStagingBytes)), name_(name) {}
  ~StagingPair() {  // after an exception, before their memory is freed
    try {
      finish();
    } catch (const DeviceLost&) {  // then the GPU no longer uses it
    }
  }
  StagingPair(const StagingPair&) = delete;
  StagingPair& operator=(const StagingPair&) = delete;

  /// The one that has been used least recently, after its copy.
  Stage& next() {
    std::unique_ptr<Stage>& stage = stages_[number_++ % stages_.size()];
    if (!stage) stage = std::make_unique<Stage>(*this);
    if (stage->copying) queue_.wait(*stage->copying);
    return *stage;
  }
  void finish() const {
    for (const auto& stage : stages_)
      if (stage && stage->copying) queue_.wait(*stage->copying);
  }
  void copy(Stage& stage, const Buffer& from, const Buffer& to, std::uint64_t bytes, std::uint64_t fromOffset,
            std::uint64_t toOffset) {
    stage.list.begin();
    stage.list.copy(from, to, bytes, fromOffset, toOffset);
    stage.list.end();
    stage.copying = queue_.submit(stage.list);
  }

 private:
  Device& device_;
  Queue& queue_;
  Memory memory_;
  std::uint64_t bytes_;
  std::string name_;
  std::array<std::unique_ptr<Stage>, 2> stages_;
  std::size_t number_ = 0;
};

// Calls step(offset, bytes) for consecutive pieces.
template <class Step>
void inPieces(std::uint64_t total, Step&& step) {
  for (std::uint64_t offset = 0; offset < total; offset += kStagingBytes)
    step(offset, std::min(kStagingBytes, total - offset));
}

// With many threads, which also share the first access to the pages of `to`.
void copyBytes(std::byte* to, const std::byte* from, std::uint64_t bytes) {
  constexpr std::size_t kUnit = 1024;
  parallelFor((bytes + kUnit - 1) / kUnit, 0, [&](std::size_t begin, std::size_t end) {
    std::memcpy(to + begin * kUnit, from + begin * kUnit, std::min<std::uint64_t>(end * kUnit, bytes) - begin * kUnit);
  });
}

}  // namespace

void uploadMade(Device& device, Queue& queue, const Buffer& to, std::uint64_t bytes,
                const std::function<void(std::uint64_t, std::span<std::byte>)>& make) {
  if (unifiedMemory(device).writes) {
    queue.finish();  // which may still use the buffer
    const std::span<std::byte> there = to.mapped<std::byte>();
    inPieces(bytes, [&](std::uint64_t offset, std::uint64_t piece) { make(offset, there.subspan(offset, piece)); });
    return;
  }
  StagingPair staging(device, queue, Memory::staging, bytes, "upload " + to.name());
  inPieces(bytes, [&](std::uint64_t offset, std::uint64_t piece) {
    StagingPair::Stage& stage = staging.next();
    make(offset, stage.buffer.mapped<std::byte>().first(piece));
    staging.copy(stage, stage.buffer, to, piece, 0, offset);
  });
  staging.finish();
}

void uploadBytes(Device& device, Queue& queue, const Buffer& to, std::span<const std::byte> bytes) {
  uploadMade(device, queue, to, bytes.size(), [&](std::uint64_t offset, std::span<std::byte> piece) {
    copyBytes(piece.data(), bytes.data() + offset, piece.size());
  });
}

void downloadBytes(Device& device, Queue& queue, const Buffer& from, std::span<std::byte> bytes, std::uint64_t offset) {
  if (bytes.empty()) return;
  if (unifiedMemory(device).reads) {
    queue.finish();  // each list ends with a barrier for the host's reads
    std::memcpy(bytes.data(), from.mapped<std::byte>().data() + offset, bytes.size());
    return;
  }
  StagingPair staging(device, queue, Memory::readback, bytes.size(), "download " + from.name());
  const auto receive = [&](StagingPair::Stage& stage, std::uint64_t at, std::uint64_t piece) {
    queue.wait(*stage.copying);
    copyBytes(bytes.data() + at, stage.buffer.mapped<std::byte>().data(), piece);
  };
  StagingPair::Stage* last = nullptr;
  std::uint64_t lastAt = 0;
  inPieces(bytes.size(), [&](std::uint64_t done, std::uint64_t piece) {
    StagingPair::Stage& stage = staging.next();
    staging.copy(stage, from, stage.buffer, piece, offset + done, 0);
    if (last) receive(*last, lastAt, kStagingBytes);
    last = &stage, lastAt = done;
  });
  receive(*last, lastAt, bytes.size() - lastAt);
}

Queue& latencyQueueOf(Device& device) { return device.latencyQueue(); }

}  // namespace palpate
