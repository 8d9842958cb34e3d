#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <utility>

#include "engine/core/edit_batch.hpp"
#include "engine/core/edit_stream.hpp"

namespace palpate {

/// Passes edits made on the CPU to one reader; neither side waits for the other. One thread appends at a time. Edits
/// are kept only after keep() was called. `capacity`: states from which on no further edits should begin (room()), but
/// appending does not fail for it.
class EditQueue {
 public:
  explicit EditQueue(std::uint64_t capacity) : capacity_(capacity) {}
  ~EditQueue() {
    while (first_) first_ = std::move(first_->next);  // not one inside the other
  }
  EditQueue(const EditQueue&) = delete;
  EditQueue& operator=(const EditQueue&) = delete;

  void keep() {
    if (first_) return;
    first_ = std::make_unique<Chunk>();
    last_ = first_.get();
  }

  /// Appends state(0) to state(count - 1) and, if given, the mark that ends them; a reader never sees the states
  /// without the mark.
  template <class State>
  void append(std::size_t count, State&& state, std::optional<EditMark::Kind> end = std::nullopt) {
    if (!last_) return;
    for (std::size_t i = 0; i < count; ++i) put({.state = state(i), .mark = {}});
    if (end) put({.state = {}, .mark = end});
    // The thread that answers poses appends a few marks between two edits: it allocates nothing then.
    if (written_ + kMarksBetweenEdits > end_ && !last_->next) last_->next = std::make_unique<Chunk>();
    published_.store(written_, std::memory_order_release);
  }
  /// Appends a mark after all states so far.
  void mark(EditMark::Kind kind) {
    append(
        0, [](std::size_t) { return PointState(); }, kind);
  }

  /// Appends to `batch` everything since the last call. For one thread.
  void take(EditBatch& batch) {
    const std::uint64_t end = published_.load(std::memory_order_acquire);
    std::uint64_t at = taken_.load(std::memory_order_relaxed);
    for (; at < end; ++at) {
      if (at == begin_ + kChunk) {
        first_ = std::move(first_->next);
        begin_ = at;
      }
      const Item& item = first_->items[at - begin_];
      if (item.mark)
        batch.marks.push_back({batch.points.size(), *item.mark});
      else
        batch.points.push_back(item.state);
    }
    taken_.store(at, std::memory_order_release);
  }

  /// For any thread.
  EditRoom room() const {
    const std::uint64_t taken = taken_.load(std::memory_order_acquire), pending = published_.load() - taken;
    return {.free = pending < capacity_ ? capacity_ - pending : 0, .capacity = capacity_};
  }

 private:
  struct Item {
    PointState state;
    std::optional<EditMark::Kind> mark;  // in place of a state
  };
  static constexpr std::size_t kChunk = 1024, kMarksBetweenEdits = 16;
  struct Chunk {
    std::array<Item, kChunk> items;
    std::unique_ptr<Chunk> next;
  };

  void put(const Item& item) {
    if (written_ == end_) {
      if (!last_->next) last_->next = std::make_unique<Chunk>();
      last_ = last_->next.get();
      end_ += kChunk;
    }
    last_->items[written_ - (end_ - kChunk)] = item;
    ++written_;
  }

  const std::uint64_t capacity_;
  // Of the thread that appends. `end_`: number of the first item behind the last chunk in use.
  Chunk* last_ = nullptr;
  std::uint64_t written_ = 0, end_ = kChunk;
  std::atomic<std::uint64_t> published_ = 0, taken_ = 0;
  // Of the reader: the chunk of its next item, and the number of that chunk's first one.
  std::unique_ptr<Chunk> first_;
  std::uint64_t begin_ = 0;
};

}  // namespace palpate
