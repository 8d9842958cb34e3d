// The true surface and an ideal probe on it: the reference for touch.
#pragma once

#include <functional>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/triangle_mesh.hpp"

namespace palpate {

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

}  // namespace palpate
