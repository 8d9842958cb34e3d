// Local simulation of remote matter around the local hands: it answers without latency, and follows the known state.
#pragma once

#include <vector>

#include "engine/matter/known_matter.hpp"
#include "engine/matter/matter_world.hpp"
#include "engine/matter/pond_members.hpp"

namespace palpate {

/// Counters of a pond.
struct PondCounts {
  std::uint64_t news = 0;      ///< number of updates of the known particles
  std::uint64_t restarts = 0;  ///< number of restarts: a jump of the known state, or a failed local simulation
};

/// Simulates the particles around the ball of each hand with the laws of the remote simulation. Particles next to a
/// ball move freely: they yield to it at once. Those farther out are held at their known positions, so that changes of
/// the whole arrive from there: a rising level, a flow, the action of other hands. A ball has its full size at once, as
/// matter inside it is left out. Hands get no more energy out than they have put in, except kLent_J: a force that would
/// give more loses its excess along the hand's displacement. On the CPU; for one thread.
class MatterPond final : public MatterWorld {
 public:
  static constexpr double kLent_J = 5e-4;

  /// `news` is called before each step. Throws Error as planOf() does.
  MatterPond(const MatterScene& scene, const MatterOptions& options, MatterNews news);

  const PondCounts& counts() const { return counts_; }
  std::size_t members() const { return members_.size(); }
  std::optional<double> knownAt_s() const override { return knownAt_s_; }
  /// Positions and velocities of the members and of the other known particles.
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
  std::vector<PondMember> members_;  // indexed by the local particle id
  std::vector<DVec3> balls_;
  std::optional<double> knownAt_s_;
  std::uint32_t sinceNews_ = 0, betweenNews_ = 1;  // number of steps
  bool isPlaced_ = false;                          // a ball was placed since the members were last updated
  PondCounts counts_;
};

}  // namespace palpate
