// Layers of strokes, whose strength slides after the fact.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/core/attribute_change.hpp"
#include "engine/core/bare_vector.hpp"
#include "engine/core/point_lock.hpp"
#include "engine/edit/layer_places.hpp"
#include "engine/edit/layer_shape.hpp"
#include "engine/edit/point_states.hpp"

namespace palpate {

/// The states of points by which a layer gets another strength.
struct SlidPoints {
  BareVector<PointState> states;  ///< ascending by number
  PointSet points;
  bool hasAbsent = true;  ///< false: each of them exists before or after
};

/// The layers of strokes of a cloud: the points before and after the strokes of each, which are recorded, undone and
/// redone together with the entries of the history. The first change of a layer's strength since its last stroke finds
/// its LayerShape, on which the points are at each strength from then on; what other strokes do to a point since then
/// is added. For one thread.
class StrokeLayers {
 public:
  /// Number of layers, including merged ones.
  std::size_t size() const { return layers_.size(); }
  const StrokeLayer& operator[](std::size_t number) const { return layers_[number].set; }
  /// The layer that strokes become part of.
  std::optional<std::uint32_t> open() const { return open_; }
  /// Number of the layer of that name; merged ones are left out.
  std::optional<std::uint32_t> named(std::string_view name) const;
  /// Number of points that its strokes have changed.
  std::size_t pointsOf(std::size_t number) const;
  /// Memory.
  std::uint64_t bytes() const;

  /// As LayerAttributes: whether a change can be carried out, carries it out and makes it the one that undoes it, and
  /// all layers as changes.
  bool fits(const StrokeLayerChange& change) const;
  void exchange(StrokeLayerChange& change);
  std::vector<AttributeChange> all() const;

  /// A stroke becomes part of a layer: `before` are its points before it, each once, `present` all points after it.
  void record(std::uint32_t number, std::span<const PointState> before, const PointStates& present);

  /// The states of the points, ascending by number, by which a layer gets another strength. Notes in `to` the points
  /// that `lock` holds; null: those that are noted. Throws Error if the layer cannot have that strength, unless it is
  /// recorded, without a lock.
  SlidPoints slide(StrokeLayerChange& to, const PointStates& present, const PointLock* lock);
  /// Finds the layer's shape, and notes which points something else has removed, as long as this layer does not do so
  /// itself. Before each change of its strength.
  void observe(std::uint32_t number, const PointStates& present);

 private:
  struct Layer {
    StrokeLayer set;
    std::vector<StrokeLayerPoint> points;
    std::vector<std::vector<std::uint32_t>> pages;  // by number of the point: index of its last strokes
    LayerShape shape;                               // empty: a stroke has changed it since, or its strength is 1

    std::uint32_t last(std::uint64_t point) const;
    void setLast(std::uint64_t point, std::uint32_t index);
    bool isLast(std::uint32_t index) const { return last(points[index].after.number) == index; }
    const StrokeLayerPoint& first(std::uint32_t index) const;
    /// Where `point` was before the layer.
    PointState before(std::uint64_t point, const PointStates& present) const;
    void extend(const PointState& from, const PointState& to, const PointStates& present);
    LayerRecord recordOf(std::uint32_t index, const PointStates& present) const;
    /// All its points are as at strength 1.
    bool isWhole() const { return set.shown() == 1 && set.held.empty(); }
    LayerStrengths strengths() const { return {set.shown(), set.held}; }
    /// Whether it removes the point at present.
    bool removes(std::uint64_t point) const;
  };
  void findShape(Layer& layer, const PointStates& present);
  bool isRemovedByOthers(std::uint64_t point, const Layer& than) const;
  static void hold(const LayerShape& shape, const LayerStrengths& was, const PointLock& lock,
                   const PointStates& present, StrokeLayer& set);
  static PointState slid(const Layer& layer, std::size_t index, const LayerStrengths& to, const PointState& present);

  std::vector<Layer> layers_;
  std::optional<std::uint32_t> open_;
  PointSet removed_;  // by something else, where a layer removes them as well
};

/// A layer that is made in the numbers of renumbered(): `numbers` of the existing ones of `states`.
StrokeLayerChange renumbered(StrokeLayerChange change, std::span<const PointState> states,
                             std::span<const std::uint64_t> numbers);

}  // namespace palpate
