// Random strokes on a model, as a seed and their numbers say: what a hand does, and where.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/bench/bench.hpp"
#include "engine/study/stroke_judge.hpp"
#include "haptics/session/found_surface.hpp"
#include "haptics/session/sculpting_hand.hpp"
#include "haptics/session/session.hpp"
#include "haptics/surface_walk.hpp"

namespace palpate {

/// A drag with the mouse over a picture of a model, as in the window, without one.
/// The depths of the points in a picture, each drawn as a disc in its tangent plane that meets its neighbours.
/// `spacing`: model units. In double precision on the CPU.
FoundSurface depthPicture(const PointCloud& cloud, double spacing, const Camera& camera, const DVec2& size_px);

/// The button is pressed at the first event and released after the last one.
struct MouseDrag {
  struct Event {
    double time_s = 0;
    DVec2 place_px{0};
  };
  Camera camera;
  DVec2 size_px{1280, 720};
  std::vector<Event> events;
  FoundSurface found;
};

/// Depth at which the mouse presses unless it is set otherwise, mm.
inline constexpr double kMousePress_mm = 2.5;

/// From the centre of a picture that looks at `place` along `sight` (unit), in which `units` are as high as the
/// picture: `to_px` from there, in two straight parts around `bend_px`.
MouseDrag dragOver(const Model& model, const DVec3& place, const DVec3& sight, double units, const DVec2& bend_px,
                   const DVec2& to_px);

/// Drags in a session whose ticks are counted, as in the window. `hips`: receives the HIP at each tick of
/// the stroke, from the cloud's origin. Returns the points after it, those of the model first. Throws query failures.
std::vector<PointState> playDrag(const SessionConfig& config, const Model& model, const SessionParts& parts,
                                 const MouseDrag& drag, std::vector<DVec3>& hips);

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
