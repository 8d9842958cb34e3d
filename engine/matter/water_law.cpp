// Position-based fluids (Macklin, Mueller 2013), one Jacobi iteration in each small substep: a pass that sums weights
// to compressions, and a pass that sums pushes to velocity changes. Both process four or eight neighbours, or slots,
// at once, with the same results bit by bit.
#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <utility>

#include "engine/core/widest_lanes.hpp"
#include "engine/matter/lanes.hpp"
#include "engine/matter/matter_rules.hpp"
#include "engine/matter/matter_world.hpp"

namespace palpate {

namespace {

Lanes lanesOf(const Vec4& values) { return Lanes::at(&values.x); }

// A block of slots, and the lists of their neighbours.
struct Block {
  const MatterParticles& particles;
  NeighbourLists::OfBlock lists;
  std::size_t begin, end;

  Block(const MatterParticles& all, std::size_t block)
      : particles(all),
        lists(all.lists().ofBlock(block)),
        begin(block * kSlotsOfBlock),
        end(std::min(begin + kSlotsOfBlock, all.size())) {}
};

template <std::size_t N, class Value>
VectorsOf<N> vectorsOf(const Neighbour* neighbours, Value&& value) {
  return [&]<std::size_t... k>(std::index_sequence<k...>) { return VectorsOf<N>::of({value(neighbours[k])...}); }
  (std::make_index_sequence<N>());
}

// Without a periodic border all neighbours are in image 0, and the words of a list are slots.
template <bool periodic>
std::uint32_t slotOf(Neighbour other) {
  return periodic ? other.slot : std::bit_cast<std::uint32_t>(other);
}

// Positions of `N` neighbours: those beyond a periodic border are shifted to their near image.
template <std::size_t N, bool periodic>
VectorsOf<N> placesOf(const MatterParticles& particles, const Vec4* places, const Neighbour* neighbours) {
  return vectorsOf<N>(neighbours, [&](Neighbour other) {
    const Vec4& place = places[slotOf<periodic>(other)];
    return lanesOf(periodic ? place + Vec4(particles.shiftOf(other), 0) : place);
  });
}

// Calls body(k, part) for each `N` neighbours from the k-th on: a part of a LaneSum.
template <std::size_t N, class Body>
void forEachLanes(std::size_t count, Body&& body) {
  for (std::size_t k = 0; k < count; k += kListedTogether) [&]<std::size_t... part>(std::index_sequence<part...>) {
      ((k + part * N < count ? body(k + part * N, part) : void()), ...);
    }
  (std::make_index_sequence<kListedTogether / N>());
}

template <class Real>
shared::WaterRulesOf<Real> rulesIn(const shared::WaterRules& rules) {
  return {.support = Real(rules.support),
          .restSum = Real(rules.restSum),
          .wallSum = Real(rules.wallSum),
          .wallInset = Real(rules.wallInset),
          .push = Real(rules.push),
          .wallPush = Real(rules.wallPush),
          .drag = Real(rules.drag),
          .wallDrag = Real(rules.wallDrag),
          .nearest = Real(rules.nearest),
          .step = Real(rules.step),
          .cohesion = Real(rules.cohesion)};
}

// By slot of a block.
using BySlot = std::array<float, kSlotsOfBlock>;

// For each slot the sum of its neighbours' weights; their pulls in the order of the lists.
template <std::size_t N, bool periodic>
void weighBy(const Block& block, float support, float* pulls, BySlot& sums) {
  using Many = LanesOf<N>;
  const Vec4* const places = block.particles.places().data();
  const Many perSupport(1 / support), one(1);
  for (std::size_t i = block.begin; i < block.end; ++i) {
    const std::uint32_t first = block.lists.first[i - block.begin];
    const Many x(places[i].x), y(places[i].y), z(places[i].z);
    LaneSum<N> sum;
    forEachLanes<N>(block.lists.counts[i - block.begin], [&](std::size_t k, std::size_t part) {
      const VectorsOf<N> others = placesOf<N, periodic>(block.particles, places, block.lists.neighbours + first + k);
      const Many offX = x - others.x, offY = y - others.y, offZ = z - others.z;
      const Many r = min(sqrt(offX * offX + offY * offY + offZ * offZ) * perSupport, one);
      sum.add(part, shared::wendland<Many>(r));
      shared::wendlandPull<Many>(r).writeTo(pulls + first + k);
    });
    sums[i - block.begin] = sum.total();
  }
}

// For each slot the change of its velocity by its neighbours.
template <std::size_t N, bool periodic, bool coheres>
void changeBy(const Block& block, const shared::WaterRules& single, const float* pulls,
              std::array<BySlot, 3>& changes) {
  using Many = LanesOf<N>;
  const Vec4* const velocities = block.particles.velocities().data();
  const Vec4* const places = block.particles.pressed().data();
  const Many perSupport(1 / single.support), one(1);
  const auto rules = rulesIn<Many>(single);
  for (std::size_t i = block.begin; i < block.end; ++i) {
    const std::uint32_t first = block.lists.first[i - block.begin];
    const Vec4 place = places[i], velocity = velocities[i];
    const Many x(place.x), y(place.y), z(place.z), vx(velocity.x), vy(velocity.y), vz(velocity.z);
    const Many pressed(shared::pressing(place.w)), atSurface(shared::atSurface(place.w));
    std::array<LaneSum<N>, 3> change;
    forEachLanes<N>(block.lists.counts[i - block.begin], [&](std::size_t k, std::size_t part) {
      const auto add = [&](const glm::vec<3, Many>& by) {
        change[0].add(part, by.x);
        change[1].add(part, by.y);
        change[2].add(part, by.z);
      };
      const Neighbour* const neighbours = block.lists.neighbours + first + k;
      const VectorsOf<N> others = placesOf<N, periodic>(block.particles, places, neighbours);
      const VectorsOf<N> moving =
          vectorsOf<N>(neighbours, [&](Neighbour other) { return lanesOf(velocities[slotOf<periodic>(other)]); });
      const glm::vec<3, Many> offset(x - others.x, y - others.y, z - others.z);
      const glm::vec<3, Many> relative(moving.x - vx, moving.y - vy, moving.z - vz);
      add(shared::changeByNeighbour<Many>(rules, offset, Many::at(pulls + first + k),
                                          pressed + shared::pressing<Many>(others.w), relative));
      if constexpr (coheres) {
        const Many r = min(sqrt(glm::dot(offset, offset)) * perSupport, one);
        add(shared::changeByCohesion<Many>(rules, offset, r, atSurface + shared::atSurface<Many>(others.w)));
      }
    });
    for (std::size_t axis = 0; axis < 3; ++axis) changes[axis][i - block.begin] = change[axis].total();
  }
}

// Effect of the walls of a box, by slot.
struct WallsBySlot {
  BySlot sum, drag;
  std::array<BySlot, 3> slope;
};

// Calls body(i, slots) for each `N` slots of a block from the i-th on: those after the last slot repeat it.
template <std::size_t N, class Body>
void forEachSlots(const Block& block, Body&& body) {
  for (std::size_t i = 0; i < block.end - block.begin; i += N) {
    std::array<std::size_t, N> slots;
    for (std::size_t k = 0; k < N; ++k) slots[k] = std::min(block.begin + i + k, block.end - 1);
    body(i, slots);
  }
}

template <std::size_t N>
VectorsOf<N> vectorsAt(const Vec4* vectors, const std::array<std::size_t, N>& slots) {
  return [&]<std::size_t... k>(std::index_sequence<k...>) { return VectorsOf<N>::of({lanesOf(vectors[slots[k]])...}); }
  (std::make_index_sequence<N>());
}

template <std::size_t N>
void meetWallsBy(const Block& block, const shared::WaterRules& single, const MatterBox& box, WallsBySlot& walls) {
  using Many = LanesOf<N>;
  const auto rules = rulesIn<Many>(single);
  forEachSlots<N>(block, [&](std::size_t i, const std::array<std::size_t, N>& slots) {
    const VectorsOf<N> places = vectorsAt<N>(block.particles.places().data(), slots);
    const std::array along{places.x, places.y, places.z};
    std::array<shared::WallsBesideOf<Many>, 3> beside;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (box.periodic[axis])
        beside[axis] = {.share = Many(0), .layer = Many(0), .drag = Many(0)};
      else
        beside[axis] = shared::wallsNear<Many>(rules, along[axis], Many(box.size[static_cast<int>(axis)]));
    const shared::WallEffectOf<Many> effect = shared::wallEffect<Many>(rules, beside[0], beside[1], beside[2]);
    effect.sum.writeTo(walls.sum.data() + i);
    effect.drag.writeTo(walls.drag.data() + i);
    for (std::size_t axis = 0; axis < 3; ++axis)
      effect.slope[static_cast<int>(axis)].writeTo(walls.slope[axis].data() + i);
  });
}

// Ends the substep of each slot, after a change of its velocity and that by walls; returns the impulse of the walls per
// kg.
template <std::size_t N>
DVec3 settleBy(const Block& block, const shared::WaterRules& single, const WallsBySlot& walls,
               const std::array<BySlot, 3>& changes, MatterParticles& particles) {
  using Many = LanesOf<N>;
  const auto rules = rulesIn<Many>(single);
  const shared::StoppingWalls& stopping = particles.walls();
  const shared::StoppingWallsOf<Many> stop{
      .size = {Many(stopping.size.x), Many(stopping.size.y), Many(stopping.size.z)},
      .nearest = Many(stopping.nearest),
      .step = Many(stopping.step),
      .openX = stopping.openX,
      .openY = stopping.openY,
      .openZ = stopping.openZ};
  const auto vectorAt = [](const std::array<BySlot, 3>& values, std::size_t i) {
    return glm::vec<3, Many>(Many::at(values[0].data() + i), Many::at(values[1].data() + i),
                             Many::at(values[2].data() + i));
  };
  std::array<std::array<double, 8>, 3> byAllWalls{};
  forEachSlots<N>(block, [&](std::size_t i, const std::array<std::size_t, N>& slots) {
    const VectorsOf<N> pressed = vectorsAt<N>(block.particles.pressed().data(), slots);
    const VectorsOf<N> moving = vectorsAt<N>(block.particles.velocities().data(), slots);
    const glm::vec<3, Many> velocity(moving.x, moving.y, moving.z);
    const shared::WallEffectOf<Many> effect{
        .sum = Many(0), .slope = vectorAt(walls.slope, i), .drag = Many::at(walls.drag.data() + i)};
    const glm::vec<3, Many> byWalls =
        shared::changeByWalls<Many>(rules, effect, shared::pressing<Many>(pressed.w), velocity);
    const shared::SettledOf<Many> settled =
        shared::settle<Many>(stop, glm::vec<3, Many>(pressed.x, pressed.y, pressed.z), velocity,
                             (Many(1) - moving.w) * (vectorAt(changes, i) + byWalls));
    const std::size_t count = std::min(N, block.end - block.begin - i);
    for (int axis = 0; axis < 3; ++axis) {
      std::array<float, N> some, more;
      byWalls[axis].writeTo(some.data());
      settled.stop[axis].writeTo(more.data());
      for (std::size_t k = 0; k < count; ++k)
        byAllWalls[static_cast<std::size_t>(axis)][(i + k) % 8] += double{some[k]} + double{more[k]};
    }
    const auto places = VectorsOf<N>{settled.place.x, settled.place.y, settled.place.z, Many(0)}.each();
    const auto next = VectorsOf<N>{settled.velocity.x, settled.velocity.y, settled.velocity.z, Many(0)}.each();
    for (std::size_t k = 0; k < count; ++k) {
      particles.positions()[block.begin + i + k] = Vec3(places[k][0], places[k][1], places[k][2]);
      next[k].writeTo(&particles.nextVelocities()[block.begin + i + k].x);
    }
  });
  DVec3 impulse;
  for (int axis = 0; axis < 3; ++axis) {
    const std::array<double, 8>& all = byAllWalls[static_cast<std::size_t>(axis)];
    impulse[axis] = std::accumulate(all.begin(), all.end(), 0.0);
  }
  return impulse;
}

template <std::size_t N>
void weighAny(const Block& block, float support, float* pulls, BySlot& sums) {
  block.particles.isPeriodic() ? weighBy<N, true>(block, support, pulls, sums)
                               : weighBy<N, false>(block, support, pulls, sums);
}
template <std::size_t N>
void changeAny(const Block& block, const shared::WaterRules& rules, const float* pulls,
               std::array<BySlot, 3>& changes) {
  if (rules.cohesion != 0)
    block.particles.isPeriodic() ? changeBy<N, true, true>(block, rules, pulls, changes)
                                 : changeBy<N, false, true>(block, rules, pulls, changes);
  else
    block.particles.isPeriodic() ? changeBy<N, true, false>(block, rules, pulls, changes)
                                 : changeBy<N, false, false>(block, rules, pulls, changes);
}

// NOLINTBEGIN(bugprone-macro-parentheses): an attribute cannot be in parentheses
#define PALPATE_BLOCK_LOOPS(target, N)                                                                  \
  target void weigh(const Block& block, float support, float* pulls, BySlot& sums) {                    \
    weighAny<N>(block, support, pulls, sums);                                                           \
  }                                                                                                     \
  target void meetWalls(const Block& block, const shared::WaterRules& rules, const MatterBox& box,      \
                        WallsBySlot& walls) {                                                           \
    meetWallsBy<N>(block, rules, box, walls);                                                           \
  }                                                                                                     \
  target void changeAll(const Block& block, const shared::WaterRules& rules, const float* pulls,        \
                        std::array<BySlot, 3>& changes) {                                               \
    changeAny<N>(block, rules, pulls, changes);                                                         \
  }                                                                                                     \
  target DVec3 settleAll(const Block& block, const shared::WaterRules& rules, const WallsBySlot& walls, \
                         const std::array<BySlot, 3>& changes, MatterParticles& particles) {            \
    return settleBy<N>(block, rules, walls, changes, particles);                                        \
  }
#ifdef PALPATE_WITH_AVX2
PALPATE_BLOCK_LOOPS(PALPATE_WITH_AVX2, 8)
#endif
PALPATE_BLOCK_LOOPS(PALPATE_WITHOUT_AVX2, 4)
#undef PALPATE_BLOCK_LOOPS
// NOLINTEND(bugprone-macro-parentheses)

class WaterLaw final : public MatterLaw {
 public:
  WaterLaw(const MatterScene& scene, const MatterPlan& plan) { change(scene, plan); }

  void change(const MatterScene& scene, const MatterPlan& plan) override { rules_ = waterRules(scene, plan); }

  void solve(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::span<BlockSums> sums,
             WorkerTeam& team) override {
    pairs_.resize(sums.size());
    team.forEach(sums.size(), [&](std::size_t block) { compress(particles, bodies, block); });
    team.forEach(sums.size(), [&](std::size_t block) { push(particles, bodies, block, sums[block]); });
    particles.flip();
  }

 private:
  // A slot near a body, and the end of its meetings with it.
  struct NearBody {
    std::uint32_t slot, body;
    std::size_t metUntil;
  };

  // Data of a block between the passes: `pulls` per entry of its lists, `model` per slot, `met`: points of bodies near
  // slots.
  struct Pairs {
    std::vector<float> pulls;
    WallsBySlot walls;
    std::vector<shared::WallEffect> model;
    std::vector<NearBody> near;
    std::vector<BoundaryMeeting> met;
  };

  // Adds the weights of the model, and reduces those of the walls beside it.
  void meetModel(const Block& block, const MatterModel& model, Pairs& pairs, BySlot& sums) const {
    pairs.model.resize(kSlotsOfBlock);
    for (std::size_t k = 0; k < block.end - block.begin; ++k) {
      const shared::ModelAt at = model.at(Vec3(block.particles.places()[block.begin + k]));
      WallsBySlot& walls = pairs.walls;
      const shared::WallEffect all{.sum = walls.sum[k],
                                   .slope = {walls.slope[0][k], walls.slope[1][k], walls.slope[2][k]},
                                   .drag = walls.drag[k]};
      pairs.model[k] = modelEffect(rules_, at, all);
      const shared::WallEffect left = wallsBesideModel(all, at);
      for (int axis = 0; axis < 3; ++axis) walls.slope[static_cast<std::size_t>(axis)][k] = left.slope[axis];
      walls.drag[k] = left.drag;
      walls.sum[k] = left.sum;
      sums[k] += pairs.model[k].sum;
    }
  }

  void meetBodies(const Block& block, std::span<const BoundaryBody> bodies, Pairs& pairs, BySlot& sums) const {
    pairs.near.clear();
    pairs.met.clear();
    for (std::uint32_t b = 0; b < bodies.size(); ++b)
      for (std::size_t i = block.begin; i < block.end; ++i) {
        const Vec3 place(block.particles.places()[i]);
        if (!bodies[b].isNear(place)) continue;
        bodies[b].forEachNear(place, [&](const BoundaryMeeting& met) {
          sums[i - block.begin] += met.volume * shared::wendland(met.r);
          pairs.met.push_back(met);
        });
        pairs.near.push_back({.slot = static_cast<std::uint32_t>(i), .body = b, .metUntil = pairs.met.size()});
      }
  }

  void compress(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::size_t number) {
    const Block block(particles, number);
    Pairs& pairs = pairs_[number];
    if (pairs.pulls.size() < block.lists.size) pairs.pulls.resize(block.lists.size);
    BySlot sums;
    weigh(block, rules_.support, pairs.pulls.data(), sums);
    meetWalls(block, rules_, particles.config().box, pairs.walls);
    meetBodies(block, bodies, pairs, sums);
    if (particles.config().model != nullptr) meetModel(block, *particles.config().model, pairs, sums);
    for (std::size_t i = block.begin; i < block.end; ++i) {
      const std::size_t k = i - block.begin;
      const float sum = 1 + sums[k] + pairs.walls.sum[k];  // with the particle itself
      particles.pressed()[i] = Vec4(Vec3(particles.places()[i]), shared::compressionOf(rules_, sum));
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
    if (outwards == Vec3(0)) return change;
    exchange.add(-static_cast<double>(particles.config().mass_kg) * DVec3(outwards), DVec3(Vec3(place) - body.place()));
    return change + outwards;
  }

  void push(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::size_t number, BlockSums& sums) {
    const Block block(particles, number);
    const Pairs& pairs = pairs_[number];
    const std::span<const Vec4> places = std::as_const(particles).pressed();
    std::array<BySlot, 3> changes{};  // also after the last slot
    changeAll(block, rules_, pairs.pulls.data(), changes);
    const auto add = [&](std::size_t slot, const Vec3& part) {
      for (int axis = 0; axis < 3; ++axis) changes[static_cast<std::size_t>(axis)][slot - block.begin] += part[axis];
    };
    std::size_t met = 0;
    for (const NearBody& near : pairs.near) {
      add(near.slot, changeByBody(particles, bodies[near.body], near.slot,
                                  std::span(pairs.met).subspan(met, near.metUntil - met), sums.bodies[near.body]));
      met = near.metUntil;
    }
    const bool hasModel = particles.config().model != nullptr;
    std::array<Vec3, kSlotsOfBlock> byModel;
    for (std::size_t i = block.begin; hasModel && i < block.end; ++i) {
      const std::size_t k = i - block.begin;
      byModel[k] = shared::changeByWalls(rules_, pairs.model[k], shared::pressing(places[i].w),
                                         Vec3(std::as_const(particles).velocities()[i]));
      add(i, byModel[k]);
    }
    const double mass = particles.config().mass_kg;
    sums.wallImpulse -= mass * settleAll(block, rules_, pairs.walls, changes, particles);
    for (std::size_t i = block.begin; i < block.end; ++i) {
      if (hasModel) particles.keepOutOfModel(i, byModel[i - block.begin], sums);
      particles.sumUp(i, sums);
      sums.mostCompression = std::max(sums.mostCompression, shared::pressing(places[i].w));
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
