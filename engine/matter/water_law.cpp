// Position-based fluids (Macklin, Mueller 2013), one Jacobi iteration in each small substep: a pass that sums weights
// to compressions, and a pass that sums pushes to velocity changes. Both process four or eight neighbours at once, with
// the same results bit by bit.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/core/widest_lanes.hpp"
#include "engine/matter/lanes.hpp"
#include "engine/matter/matter_law.hpp"
#include "engine/matter/matter_rules.hpp"

namespace palpate {

namespace {

Lanes lanesOf(const Vec4& values) { return Lanes::at(&values.x); }

// A slot, and its neighbours: `count` of them, and copies of the last one up to a multiple of kListedTogether.
struct Around {
  const MatterParticles& particles;
  std::size_t slot;
  const Neighbour* neighbours;
  std::size_t count;
};

template <std::size_t N, class Value>
VectorsOf<N> vectorsOf(const Neighbour* neighbours, Value&& value) {
  std::array<Lanes, N> all;
  for (std::size_t k = 0; k < N; ++k) all[k] = value(neighbours[k]);
  return VectorsOf<N>::of(all);
}

// Positions of `N` neighbours: those beyond a periodic border are shifted to their near image.
template <std::size_t N>
VectorsOf<N> placesOf(const MatterParticles& particles, const Vec4* places, const Neighbour* neighbours) {
  if (!particles.isPeriodic())
    return vectorsOf<N>(neighbours, [&](Neighbour other) { return lanesOf(places[other.slot]); });
  return vectorsOf<N>(neighbours,
                      [&](Neighbour other) { return lanesOf(places[other.slot] + Vec4(particles.shiftOf(other), 0)); });
}

// 1 for each of the `N` indices from `first` on that is below `count`, otherwise 0.
template <std::size_t N>
LanesOf<N> areThere(std::size_t first, std::size_t count) {
  static constexpr std::array<float, 2 * kListedTogether> kOnes{1, 1, 1, 1, 1, 1, 1, 1};
  const std::size_t left = std::min(count - first, N);
  return LanesOf<N>::at(kOnes.data() + kListedTogether - left);
}

// Stores the neighbours' pulls, 0 for copies; returns the sum of their weights.
template <std::size_t N>
float weighBy(const Around& around, float support, float* pulls) {
  using Many = LanesOf<N>;
  const Vec3 place(around.particles.places()[around.slot]);
  const Many x(place.x), y(place.y), z(place.z), perSupport(1 / support), one(1);
  const Vec4* const places = around.particles.places().data();
  Lanes sum(0);
  for (std::size_t k = 0; k < around.count; k += N) {
    const VectorsOf<N> others = placesOf<N>(around.particles, places, around.neighbours + k);
    const Many offX = x - others.x, offY = y - others.y, offZ = z - others.z;
    const Many r = min(sqrt(offX * offX + offY * offY + offZ * offZ) * perSupport, one);
    const Many there = areThere<N>(k, around.count);
    (there * shared::wendland<Many>(r)).addTo(sum);
    (there * shared::wendlandPull<Many>(r)).writeTo(pulls + k);
  }
  return sum.sum();
}

template <std::size_t N>
Vec3 changeBy(const Around& around, const shared::WaterRules& single, const float* pulls) {
  using Many = LanesOf<N>;
  const Vec4* const velocities = around.particles.velocities().data();
  const Vec4* const places = around.particles.pressed().data();
  const Vec4 place = places[around.slot], velocity = velocities[around.slot];
  const Many x(place.x), y(place.y), z(place.z), vx(velocity.x), vy(velocity.y), vz(velocity.z);
  const Many pressed(shared::pressing(place.w)), atSurface(shared::atSurface(place.w));
  const Many perSupport(1 / single.support), one(1);
  shared::WaterRulesOf<Many> rules{};
  rules.push = Many(single.push);
  rules.drag = Many(single.drag);
  rules.cohesion = Many(single.cohesion);
  glm::vec<3, Lanes> change(Lanes(0), Lanes(0), Lanes(0));
  const auto add = [&](const glm::vec<3, Many>& part) {
    for (int axis = 0; axis < 3; ++axis) part[axis].addTo(change[axis]);
  };
  for (std::size_t k = 0; k < around.count; k += N) {
    const Neighbour* const neighbours = around.neighbours + k;
    const VectorsOf<N> others = placesOf<N>(around.particles, places, neighbours);
    const VectorsOf<N> moving =
        vectorsOf<N>(neighbours, [&](Neighbour other) { return lanesOf(velocities[other.slot]); });
    const glm::vec<3, Many> offset(x - others.x, y - others.y, z - others.z);
    const glm::vec<3, Many> relative(moving.x - vx, moving.y - vy, moving.z - vz);
    add(shared::changeByNeighbour<Many>(rules, offset, Many::at(pulls + k), pressed + shared::pressing<Many>(others.w),
                                        relative));
    if (single.cohesion == 0) continue;
    // Copies that pad a list must not attract, just as they do not push.
    const Many there = areThere<N>(k, around.count);
    const Many r = min(sqrt(glm::dot(offset, offset)) * perSupport, one);
    add(there * shared::changeByCohesion<Many>(rules, offset, r, atSurface + shared::atSurface<Many>(others.w)));
  }
  return {change.x.sum(), change.y.sum(), change.z.sum()};
}

#ifdef PALPATE_WITH_AVX2
PALPATE_WITH_AVX2 float weigh(const Around& around, float support, float* pulls) {
  return weighBy<8>(around, support, pulls);
}
PALPATE_WITH_AVX2 Vec3 changeByNeighbours(const Around& around, const shared::WaterRules& rules, const float* pulls) {
  return changeBy<8>(around, rules, pulls);
}
#endif
PALPATE_WITHOUT_AVX2 float weigh(const Around& around, float support, float* pulls) {
  return weighBy<4>(around, support, pulls);
}
PALPATE_WITHOUT_AVX2 Vec3 changeByNeighbours(const Around& around, const shared::WaterRules& rules,
                                             const float* pulls) {
  return changeBy<4>(around, rules, pulls);
}

class WaterLaw final : public MatterLaw {
 public:
  WaterLaw(const MatterScene& scene, const MatterPlan& plan) { change(scene, plan); }

  void change(const MatterScene& scene, const MatterPlan& plan) override { rules_ = waterRules(scene, plan); }

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

  // Data of a block: `pulls` per neighbour in its lists, 0 for copies; `fixed` per slot; `met`: points of bodies, and
  // `metUntil` the end of those of each slot and body.
  struct Pairs {
    std::vector<float> pulls;
    std::vector<Fixed> fixed;
    std::vector<BoundaryMeeting> met;
    std::vector<std::size_t> metUntil;
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

  static Around around(const MatterParticles& particles, std::size_t slot) {
    const std::span<const Neighbour> neighbours = particles.lists().of(slot);
    return {particles, slot, neighbours.data(), neighbours.size()};
  }

  void compress(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::size_t block) {
    const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, particles.size());
    Pairs& pairs = pairs_[block];
    const std::size_t room = particles.lists().inBlock(block);
    if (pairs.pulls.size() < room) pairs.pulls.resize(room);
    pairs.fixed.resize(kSlotsOfBlock);
    pairs.met.clear();
    pairs.metUntil.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 place(particles.places()[i]);
      float sum = 1;  // the particle itself
      sum += weigh(around(particles, i), rules_.support, pairs.pulls.data() + particles.lists().firstOf(i));
      for (const BoundaryBody& body : bodies) {
        body.forEachNear(place, [&](const BoundaryMeeting& met) {
          sum += met.volume * shared::wendland(met.r);
          pairs.met.push_back(met);
        });
        pairs.metUntil.push_back(pairs.met.size());
      }
      const Fixed& fixed = pairs.fixed[i - begin] = fixedAt(particles.config(), place);
      sum += fixed.walls.sum + fixed.model.sum;
      particles.pressed()[i] = Vec4(place, shared::compressionOf(rules_, sum));
    }
  }

  Vec3 changeByBody(const MatterParticles& particles, const BoundaryBody& body, std::size_t slot,
                    std::span<const BoundaryMeeting> meetings, Exchange& exchange) const {
    const Vec4 place = particles.pressed()[slot];
    const Vec3 velocity(particles.velocities()[slot]);
    Vec3 change{0};
    for (const BoundaryMeeting& met : meetings) {
      const Vec3 part = met.volume * shared::changeByNeighbour(rules_, met.offset, shared::wendlandPull(met.r),
                                                               shared::pressing(place.w), met.velocity - velocity);
      exchange.add(-static_cast<double>(particles.config().mass_kg) * DVec3(part), DVec3(met.arm));
      change += part;
    }
    const Vec3 outwards = body.pushedOut(Vec3(place), rules_.step);
    exchange.add(-static_cast<double>(particles.config().mass_kg) * DVec3(outwards), DVec3(Vec3(place) - body.place()));
    return change + outwards;
  }

  void push(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::size_t block, BlockSums& sums) {
    const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, particles.size());
    const Pairs& pairs = pairs_[block];
    const std::span<const Vec4> places = std::as_const(particles).pressed();
    std::size_t met = 0, of = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const float compression = shared::pressing(places[i].w);
      const Vec3 velocity(std::as_const(particles).velocities()[i]);
      Vec3 change = changeByNeighbours(around(particles, i), rules_, pairs.pulls.data() + particles.lists().firstOf(i));
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        const std::size_t until = pairs.metUntil[of++];
        change += changeByBody(particles, bodies[b], i, std::span(pairs.met).subspan(met, until - met), sums.bodies[b]);
        met = until;
      }
      const Fixed& fixed = pairs.fixed[i - begin];
      const Vec3 byWalls = shared::changeByWalls(rules_, fixed.walls, compression, velocity);
      const Vec3 byModel = shared::changeByWalls(rules_, fixed.model, compression, velocity);
      sums.wallImpulse -= static_cast<double>(particles.config().mass_kg) * DVec3(byWalls);
      sums.mostCompression = std::max(sums.mostCompression, compression);
      particles.settle(i, change + byWalls + byModel, byModel, sums);
    }
  }

  shared::WaterRules rules_;
  std::vector<Pairs> pairs_;
};

}  // namespace

std::unique_ptr<MatterLaw> waterLaw(const MatterScene& scene, const MatterPlan& plan) {
  return std::make_unique<WaterLaw>(scene, plan);
}

}  // namespace palpate
