// Where the points of a layer of strokes are at each strength: a surface between those before and after its strokes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/core/attribute_change.hpp"
#include "engine/core/bare_vector.hpp"
#include "engine/core/point_set.hpp"
#include "engine/edit/point_states.hpp"

namespace palpate {

/// Of a layer whose strokes have reshaped the surface much, LayerShape::range() is smaller.
inline constexpr double kMinLayerStrength = -1, kMaxLayerStrength = 2;
/// Points that strokes of a layer cut away are removed from this strength on.
inline constexpr double kRemovesFrom = 0.5;

/// The strength of each point of a layer.
struct LayerStrengths {
  double most = 1;
  std::span<const HeldPoint> held = {};

  double of(std::uint64_t point) const {
    if (held.empty()) return most;
    const auto at = std::ranges::lower_bound(held, point, {}, &HeldPoint::number);
    return at != held.end() && at->number == point ? at->strength : most;
  }
};

/// The points of a layer of strokes at each strength.
class LayerShape {
 public:
  LayerShape() = default;
  /// `places`: layerPlaces().
  explicit LayerShape(BareVector<LayerPlace> places) : places_(std::move(places)) {}

  bool empty() const { return places_.empty(); }
  std::span<const LayerPlace> places() const { return places_; }
  /// Indices of the points that do not exist at all strengths. After findSurroundings().
  std::span<const std::uint32_t> absentAtSome() const { return absentAtSome_; }
  /// Indices of the points that may change with the strength, and their set. After findMoving().
  std::span<const std::uint32_t> moving() const { return moving_; }
  const PointSet& movingPoints() const { return movingPoints_; }
  /// Index of a point in places(), or places().size().
  std::size_t indexOf(std::uint64_t point) const;
  /// Includes points that other strokes have inserted since: they go along with those around them.
  void addNew(const PointStates& present, const LayerStrengths& strengths);
  /// Where points that do not exist at these strengths would be, if others have moved the surface there since: they go
  /// along with it. By index; empty: nothing has moved. After findSurroundings().
  std::unordered_map<std::size_t, PointState> absentWithOthers(const PointStates& present,
                                                               const LayerStrengths& strengths) const;
  std::uint64_t bytes() const;
  /// The strengths, with 0 and 1 among them, at which the surface does not turn over on itself. After
  /// findSurroundings().
  struct Range {
    double low = kMinLayerStrength, high = kMaxLayerStrength;
  };
  const Range& range() const { return range_; }

  /// It is where it is at any strength.
  bool isStill(std::size_t index) const;
  Vec3 positionAt(std::size_t index, double strength) const;
  /// Whether the layer removes the point.
  bool isRemoved(std::size_t index, const LayerStrengths& strengths) const;
  /// Of the surface, facing as the points do.
  Vec3 normalAt(std::size_t index, double strength) const;
  /// Before isRemoved() and normalAt(), and for one thread.
  void findSurroundings();
  /// `isStroked(number)`: whether a stroke of the layer has changed that point, perhaps in its colour alone.
  void findMoving(const std::function<bool(std::uint64_t)>& isStroked);

 private:
  static constexpr std::size_t kNeighbours = 10;
  struct Surroundings {
    // Of the area there: it is the known normal + s terms[0] + s^2 terms[1], for strengths s from that of the normal.
    std::array<Vec3, 2> terms{};
    float spacing = 0;         // of the points around
    std::uint32_t merged = 0;  // index of a merged point
  };
  struct Near {
    std::array<std::uint32_t, kNeighbours> indices{};
    std::size_t count = 0;
  };
  DVec3 areaAt(std::size_t index, double strength) const;
  bool isFolded(double strength) const;
  void findRange();
  Vec3 presentNormal(std::size_t index, const LayerStrengths& strengths) const;
  std::array<Vec3, 2> areaTermsOf(std::size_t index, std::span<const std::uint32_t> near) const;

  BareVector<LayerPlace> places_;          // ascending by number
  BareVector<Surroundings> surroundings_;  // as places_
  BareVector<std::uint32_t> absentAtSome_, moving_;
  PointSet movingPoints_;
  Range range_;
  std::vector<Near> nearMerged_;  // the points beside merged ones, before
};

}  // namespace palpate
