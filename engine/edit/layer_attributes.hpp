#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "engine/cloud/field.hpp"
#include "engine/core/edit_batch.hpp"
#include "engine/edit/point_states.hpp"

namespace palpate {

/// The masks and the fields of a layer's points, by number. What a removed point has stays until it is restored, and
/// counts no more than the point: existing() leaves it out. For one thread.
class LayerAttributes {
 public:
  const PointSet& mask(MaskRole role) const { return masks_[static_cast<std::size_t>(role)]; }
  const std::vector<Field>& fields() const { return fields_; }
  std::optional<std::uint32_t> fieldNamed(std::string_view name) const;
  /// Adds a field with a value for each point that has a number. Returns its number.
  std::uint32_t add(Field field);

  /// The masks as changes of a layer without any, for a follower that begins now.
  std::vector<AttributeChange> masks() const;
  /// Carries the change out, and makes it the one that undoes it: exchanges what it has with what is present. Nothing
  /// has changed if memory is out.
  void exchange(AttributeChange& change);
  /// Gives the points that are new in a batch the masks and values of their parents, and appends that to the batch.
  /// `before`: without the batch. A point that is restored has its own.
  void follow(EditBatch& batch, const PointStates& before);

 private:
  bool empty() const;

  std::array<PointSet, kMaskRoles> masks_;
  std::vector<Field> fields_;
};

/// Those of the points that exist.
PointSet existing(const PointSet& points, const PointStates& states);

/// The field of that name as its points have it when they are loaded: a property of the file, or zeros. New points have
/// the values of their parents.
Field initialField(const PointCloud& file, const PointStates& points, std::string_view name, ScalarType type);

/// Writes the fields to the properties of editedCloud(file, points).
void addFields(const std::vector<Field>& fields, const PointStates& points, PointCloud& edited);

}  // namespace palpate
