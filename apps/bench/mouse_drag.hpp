// A drag with the mouse over a picture of a model, as in the window, without one.
#pragma once

#include <vector>

#include "haptics/session/found_surface.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

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

}  // namespace palpate
