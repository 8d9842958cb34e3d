// Position-based fluids (Macklin, Mueller 2013), one Jacobi iteration in each small substep: a pass that sums weights
// to compressions, and a pass that sums pushes to velocity changes. Both process four neighbours at once.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/matter/lanes.hpp"
#include "engine/matter/matter_law.hpp"
#include "engine/matter/matter_rules.hpp"

namespace palpate {

namespace {

static_assert(Lanes::kCount == kListedTogether);

Lanes lanesOf(const Vec4& values) { return Lanes::at(&values.x); }

class WaterLaw final : public MatterLaw {
 public:
  WaterLaw(const MatterScene& scene, const MatterPlan& plan) { change(scene, plan); }

  void change(const MatterScene& scene, const MatterPlan& plan) override {
    rules_ = waterRules(scene, plan);
    sideBySide_.push = Lanes(rules_.push);
    sideBySide_.drag = Lanes(rules_.drag);
    sideBySide_.cohesion = Lanes(rules_.cohesion);
  }

  void renumber(std::span<const std::uint32_t>) override {}  // no per-particle state

  void solve(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::span<BlockSums> sums,
             WorkerTeam& team) override {
    pairs_.resize(sums.size());
    team.forEach(sums.size(), [&](std::size_t block) { compress(particles, bodies, block); });
    team.forEach(sums.size(), [&](std::size_t block) { push(particles, bodies, block, sums[block]); });
    particles.flip();
  }

 private:
  // Static surroundings of a position.
  struct Fixed {
    shared::WallEffect walls, model{};
  };

  // Data of a block: `pulls` per neighbour in its lists, 0 for copies; `fixed` per slot.
  struct Pairs {
    std::vector<float> pulls;
    std::vector<Fixed> fixed;
  };

  Fixed fixedAt(const MatterParticles::Config& config, const Vec3& place) const {
    Fixed fixed{.walls = wallsAt(config.box, place)};
    if (config.model == nullptr) return fixed;
    const shared::ModelAt at = config.model->at(place);
    fixed.model = modelEffect(rules_, at, fixed.walls);
    fixed.walls = wallsBesideModel(fixed.walls, at);
    return fixed;
  }

  shared::WallEffect wallsAt(const MatterBox& box, const Vec3& place) const {
    return shared::wallEffect(rules_, shared::wallsBeside(rules_, place.x, box.size.x, box.periodic[0]),
                              shared::wallsBeside(rules_, place.y, box.size.y, box.periodic[1]),
                              shared::wallsBeside(rules_, place.z, box.size.z, box.periodic[2]));
  }

  template <class Value>
  static FourVectors fourOf(const Neighbour* four, Value&& value) {
    return FourVectors::of(value(four[0]), value(four[1]), value(four[2]), value(four[3]));
  }
  // Positions of four neighbours: those beyond a periodic border are shifted to their near image.
  static FourVectors placesOf(const MatterParticles& particles, const Vec4* places, const Neighbour* four) {
    if (!particles.isPeriodic()) return fourOf(four, [&](Neighbour other) { return lanesOf(places[other.slot]); });
    return fourOf(four,
                  [&](Neighbour other) { return lanesOf(places[other.slot] + Vec4(particles.shiftOf(other), 0)); });
  }

  // 1 for each of the four indices from `first` on that is below `count`, otherwise 0.
  static Lanes areThere(std::size_t first, std::size_t count) {
    static constexpr std::array<float, 7> kOnes{1, 1, 1, 1, 0, 0, 0};
    const std::size_t left = count - first;
    return Lanes::at(kOnes.data() + (left < Lanes::kCount ? Lanes::kCount - left : 0));
  }

  // Stores the neighbours' pulls; returns the sum of their weights.
  float weigh(const MatterParticles& particles, std::size_t slot, Pairs& pairs) const {
    const std::span<const Neighbour> neighbours = particles.lists().filledUp(slot);
    const std::size_t count = particles.lists().of(slot).size(), first = particles.lists().firstOf(slot);
    const Vec3 place(particles.places()[slot]);
    const Lanes x(place.x), y(place.y), z(place.z), perSupport(1 / rules_.support), one(1);
    const Vec4* const places = particles.places().data();
    Lanes sum(0);
    for (std::size_t k = 0; k < neighbours.size(); k += Lanes::kCount) {
      const FourVectors others = placesOf(particles, places, neighbours.data() + k);
      const glm::vec<3, Lanes> offset(x - others.x, y - others.y, z - others.z);
      const Lanes r = min(sqrt(offset.x * offset.x + offset.y * offset.y + offset.z * offset.z) * perSupport, one);
      const Lanes there = areThere(k, count);
      sum += there * shared::wendland<Lanes>(r);
      (there * shared::wendlandPull<Lanes>(r)).writeTo(pairs.pulls.data() + first + k);
    }
    return sum.sum();
  }

  void compress(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::size_t block) {
    const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, particles.size());
    Pairs& pairs = pairs_[block];
    const std::size_t room = particles.lists().inBlock(block);
    if (pairs.pulls.size() < room) pairs.pulls.resize(room);
    pairs.fixed.resize(kSlotsOfBlock);
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 place(particles.places()[i]);
      float sum = 1;  // the particle itself
      sum += weigh(particles, i, pairs);
      for (const BoundaryBody& body : bodies)
        body.forEachNear(place, [&](const BoundaryMeeting& met) { sum += met.volume * shared::wendland(met.r); });
      const Fixed& fixed = pairs.fixed[i - begin] = fixedAt(particles.config(), place);
      sum += fixed.walls.sum + fixed.model.sum;
      particles.pressed()[i] = Vec4(place, shared::compressionOf(rules_, sum));
    }
  }

  Vec3 changeByNeighbours(const MatterParticles& particles, const Pairs& pairs, std::size_t slot) const {
    const std::span<const Neighbour> neighbours = particles.lists().filledUp(slot);
    const Vec4* const velocities = particles.velocities().data();
    const Vec4* const places = particles.pressed().data();
    const Vec4 place = places[slot], velocity = velocities[slot];
    const Lanes x(place.x), y(place.y), z(place.z), vx(velocity.x), vy(velocity.y), vz(velocity.z);
    const Lanes pressed(shared::pressing(place.w)), atSurface(shared::atSurface(place.w));
    const Lanes perSupport(1 / rules_.support), one(1);
    const shared::WaterRulesOf<Lanes> rules = sideBySide_;
    const float* const pulls = pairs.pulls.data() + particles.lists().firstOf(slot);
    glm::vec<3, Lanes> change(Lanes(0), Lanes(0), Lanes(0));
    for (std::size_t k = 0; k < neighbours.size(); k += Lanes::kCount) {
      const FourVectors others = placesOf(particles, places, neighbours.data() + k);
      const FourVectors moving =
          fourOf(neighbours.data() + k, [&](Neighbour other) { return lanesOf(velocities[other.slot]); });
      const glm::vec<3, Lanes> offset(x - others.x, y - others.y, z - others.z);
      const glm::vec<3, Lanes> relative(moving.x - vx, moving.y - vy, moving.z - vz);
      change += shared::changeByNeighbour<Lanes>(rules, offset, Lanes::at(pulls + k),
                                                 pressed + shared::pressing<Lanes>(others.w), relative);
      if (rules_.cohesion == 0) continue;
      // Copies that pad a list must not attract, just as they do not push.
      const Lanes there = areThere(k, particles.lists().of(slot).size());
      const Lanes r = min(sqrt(glm::dot(offset, offset)) * perSupport, one);
      change +=
          there * shared::changeByCohesion<Lanes>(rules, offset, r, atSurface + shared::atSurface<Lanes>(others.w));
    }
    return {change.x.sum(), change.y.sum(), change.z.sum()};
  }

  Vec3 changeByBody(const MatterParticles& particles, const BoundaryBody& body, std::size_t slot,
                    Exchange& exchange) const {
    const Vec4 place = particles.pressed()[slot];
    const Vec3 velocity(particles.velocities()[slot]);
    Vec3 change{0};
    body.forEachNear(Vec3(place), [&](const BoundaryMeeting& met) {
      const Vec3 part = met.volume * shared::changeByNeighbour(rules_, met.offset, shared::wendlandPull(met.r),
                                                               shared::pressing(place.w), met.velocity - velocity);
      exchange.add(-static_cast<double>(particles.config().mass_kg) * DVec3(part), DVec3(met.arm));
      change += part;
    });
    const Vec3 outwards = body.pushedOut(Vec3(place), rules_.step);
    exchange.add(-static_cast<double>(particles.config().mass_kg) * DVec3(outwards), DVec3(Vec3(place) - body.place()));
    return change + outwards;
  }

  void push(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::size_t block, BlockSums& sums) {
    const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, particles.size());
    const Pairs& pairs = pairs_[block];
    const std::span<const Vec4> places = std::as_const(particles).pressed();
    for (std::size_t i = begin; i < end; ++i) {
      const float compression = shared::pressing(places[i].w);
      const Vec3 velocity(std::as_const(particles).velocities()[i]);
      Vec3 change = changeByNeighbours(particles, pairs, i);
      for (std::size_t b = 0; b < bodies.size(); ++b) change += changeByBody(particles, bodies[b], i, sums.bodies[b]);
      const Fixed& fixed = pairs.fixed[i - begin];
      const Vec3 byWalls = shared::changeByWalls(rules_, fixed.walls, compression, velocity);
      const Vec3 byModel = shared::changeByWalls(rules_, fixed.model, compression, velocity);
      sums.wallImpulse -= static_cast<double>(particles.config().mass_kg) * DVec3(byWalls);
      sums.mostCompression = std::max(sums.mostCompression, compression);
      particles.settle(i, change + byWalls + byModel, byModel, sums);
    }
  }

  shared::WaterRules rules_;
  shared::WaterRulesOf<Lanes> sideBySide_;
  std::vector<Pairs> pairs_;
};

}  // namespace

std::unique_ptr<MatterLaw> waterLaw(const MatterScene& scene, const MatterPlan& plan) {
  return std::make_unique<WaterLaw>(scene, plan);
}

}  // namespace palpate
