#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/attribute_change.hpp"
#include "engine/gpu/buffer.hpp"

namespace palpate {

class Device;

/// Masks and one number of each drawn point, on the GPU. They take memory from the first point of a mask, or the first
/// numbers, on. For the thread that uses the throughput queue; changes wait for its work. They may throw
/// OutOfGpuMemory.
class DrawnAttributes {
 public:
  /// `count`: points beyond it are ignored.
  DrawnAttributes(Device& device, std::uint32_t count) : device_(device), count_(count) {}

  /// Applies changes of masks that are seen.
  void follow(std::span<const AttributeChange> changes);
  /// Shows these numbers of the points from now on; further points, and NaN: none.
  void show(std::span<const float> numbers);
  /// Other numbers of points, after show().
  void set(std::span<const std::pair<std::uint64_t, float>> numbers);
  void showNone();
  /// Shades the points by these weights of locks from now on (PointLock::kWhole); further points: none. Empty: none.
  void showLock(std::span<const std::uint8_t> weights);

  /// A bit for each point; null while the mask has no points, or is not seen.
  const Buffer* mask(MaskRole role) const;
  /// A float for each point; null while no numbers are shown.
  const Buffer* values() const { return values_ ? &*values_ : nullptr; }
  /// A byte for each point; null while no lock is shown.
  const Buffer* lock() const { return lock_ ? &*lock_ : nullptr; }
  /// Counts the changes of masks.
  std::uint64_t changes() const { return changes_; }
  std::uint64_t bytes() const;

 private:
  struct Mask {
    std::vector<std::uint64_t> words;  // as in `bits`, which the host cannot read fast
    std::uint64_t count = 0;           // points
    std::optional<Buffer> bits;
  };
  void flip(const MaskFlip& flip);

  Device& device_;
  std::uint32_t count_;
  std::uint64_t changes_ = 0;
  std::array<Mask, 2> masks_;  // selected, hidden
  std::optional<Buffer> values_, lock_;
};

}  // namespace palpate
