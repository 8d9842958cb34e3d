#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/cloud/field.hpp"
#include "engine/core/attribute_change.hpp"
#include "engine/gpu/buffer.hpp"

namespace palpate {

class Device;

/// Masks and one field of the drawn points, on the GPU. They take memory from the first point of a mask, or the first
/// field, on. For the thread that uses the throughput queue; changes wait for its work. They may throw OutOfGpuMemory.
class DrawnAttributes {
 public:
  /// `count`: points beyond it are ignored.
  DrawnAttributes(Device& device, std::uint32_t count) : device_(device), count_(count) {}

  /// Applies changes of masks that are seen, and of the field that is shown.
  void follow(std::span<const AttributeChange> changes);
  /// Shows a field by its number in the layer from now on, until it is removed; null: none.
  void show(std::uint32_t number, const Field* field);

  /// A bit for each point; null while the mask has no points, or is not seen.
  const Buffer* mask(MaskRole role) const;
  /// A float for each point; null while no field is shown.
  const Buffer* values() const { return field_ ? &*values_ : nullptr; }
  std::uint64_t bytes() const;

 private:
  struct Mask {
    std::vector<std::uint64_t> words;  // as in `bits`, which the host cannot read fast
    std::uint64_t count = 0;           // points
    std::optional<Buffer> bits;
  };
  void flip(const MaskFlip& flip);
  void set(const FieldChange& change);

  Device& device_;
  std::uint32_t count_;
  std::array<Mask, 2> masks_;  // selected, hidden
  std::optional<std::uint32_t> field_;
  ScalarType type_ = ScalarType::f32;  // of it
  std::optional<Buffer> values_;
};

}  // namespace palpate
