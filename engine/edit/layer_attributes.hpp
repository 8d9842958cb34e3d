#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/cloud/field.hpp"
#include "engine/core/edit_batch.hpp"
#include "engine/core/point_lock.hpp"
#include "engine/edit/point_states.hpp"
#include "engine/edit/stroke_layers.hpp"

namespace palpate {

/// The masks and the fields of a layer's points, by number, and its layers of strokes. What a removed point has stays
/// until it is restored, and counts no more than the point: existing() leaves it out. For one thread.
class LayerAttributes {
 public:
  const PointSet& mask(MaskRole role) const { return masks_[static_cast<std::size_t>(role)]; }
  /// How brushes change the points of the layer, which was loaded from `file`. `states`: by number.
  PointLock lock(const PointCloud& file, std::span<const PointState> states) const;
  /// By number, without the mask `within`.
  std::vector<std::uint8_t> lockWeights(const PointCloud& file, std::span<const PointState> states) const;
  /// Whether kLockField has the weights.
  bool hasLockField(const PointCloud& file) const { return lockValues(file) != nullptr; }
  /// Whether a change, before or after it, concerns lock().
  bool isOfLock(const AttributeChange& change) const;
  bool hasMasks() const { return !std::ranges::all_of(masks_, &PointSet::empty); }
  const std::vector<Field>& fields() const { return fields_; }
  std::optional<std::uint32_t> fieldNamed(std::string_view name) const;
  const StrokeLayers& strokeLayers() const { return strokeLayers_; }
  StrokeLayers& strokeLayers() { return strokeLayers_; }

  /// The masks as changes of a layer without any, for a picture that begins now.
  std::vector<AttributeChange> masks() const;
  /// All fields, masks and layers of strokes likewise.
  std::vector<AttributeChange> all() const;
  /// Whether the change can be carried out: it names a field that is there, or the next one, with as many values as
  /// points; or a layer of strokes likewise.
  bool fits(const AttributeChange& change) const;
  /// Carries the change out, which must fit, and makes it the one that undoes it: exchanges what it has with what is
  /// present. Nothing has changed if memory is out.
  void exchange(AttributeChange& change);
  /// Gives the points that are new in a batch the masks and values of their parents, and appends that to the batch.
  /// `before`: without the batch. A point that is restored has its own.
  void follow(EditBatch& batch, const PointStates& before);

 private:
  bool empty() const { return fields_.empty() && !hasMasks(); }
  const Attribute* lockValues(const PointCloud& file) const;
  void exchange(FieldChange& change);
  void exchange(FieldPresence& change);

  std::array<PointSet, kMaskRoles> masks_;
  std::vector<Field> fields_;
  StrokeLayers strokeLayers_;
};

/// Those of the points that exist. `states`: by number.
PointSet existing(const PointSet& points, std::span<const PointState> states);
/// A change in the numbers that the points get in editedCloud(file, states), where only the existing ones are.
AttributeChange renumbered(const AttributeChange& change, std::span<const PointState> states);

/// Makes the field of that name, with what its points had when they were loaded: a property of the file, or zeros. New
/// points have the values of their parents. `number`: of fields before it.
FieldPresence initialField(const PointCloud& file, const PointStates& points, std::string_view name, ScalarType type,
                           std::size_t number);

/// editedCloud() with the fields as properties.
PointCloud editedCloud(const PointCloud& file, std::span<const PointState> points, const std::vector<Field>& fields);

/// Checksums of the masks and then of the fields, of what the existing points have.
std::vector<std::uint64_t> checksumsOf(const LayerAttributes& attributes, std::span<const PointState> points);
/// Checksum of the points, their masks and their fields; that of the points alone if they have none.
std::uint64_t checksumOf(const DVec3& origin, std::span<const PointState> points, const LayerAttributes& attributes);

}  // namespace palpate
