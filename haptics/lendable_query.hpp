// Lends the back end of a running servo loop to another thread, and answers the loop meanwhile.
#pragma once

#include <array>
#include <bitset>
#include <span>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "haptics/state_numbers.hpp"

namespace palpate {

/// While it is lent, each hand keeps the planes that it felt last: whole for the first tenth of a second, after which
/// they fade (kLent_s); planes of moving points, and forces of matter, fade as those of late answers. All calls are for
/// the thread of the loop; the borrower works between lend() and takeBack() on the query itself.
class LendableQuery final : public ContactQuery {
 public:
  /// `query` must outlive it.
  explicit LendableQuery(ContactQuery& query);

  std::size_t hands() const noexcept override { return query_.hands(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void endTick() noexcept override {
    if (!isLent_) query_.endTick();
  }
  std::span<const PointContact> points(std::size_t hand) const noexcept override {
    return isLent_ ? std::span<const PointContact>(held_[hand].points) : query_.points(hand);
  }
  /// While it is lent: a hand that is put down elsewhere touches nothing until then.
  void resetHand(std::size_t hand) noexcept override;

  void lend() noexcept;
  void takeBack() noexcept;
  bool isLent() const noexcept { return isLent_; }

  /// The answers that the next tick would keep.
  void visitState(StateNumbers& visit) noexcept;

 private:
  struct Held {
    Contact contact;
    Pose pose;                         // of that answer
    std::vector<PointContact> points;  // as given now
    std::vector<PointContact> felt;    // as answered last
  };
  void keepLast() noexcept;

  ContactQuery& query_;
  std::span<const Contact> last_;  // answers of the query, valid until it is asked again
  std::array<Pose, kMaxHands> poses_;
  std::vector<Held> held_;
  std::vector<Contact> answers_;
  std::bitset<kMaxHands> resets_;
  bool isLent_ = false, isKept_ = false;  // isKept_: held_ has the last answers
};

}  // namespace palpate
