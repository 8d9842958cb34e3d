// Position-based fluids (Macklin, Mueller 2013), one Jacobi iteration in each small substep: a pass that sums weights
// up to compressions, and one that sums pushes up to changes of velocity.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/matter/matter_law.hpp"
#include "engine/matter/matter_rules.hpp"

namespace palpate {

namespace {

// A neighbour within the support radius, as the first pass found it.
struct Pair {
  Vec3 offset;
  float pull;
  std::uint32_t slot;
};

// Neighbours side by side, so that the compiler takes several at once: a multiple of kSums of them, the last of which
// may be none, and far away.
constexpr std::size_t kLanes = 64, kSums = 8;
struct Lanes {
  std::size_t used = 0;
  std::array<float, kLanes> x, y, z, weight, pull;  // offsets from the neighbour, m
  std::array<std::uint32_t, kLanes> near;           // 1 within the support radius, otherwise 0

  void load(const MatterParticles& particles, std::size_t slot, std::span<const Neighbour> neighbours, float support) {
    const std::span<const Vec4> places = particles.places();
    const Vec3 place(places[slot]);
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
      Vec3 offset = place - Vec3(places[neighbours[k].slot]);
      if (neighbours[k].image != shared::kItself) offset -= particles.shiftOf(neighbours[k]);
      x[k] = offset.x;
      y[k] = offset.y;
      z[k] = offset.z;
    }
    used = (neighbours.size() + kSums - 1) / kSums * kSums;
    for (std::size_t k = neighbours.size(); k < used; ++k) x[k] = y[k] = z[k] = support;
  }

  // The sum of the weights.
  float weigh(float perSupport) {
    for (std::size_t k = 0; k < used; ++k) {
      const float r = std::sqrt(x[k] * x[k] + y[k] * y[k] + z[k] * z[k]) * perSupport;
      const float within = std::min(r, 1.0f);
      weight[k] = shared::wendland(within);
      pull[k] = shared::wendlandPull(within);
      near[k] = r < 1.0f ? 1u : 0u;
    }
    std::array<float, kSums> sums{};
    for (std::size_t k = 0; k < used; k += kSums)
      for (std::size_t part = 0; part < kSums; ++part) sums[part] += weight[k + part];
    float sum = 0;
    for (const float part : sums) sum += part;
    return sum;
  }
};

class WaterLaw final : public MatterLaw {
 public:
  explicit WaterLaw(const shared::WaterRules& rules) : rules_(rules) {}

  void solve(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::span<BlockSums> sums,
             WorkerTeam& team) override {
    pairs_.resize(sums.size());
    team.forEach(sums.size(), [&](std::size_t block) { compress(particles, bodies, block); });
    team.forEach(sums.size(), [&](std::size_t block) { push(particles, bodies, block, sums[block]); });
    particles.flip();
  }

 private:
  struct Pairs {
    std::vector<Pair> all;  // those of a slot from where its list begins
    std::vector<std::uint32_t> counts;
  };

  // What never moves about a place.
  struct Fixed {
    shared::WallEffect walls, model{};
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

  // Fills `pairs` with the neighbours within the support radius; the sum of their weights.
  float gather(const MatterParticles& particles, std::size_t slot, Pair* pairs, std::uint32_t& count) const {
    std::span<const Neighbour> neighbours = particles.lists().of(slot);
    float sum = 0;
    count = 0;
    while (!neighbours.empty()) {
      const std::span<const Neighbour> some = neighbours.first(std::min(neighbours.size(), kLanes));
      neighbours = neighbours.subspan(some.size());
      Lanes lanes;
      lanes.load(particles, slot, some, rules_.support);
      sum += lanes.weigh(1 / rules_.support);
      for (std::size_t k = 0; k < some.size(); ++k) {
        pairs[count] = {{lanes.x[k], lanes.y[k], lanes.z[k]}, lanes.pull[k], some[k].slot};
        count += static_cast<std::uint32_t>(lanes.near[k]);
      }
    }
    return sum;
  }

  void compress(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::size_t block) {
    const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, particles.size());
    Pairs& pairs = pairs_[block];
    pairs.all.resize(std::max(pairs.all.size(), particles.lists().inBlock(block) + 1));
    pairs.counts.resize(kSlotsOfBlock);
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 place(particles.places()[i]);
      float sum = 1;  // the particle itself
      sum += gather(particles, i, pairs.all.data() + particles.lists().firstOf(i), pairs.counts[i - begin]);
      for (const BoundaryBody& body : bodies)
        body.forEachNear(place, [&](const BoundaryMeeting& met) { sum += met.volume * shared::wendland(met.r); });
      const Fixed fixed = fixedAt(particles.config(), place);
      sum += fixed.walls.sum + fixed.model.sum;
      particles.places()[i].w = std::max(shared::compressionOf(rules_, sum), 0.0f);
    }
  }

  // Not inline: beside others its sums would find no register.
  [[gnu::noinline]] Vec3 changeByNeighbours(std::span<const Pair> pairs, std::span<const Vec4> places,
                                            std::span<const Vec3> velocities, std::size_t slot) const {
    const shared::WaterRules rules = rules_;
    const float compression = places[slot].w;
    const Vec3 velocity = velocities[slot];
    // Apart, so that they stay in registers.
    float x = 0, y = 0, z = 0;
    for (const Pair& pair : pairs) {
      const Vec3 change = shared::changeByNeighbour(rules, pair.offset, pair.pull, compression + places[pair.slot].w,
                                                    velocities[pair.slot] - velocity);
      x += change.x;
      y += change.y;
      z += change.z;
    }
    return {x, y, z};
  }

  Vec3 changeByBody(const MatterParticles& particles, const BoundaryBody& body, std::size_t slot,
                    Exchange& exchange) const {
    const Vec4 place = particles.places()[slot];
    const Vec3 velocity = particles.velocities()[slot];
    Vec3 change{0};
    body.forEachNear(Vec3(place), [&](const BoundaryMeeting& met) {
      const Vec3 part = met.volume * shared::changeByNeighbour(rules_, met.offset, shared::wendlandPull(met.r), place.w,
                                                               met.velocity - velocity);
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
    const std::span<const Vec4> places = std::as_const(particles).places();
    const std::span<const Vec3> velocities = std::as_const(particles).velocities();
    for (std::size_t i = begin; i < end; ++i) {
      const float compression = places[i].w;
      const Vec3 velocity = velocities[i];
      const std::span<const Pair> near(pairs.all.data() + particles.lists().firstOf(i), pairs.counts[i - begin]);
      Vec3 change = changeByNeighbours(near, places, velocities, i);
      for (std::size_t b = 0; b < bodies.size(); ++b) change += changeByBody(particles, bodies[b], i, sums.bodies[b]);
      const Fixed fixed = fixedAt(particles.config(), Vec3(places[i]));
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
  return std::make_unique<WaterLaw>(waterRules(scene, plan));
}

}  // namespace palpate
