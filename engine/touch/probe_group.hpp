#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/core/tool_shape.hpp"

namespace palpate {

/// The probes of one hand, from pose to pose: the HIP itself, number 0, and the points of its tool, where it has a
/// tool of many; what was answered to each, and the answer that the hand gets. Both back ends keep one for each hand;
/// it allocates nothing after it was made.
class ProbeGroup {
 public:
  /// Places in model units. Throws UsageError for too many points, and for shares that do not sum up to one.
  explicit ProbeGroup(const ToolShape& shape);

  std::uint32_t probes() const { return 1 + static_cast<std::uint32_t>(places_.size()); }
  /// Where a probe is.
  DVec3 place(std::uint32_t probe, const Pose& pose) const {
    return probe == 0 ? pose.hip : pose.hip + pose.turn * places_[probe - 1];
  }
  /// Whether all probes are at places that single precision knows, relative to the cloud's origin.
  bool isFiniteAt(const Pose& pose, const DVec3& origin) const;

  /// A question that is to be answered: answered() is about this pose.
  void ask(const Pose& pose) { question_ = pose; }
  const Pose& question() const { return question_; }
  /// First the HIP itself, then each of the others.
  void answered(std::uint32_t probe, const Contact& contact);
  /// The hand gets what was answered last, as a whole (ContactQuery::points); while no point of a tool touches, that is
  /// the answer to the HIP itself.
  void give();
  /// For a pose that is a fault. `lost`: and all that come.
  void fail(const Pose& pose, bool lost) { answer_ = {.proxy = pose.hip, .lost = lost}; }
  /// For a pose that got no answer: each probe's tangent plane, softened by its age (heldContact).
  void hold(const Pose& pose);
  /// The same, with the answer of somebody else to a point of the tool where there is one: follow(probe, pose) gives it
  /// or nothing, and the planes that follow are its; trust(time_s) is how much of it counts now. `own`: for the HIP
  /// itself.
  template <class Follow>
  void bridge(const Contact& own, const Pose& pose, double trust, Follow&& follow) {
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      Pose at = pose;
      at.hip = points_[i].hip = place(1 + i, pose);
      if (const std::optional<Contact> contact = follow(1 + i, at)) {
        last_[i].hip = at.hip;
        last_[i].contact = *contact;
        times_s_[i] = pose.time_s;
        points_[i].contact = softened(*contact, at, trust);
      } else {
        points_[i].contact = softened(heldPoint(i, at), at, trust);
      }
    }
    answer_ = sum(own, pose.hip);
  }
  /// The stylus was lifted, or all that was answered counts no more.
  void forget();

  /// What was answered last to the HIP itself, and to which pose.
  const Contact& own() const { return own_; }
  const Pose& ownPose() const { return ownPose_; }
  /// What the hand gets.
  const Contact& answer() const { return answer_; }
  std::span<const PointContact> points() const { return points_; }

 private:
  Contact heldPoint(std::uint32_t i, const Pose& at) const;
  Contact sum(Contact whole, const DVec3& hip) const;

  std::vector<DVec3> places_;         // of the tool's points
  std::vector<PointContact> points_;  // as the hand gets them
  std::vector<PointContact> last_;    // as they were answered last
  std::vector<double> times_s_;       // of those poses
  Contact own_;                       // of the HIP itself
  Pose ownPose_, question_;
  Contact answer_;
};

/// One for each hand's tool. Throws UsageError for no hand, for more than kMaxHands, and as ProbeGroup does.
std::vector<ProbeGroup> makeProbeGroups(std::span<const ToolShape> tools);

}  // namespace palpate
