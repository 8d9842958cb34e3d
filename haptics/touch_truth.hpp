// What there really is to be felt, and an ideal probe on it: the measure that touch is judged by.
#pragma once

#include <functional>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/triangle_mesh.hpp"

namespace palpate {

/// A surface that is known exactly. Model units, file coordinates.
struct TouchTruth {
  std::function<SurfacePoint(const DVec3&)> closest;
  std::function<double(const DVec3&)> signedDistance;  ///< positive outside
};

/// The shape or mesh must outlive the truth.
TouchTruth truthOf(const AnalyticShape& shape);
TouchTruth truthOf(const TriangleMesh& mesh);

/// The god-object (Zilles and Salisbury 1995) on the truth itself: a point that stays on the surface and goes as near
/// to the HIP as it can without leaving it. The HIP's motion is cut into pieces so short that neither a thin wall nor
/// an edge is missed, and it looks at every piece until it has arrived, however long that takes.
class GodObject {
 public:
  /// `longestStep` of the HIP and of the god-object between two steps, model units.
  GodObject(const TouchTruth& truth, double longestStep) : truth_(truth), longestStep_(longestStep) {}

  /// Goes on to where the HIP is now. The first call says where it begins, which has to be outside.
  void follow(const DVec3& hip);

  bool touching() const { return touching_; }
  /// Where it is on the surface; while nothing is touched, the point closest to the HIP.
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
