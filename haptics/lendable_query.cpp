#include "haptics/lendable_query.hpp"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <utility>

#include "engine/core/held_contact.hpp"

namespace palpate {
namespace {

/// A surface that only the borrower may change is as it was: its planes hold for this long. Then they fade, since the
/// hand may be elsewhere.
constexpr double kLent_s = 0.1, kMaxLent_s = 0.2;

Contact heldFrom(const Contact& last, const Pose& lastPose, const Pose& pose) {
  const double age_s = pose.time_s - lastPose.time_s;
  if (last.force_N && last.touching) {
    const double share = shareLeft(age_s, kStale_s, kStalest_s);
    Contact held = last;
    held.proxy += pose.hip - lastPose.hip;
    held.fresh = false;
    held.dataTime_s = dataTime_s(last, lastPose);
    *held.force_N *= share;
    held.torque_mNm *= share;
    return held;
  }
  if (last.velocity != DVec3(0)) return heldContact(last, lastPose, pose);
  const double share = shareLeft(age_s, kLent_s, kMaxLent_s);
  Contact held = heldPlane(last, lastPose, pose, share);
  if (share >= 1 && held.dataTime_s == lastPose.time_s) held.dataTime_s = pose.time_s;
  return held;
}

}  // namespace

LendableQuery::LendableQuery(ContactQuery& query) : query_(query), held_(query.hands()), answers_(query.hands()) {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const std::span<const PointContact> points = query.points(i);
    held_[i].points.assign(points.begin(), points.end());
    held_[i].felt = held_[i].points;
  }
}

std::span<const Contact> LendableQuery::ask(std::span<const Pose> poses, double budget_us) noexcept {
  if (!isLent_) {
    std::ranges::copy(poses, poses_.begin());
    isKept_ = false;
    return last_ = query_.ask(poses, budget_us);
  }
  for (std::size_t i = 0; i < held_.size(); ++i) {
    Held& held = held_[i];
    const Pose& pose = poses[i];
    const DQuat turned = pose.turn * glm::inverse(held.pose.turn);
    for (std::size_t k = 0; k < held.points.size(); ++k) {
      const PointContact& felt = held.felt[k];
      Pose from = held.pose, at = pose;
      from.hip = felt.hip;
      at.hip = pose.hip + turned * (felt.hip - held.pose.hip);
      held.points[k] = {.hip = at.hip, .share = felt.share, .contact = heldFrom(felt.contact, from, at)};
    }
    answers_[i] = combined(heldFrom(held.contact, held.pose, pose), held.points, pose.hip);
  }
  return answers_;
}

void LendableQuery::resetHand(std::size_t hand) noexcept {
  if (!isLent_) return query_.resetHand(hand);
  resets_.set(hand);
  held_[hand].contact.touching = false;
  for (PointContact& point : held_[hand].felt) point.contact.touching = false;
}

void LendableQuery::keepLast() noexcept {
  if (std::exchange(isKept_, true)) return;
  for (std::size_t i = 0; i < last_.size(); ++i) {
    held_[i].contact = last_[i];
    held_[i].pose = poses_[i];
    std::ranges::copy(query_.points(i), held_[i].felt.begin());
  }
}

void LendableQuery::lend() noexcept {
  if (isLent_) return;
  keepLast();
  for (Held& held : held_) held.points = held.felt;
  isLent_ = true;
}

void LendableQuery::takeBack() noexcept {
  if (!std::exchange(isLent_, false)) return;
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (resets_.test(i)) query_.resetHand(i);
  resets_.reset();
}

void LendableQuery::visitState(StateNumbers& visit) noexcept {
  if (!visit.reads()) keepLast();
  isKept_ = true;
  const auto visitContact = [&](Contact& contact) {
    visit(contact.proxy, contact.normal, contact.touching, contact.fresh, contact.valid, contact.neighbours,
          contact.velocity, contact.dataTime_s, contact.force_N, contact.torque_mNm);
  };
  for (Held& held : held_) {
    visitContact(held.contact);
    visit(held.pose.time_s, held.pose.hip, held.pose.turn);
    for (PointContact& point : held.felt) {
      visit(point.hip, point.share);
      visitContact(point.contact);
    }
  }
}

}  // namespace palpate
