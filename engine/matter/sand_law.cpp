// Position-based grains with friction (Macklin et al. 2014), whose contacts store their tangential displacement
// (Cundall, Strack 1979): one pass of gathers, in which each of the two grains keeps its own copy of a contact, equal
// but for the sign.
#include <algorithm>
#include <array>
#include <utility>

#include "engine/matter/matter_rules.hpp"
#include "engine/matter/matter_world.hpp"

namespace palpate {

namespace {

using shared::kMaxContacts;

// Contacts of a grain: the other's id, and the displacement.
struct Contacts {
  std::array<std::uint32_t, kMaxContacts> with;
  std::array<Vec3, kMaxContacts> slip;
  std::uint32_t count = 0;

  // Null if they did not touch.
  const Vec3* slipWith(std::uint32_t other) const {
    for (std::uint32_t k = 0; k < count; ++k)
      if (with[k] == other) return &slip[k];
    return nullptr;
  }
  void add(std::uint32_t other, const Vec3& displaced) {
    if (count == kMaxContacts) return;
    with[count] = other;
    slip[count++] = displaced;
  }
};

class SandLaw final : public MatterLaw {
 public:
  SandLaw(const MatterScene& scene, const MatterPlan& plan) : rules_(grainRules(scene, plan)) {}

  void change(const MatterScene& scene, const MatterPlan& plan) override { rules_ = grainRules(scene, plan); }

  void solve(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::span<BlockSums> sums,
             WorkerTeam& team) override {
    before_.resize(particles.size());
    after_.resize(particles.size());
    team.forEach(sums.size(), [&](std::size_t block) {
      const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, particles.size());
      for (std::size_t i = begin; i < end; ++i) touch(particles, bodies, i, sums[block]);
    });
    particles.flip();
    before_.swap(after_);
  }

 private:
  // State of a grain during a substep.
  struct Grain {
    Vec3 place, velocity;
    const Contacts& before;
    Contacts& after;
    Vec3 change{0};
    float mostOverlap = 0;
  };

  // An object that a grain touches.
  struct Other {
    std::uint32_t id;
    Vec3 offset;    // from it to the grain, m
    float overlap;  // m
    Vec3 velocity;  // m/s, as the grain's: includes the change by gravity, if gravity moves it
    Vec3 fall;      // that change by gravity, m/s
  };

  // Velocity change of the grain by the contact.
  Vec3 meet(Grain& grain, const Other& other, const Vec3& fall) const {
    const Vec3 moved = rules_.step * (grain.velocity - other.velocity);
    Vec3 slip(0);
    // The stored slip plus the displacement since: the velocities before gravity are those of the last substep.
    if (const Vec3* const left = grain.before.slipWith(other.id))
      slip = shared::grainSlip<float>(rules_, *left, moved, fall - other.fall);
    const shared::GrainContact contact =
        shared::grainContact<float>(rules_, glm::normalize(other.offset), other.overlap, moved, slip);
    grain.after.add(other.id, contact.slip);
    grain.change += contact.change;
    grain.mostOverlap = std::max(grain.mostOverlap, other.overlap);
    return contact.change;
  }

  void meetNeighbours(const MatterParticles& particles, std::size_t slot, Grain& grain) const {
    for (const Neighbour neighbour : particles.lists().of(slot)) {
      const Vec3 offset = grain.place - Vec3(particles.places()[neighbour.slot]) - particles.shiftOf(neighbour);
      const float distance = glm::length(offset);
      if (!(distance < rules_.diameter && distance > 0)) continue;
      meet(grain,
           {.id = particles.ids()[neighbour.slot],
            .offset = offset,
            .overlap = rules_.diameter - distance,
            .velocity = Vec3(particles.velocities()[neighbour.slot]),
            .fall = particles.fall()},
           particles.fall());
    }
  }

  // Impulse of all walls on the grain per kg.
  DVec3 meetWalls(const MatterBox& box, const Vec3& fall, Grain& grain) const {
    const Vec3 before = grain.change;
    for (int axis = 0; axis < 3; ++axis) {
      if (box.periodic[static_cast<std::size_t>(axis)]) continue;
      for (int side = 0; side < 2; ++side) {
        const float distance = side == 0 ? grain.place[axis] : box.size[axis] - grain.place[axis];
        const float overlap = rules_.diameter / 2 - distance;
        if (!(overlap > 0)) continue;
        Vec3 inwards(0);
        inwards[axis] = side == 0 ? 1.0f : -1.0f;
        meet(grain,
             {.id = shared::kFirstWall + static_cast<std::uint32_t>(2 * axis + side),
              .offset = inwards,
              .overlap = overlap,
              .velocity = Vec3(0),
              .fall = Vec3(0)},
             fall);
      }
    }
    return DVec3(grain.change - before);
  }

  // Velocity change of the grain by the model.
  Vec3 meetModel(const MatterModel* model, const Vec3& fall, Grain& grain) const {
    if (model == nullptr) return Vec3(0);
    const shared::ModelAt at = model->at(grain.place);
    const float overlap = rules_.diameter / 2 - at.distance;
    if (!(overlap > 0) || at.outwards == Vec3(0)) return Vec3(0);
    return meet(
        grain,
        {.id = shared::kModelContact, .offset = at.outwards, .overlap = overlap, .velocity = Vec3(0), .fall = Vec3(0)},
        fall);
  }

  void touch(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::size_t slot, BlockSums& sums) {
    const std::uint32_t id = particles.ids()[slot];
    Grain grain{.place = Vec3(particles.places()[slot]),
                .velocity = Vec3(std::as_const(particles).velocities()[slot]),
                .before = before_[id],
                .after = after_[id]};
    grain.after.count = 0;
    const double mass = particles.config().mass_kg;
    meetNeighbours(std::as_const(particles), slot, grain);
    sums.wallImpulse -= mass * meetWalls(particles.config().box, particles.fall(), grain);
    const Vec3 byModel = meetModel(particles.config().model, particles.fall(), grain);
    std::uint32_t first = shared::kFirstBodyPoint;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      bodies[b].forEachNear(grain.place, [&](const BoundaryMeeting& met) {
        const float distance = glm::length(met.offset);
        if (!(distance < rules_.diameter && distance > 0 && met.volume > 0)) return;
        const Vec3 part = meet(grain,
                               {.id = first + met.number,
                                .offset = met.offset,
                                .overlap = rules_.diameter - distance,
                                .velocity = met.velocity,
                                .fall = Vec3(0)},
                               particles.fall());
        sums.bodies[b].add(-mass * DVec3(part), DVec3(met.arm));
      });
      const Vec3 outwards = bodies[b].pushedOut(grain.place, rules_.step);
      sums.bodies[b].add(-mass * DVec3(outwards), DVec3(grain.place - bodies[b].place()));
      grain.change += outwards;
      first += bodies[b].size();
    }
    sums.mostCompression = std::max(sums.mostCompression, grain.mostOverlap / rules_.diameter);
    particles.settle(slot, grain.change, byModel, sums);
  }

  shared::GrainRules rules_;
  std::vector<Contacts> before_, after_;  // by id
};

}  // namespace

std::unique_ptr<MatterLaw> sandLaw(const MatterScene& scene, const MatterPlan& plan) {
  return std::make_unique<SandLaw>(scene, plan);
}

}  // namespace palpate
