// Random strokes on a model, as a seed and their numbers say: what a hand does, and where.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/bench/bench.hpp"
#include "apps/bench/mouse_drag.hpp"
#include "engine/study/stroke_judge.hpp"
#include "haptics/session/sculpting_hand.hpp"
#include "haptics/surface_walk.hpp"

namespace palpate {

/// Rate of the hand's poses.
inline constexpr double kHandRate_Hz = 1000;
/// Of a thickness: no other side within a brush's diameter.
inline constexpr double kNoSide = std::numeric_limits<double>::infinity();

struct StrokeResult {
  std::size_t number = 0;
  std::string subject, brush, place;
  BrushConfig config;
  double depth_mm = 0, speed_mm_per_s = 0, drag_mm = 0, thickness_mm = 0, wall_s = 0;
  std::size_t ticks = 0;
  DVec3 start{0}, normal{0};  // of the surface there
  StrokeVerdict verdict;
};

/// A model of at most 100,000 points, and the kinds of place on it.
class StrokeModel {
 public:
  StrokeModel(Context& context, const std::string& file, EstimateOn where);

  const std::string& name() const { return name_; }
  const Model& model() const { return model_; }
  const ThinnedCloud& surface() const { return surface_; }
  StrokeJudge& judge() { return judge_; }

  struct Place {
    std::string_view kind;  ///< flat, edge, thin, fold or border
    SurfaceSpot spot;
    double thickness_mm = kNoSide;
  };
  /// A place around a point, for a ball of this radius, mm.
  Place placeAt(std::uint32_t point, double radius_mm);
  std::uint32_t nearestTo(const DVec3& place) const;

 private:
  std::string name_;
  Model model_;
  ThinnedCloud surface_;
  StrokeJudge judge_;
  std::vector<std::uint32_t> found_;
};

/// A stroke by its path: `hips` has the HIP of each tick, from the cloud's origin. By mouse: `drag`.
struct PlannedStroke {
  StrokeResult result;
  PlayedStroke played;
  std::vector<DVec3> hips;
  std::optional<MouseDrag> drag;
};

/// By path, or by a drag of the mouse. Half of the strokes start on thin parts, folds or borders, half have the default
/// brush; by path they are 2 mm deep at 50 mm/s.
PlannedStroke planStroke(StrokeModel& subject, std::span<const std::string> brushes, std::uint64_t seed,
                         std::size_t number, bool byMouse);

}  // namespace palpate
