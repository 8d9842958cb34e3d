// Strokes of a pointer on their way to the servo thread: a pose for each tick.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "engine/core/vec.hpp"

namespace palpate {

/// Position of the stylus at one tick of a stroke, relative to the surface as the stroke found it; model units.
struct DrawnPose {
  DVec3 place{0};        ///< on that surface
  DVec3 outward{0};      ///< unit; the stylus presses against it
  DVec3 toEye{0};        ///< unit; the stylus is put down and lifted along it
  double inward = 0;     ///< depth of the stylus; negative: in front of the surface
  bool putDown = false;  ///< the stylus is lifted, and put down here: it did not move here
  /// From this length of the spring on, model units, it holds what it touched first, and need not touch anything later.
  std::optional<double> holdsFrom;
  bool ends = false;  ///< the stroke ends: the stylus is lifted
};

/// A queue: one thread adds, another one takes. Neither waits, and only the constructor allocates.
class DrawnStrokes {
 public:
  // For the thread that adds.
  bool hasRoom() const noexcept { return pending() < kMost; }
  void add(const DrawnPose& pose) noexcept {
    const std::uint64_t added = added_.load(std::memory_order_relaxed);
    poses_[added % kMost] = pose;
    added_.store(added + 1, std::memory_order_release);
  }

  // For the thread that takes.
  /// The next pose; null if there is none.
  const DrawnPose* next() const noexcept {
    const std::uint64_t taken = taken_.load(std::memory_order_relaxed);
    return taken < added_.load(std::memory_order_acquire) ? &poses_[taken % kMost] : nullptr;
  }
  void drop() noexcept { taken_.store(taken_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

  /// Number of poses that were added and not taken yet.
  std::size_t pending() const noexcept {
    const std::uint64_t taken = taken_.load(std::memory_order_acquire);
    return static_cast<std::size_t>(added_.load(std::memory_order_acquire) - taken);
  }
  /// Forgets all poses, while no thread takes any.
  void clear() noexcept { taken_.store(added_.load()); }

 private:
  static constexpr std::size_t kMost = 4096;  // four seconds at 1 kHz
  std::array<DrawnPose, kMost> poses_;
  std::atomic<std::uint64_t> added_ = 0, taken_ = 0;
};

}  // namespace palpate
