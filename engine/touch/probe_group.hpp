#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/core/tool_shape.hpp"

namespace palpate {

/// The probes of one hand, from pose to pose: the HIP, number 0, and the points of its tool, if it has any; the answer
/// to each, and the hand's answer. Both back ends keep one group per hand; it allocates nothing after construction.
class ProbeGroup {
 public:
  /// Positions in model units. Throws UsageError for too many points, and for shares that do not sum to one.
  explicit ProbeGroup(const ToolShape& shape);

  std::uint32_t probes() const { return 1 + static_cast<std::uint32_t>(places_.size()); }
  /// Position of a probe.
  DVec3 place(std::uint32_t probe, const Pose& pose) const {
    return probe == 0 ? pose.hip : pose.hip + pose.turn * places_[probe - 1];
  }
  /// Whether all probe positions relative to the cloud's origin are finite in single precision.
  bool isFiniteAt(const Pose& pose, const DVec3& origin) const;

  /// Begins a question: answered() refers to this pose.
  void ask(const Pose& pose) { question_ = pose; }
  const Pose& question() const { return question_; }
  /// Takes the answers: the HIP first, then each of the others.
  void answered(std::uint32_t probe, const Contact& contact);
  /// The hand gets the last answers, all at once (ContactQuery::points); while no point of a tool touches, the answer
  /// to the HIP.
  void give();
  /// For an invalid pose. `lost`: this answer and all further ones are lost.
  void fail(const Pose& pose, bool lost) { answer_ = {.proxy = pose.hip, .lost = lost}; }
  /// For a pose without an answer: each probe's tangent plane, softened by its age (heldContact).
  void hold(const Pose& pose);
  /// The same, with substitute answers for the points of the tool: follow(probe, pose) returns one or nullopt; later
  /// planes follow from it. `trust`: weight of the answers at this time. `own`: answer for the HIP.
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
    answer_ = combined(own, points_, pose.hip);
  }
  /// The stylus was lifted, or all answers are invalid.
  void forget();

  /// Last answer to the HIP, and its pose.
  const Contact& own() const { return own_; }
  const Pose& ownPose() const { return ownPose_; }
  /// The hand's answer.
  const Contact& answer() const { return answer_; }
  std::span<const PointContact> points() const { return points_; }

 private:
  Contact heldPoint(std::uint32_t i, const Pose& at) const;

  std::vector<DVec3> places_;         // positions of the tool's points
  std::vector<PointContact> points_;  // as the hand receives them
  std::vector<PointContact> last_;    // last answers
  std::vector<double> times_s_;       // times of their poses
  Contact own_;                       // last answer to the HIP
  Pose ownPose_, question_;
  Contact answer_;
};

/// One group per tool. Throws UsageError for no tool, for more than kMaxHands, and as ProbeGroup does.
std::vector<ProbeGroup> makeProbeGroups(std::span<const ToolShape> tools);

}  // namespace palpate
