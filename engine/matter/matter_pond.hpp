// Matter that somebody else simulates, around hands that are here: it answers at once, and follows what is known of it.
#pragma once

#include <vector>

#include "engine/matter/known_matter.hpp"
#include "engine/matter/matter_world.hpp"
#include "engine/matter/pond_members.hpp"

namespace palpate {

/// What a pond has come to.
struct PondCounts {
  std::uint64_t news = 0;      ///< times that other particles were known than before
  std::uint64_t restarts = 0;  ///< times that all of it was somewhere else, or what was here was no matter any more
};

/// The particles around the ball of each hand by the same laws as all of them are moved elsewhere. Those next to a ball
/// are their own: they give way to it at once. Those farther out are held where they are known to be, so that what
/// becomes of the whole comes in from there: a level that rises, a flow, what other hands do. A ball is there as a
/// whole at once, since what is within is left out. Hands get no more energy out of it than they have put in, but for
/// kLent_J: a force that would give more loses what of it goes along the way of the hand. On the CPU; for one thread.
class MatterPond final : public MatterWorld {
 public:
  static constexpr double kLent_J = 5e-4;

  /// `news` is asked before each step. Throws Error as planOf() does.
  MatterPond(const MatterScene& scene, const MatterOptions& options, MatterNews news);

  const PondCounts& counts() const { return counts_; }
  std::size_t members() const { return members_.size(); }
  std::optional<double> knownAt_s() const override { return knownAt_s_; }
  /// Of the members, and of what else is known.
  std::vector<Vec3> positionsById() const override;
  std::vector<Vec3> velocitiesById() const override;

 private:
  bool makesRoom() const override { return true; }
  void begin() override;
  void placeToolAt(std::size_t tool, const HandPose& hand) override;
  StepReport run(std::span<const HandPose> from, std::span<const HandPose> to) override;
  void beforeSubstep() override;

  void hear();
  float gone() const;
  bool isElsewhere() const;
  void renew();
  void take();
  void set(std::vector<PondMember> members);
  void empty();
  void lend(StepReport& report, std::span<const HandPose> from, std::span<const HandPose> to) const;
  std::vector<DVec3> balls() const;
  std::vector<std::uint32_t> othersKnown() const;

  MatterNews news_;
  PondMembers rules_;
  PondReach reach_;
  KnownMatter known_;
  std::vector<PondMember> members_;  // by their numbers
  std::vector<DVec3> balls_;
  std::optional<double> knownAt_s_;
  std::uint32_t sinceNews_ = 0, betweenNews_ = 1;  // steps
  bool isPlaced_ = false;                          // a ball has come elsewhere since the members were looked at
  PondCounts counts_;
};

}  // namespace palpate
