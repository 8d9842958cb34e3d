#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/core/tool_shape.hpp"

namespace palpate {

/// A tool of many points, from pose to pose: where each point is, and what was last answered to it. Both back ends keep
/// one; it allocates nothing after it was made.
class ToolContacts {
 public:
  /// Places in model units. Throws UsageError for shares that do not sum up to one.
  explicit ToolContacts(const ToolShape& shape);

  std::uint32_t size() const { return static_cast<std::uint32_t>(points_.size()); }
  /// Where a point of the tool is.
  DVec3 hip(std::uint32_t i, const Pose& pose) const { return pose.hip + pose.turn * places_[i]; }
  /// Whether all points are at places that single precision knows, relative to the cloud's origin.
  bool isFiniteAt(const Pose& pose, const DVec3& origin) const;

  /// The answer to `pose`: first that to the HIP itself, then that to each of the points.
  void answered(const Contact& own, const Pose& pose);
  void answered(std::uint32_t i, const Contact& contact);
  /// The last answer as a whole (ContactQuery::points); while no point touches, that of the HIP itself.
  Contact whole();
  /// For a pose that got no answer: each point's tangent plane, softened by its age (heldContact).
  Contact held(const Pose& pose);
  /// The same, with the answer of somebody else to a point where there is one: follow(i, pose) gives it or nothing,
  /// and the planes that follow are its; trust(time_s) is how much of it counts now. `own`: for the HIP itself.
  template <class Follow>
  Contact bridged(const Contact& own, const Pose& pose, double trust, Follow&& follow) {
    for (std::uint32_t i = 0; i < size(); ++i) {
      Pose at = pose;
      at.hip = points_[i].hip = hip(i, pose);
      if (const std::optional<Contact> contact = follow(i, at)) {
        last_[i].hip = at.hip;
        last_[i].contact = *contact;
        times_s_[i] = pose.time_s;
        points_[i].contact = softened(*contact, at, trust);
      } else {
        points_[i].contact = softened(heldPoint(i, at), at, trust);
      }
    }
    return sum(own, pose.hip);
  }
  /// The stylus was lifted, or all that was answered counts no more.
  void forget();

  std::span<const PointContact> points() const { return points_; }

 private:
  Contact heldPoint(std::uint32_t i, const Pose& at) const;
  Contact sum(Contact whole, const DVec3& hip) const;

  std::vector<DVec3> places_;
  std::vector<PointContact> points_;  // as they were told last
  std::vector<PointContact> last_;    // as they were answered last
  std::vector<double> times_s_;       // of those poses
  Contact lastOwn_;                   // of the HIP itself
  Pose lastPose_;
};

}  // namespace palpate
