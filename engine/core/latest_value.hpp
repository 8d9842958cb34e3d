// One thread stores a value, another reads the latest one; neither waits for the other.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

namespace palpate {

/// A sequence lock (Boehm 2012, "Can seqlocks get along with programming language memory models?"). Allocates nothing.
template <class T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// From one thread only.
  void store(const T& value) noexcept {
    std::array<std::uint64_t, kWords> words{};
    std::memcpy(words.data(), &value, sizeof(T));
    // The version is odd while the value is being written. A reader that sees a part of a new value sees an odd or a
    // later version, since each part is released after the version was changed.
    const std::uint32_t version = version_.load(std::memory_order_relaxed);
    version_.store(version + 1, std::memory_order_relaxed);
    for (std::size_t k = 0; k < kWords; ++k) words_[k].store(words[k], std::memory_order_release);
    version_.store(version + 2, std::memory_order_release);
  }

  /// Empty before the first store and while the value is being written: the caller keeps its previous value.
  std::optional<T> load() const noexcept {
    const std::uint32_t before = version_.load(std::memory_order_acquire);
    std::array<std::uint64_t, kWords> words;
    for (std::size_t k = 0; k < kWords; ++k) words[k] = words_[k].load(std::memory_order_acquire);
    if (before % 2 != 0 || before == 0 || version_.load(std::memory_order_relaxed) != before) return std::nullopt;
    T value;
    std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
    return value;
  }

 private:
  static constexpr std::size_t kWords = (sizeof(T) + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t);
  std::atomic<std::uint32_t> version_ = 0;
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace palpate
