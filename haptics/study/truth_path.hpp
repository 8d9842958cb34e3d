// Paths of known true depth, since they are defined on the true surface and not on the points.
#pragma once

#include <functional>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/triangle_mesh.hpp"
#include "engine/core/units.hpp"
#include "haptics/path.hpp"

namespace palpate {

/// The true surface and an ideal probe on it: the reference for touch.
/// A surface with exactly known geometry. Model units, file coordinates.
struct TouchTruth {
  std::function<SurfacePoint(const DVec3&)> closest;
  std::function<double(const DVec3&)> signedDistance;  ///< positive outside
};

/// The shape or mesh must outlive the truth.
TouchTruth truthOf(const AnalyticShape& shape);
TouchTruth truthOf(const TriangleMesh& mesh);

/// The god-object (Zilles and Salisbury 1995) on the true surface: a point that stays on it and gets as near to the HIP
/// as it can without leaving it. The motion of the HIP is divided into pieces so short that neither a thin wall nor an
/// edge is missed; each piece iterates until the point has arrived, however long that takes.
class GodObject {
 public:
  /// `longestStep`: maximum motion of the HIP and of the god-object in a step, model units.
  GodObject(const TouchTruth& truth, double longestStep) : truth_(truth), longestStep_(longestStep) {}

  /// Follows the HIP to its current position. The first call sets the start, which must be outside.
  void follow(const DVec3& hip);

  bool touching() const { return touching_; }
  /// Its position on the surface; while nothing is touched, the point closest to the HIP.
  const SurfacePoint& contact() const { return contact_; }

 private:
  void step(const DVec3& hip);
  void slide(const DVec3& hip);

  const TouchTruth& truth_;
  double longestStep_;
  bool started_ = false;
  bool touching_ = false;
  bool outside_ = false;
  DVec3 lastHip_{0};
  SurfacePoint contact_;
};

/// A path, and the time window of what it is made for.
struct TruthPath {
  Path path;
  double from_s = 0, to_s = 0;
};

struct TruthPathOptions {
  double depth_mm = 1;  ///< of the HIP below the true surface
  double lift_mm = 5;   ///< above it, where the path begins and ends, without contact
  double speed_mm_per_s = 50;
  double length_mm = 30;  ///< of a slide, along the true surface
};

/// Down at 25 mm/s, a short rest, along a geodesic in the direction of `towards` (any vector that is not normal to the
/// surface) at the depth and speed of the options, and up. The window is the motion along the geodesic. Where the
/// surface bends so sharply that the HIP would be nearer to another part of it, and the truth would jump, the depth is
/// reduced, but not below a third. Where the surface breaks off at an edge the path continues straight, out of the
/// edge, at full depth.
TruthPath truthSlide(const TouchTruth& truth, const SurfacePoint& start, const DVec3& towards, const ModelScale& scale,
                     const TruthPathOptions& options);

/// Down at the speed of the options to their depth, a rest of a quarter of a second, and up. The window is the second
/// half of the rest.
TruthPath truthPress(const SurfacePoint& start, const ModelScale& scale, const TruthPathOptions& options);

/// Five times down at the speed of the options and up again. The window is the whole path.
TruthPath truthTaps(const SurfacePoint& start, const ModelScale& scale, const TruthPathOptions& options);

}  // namespace palpate
