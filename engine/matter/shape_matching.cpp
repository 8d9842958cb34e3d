#include "engine/matter/shape_matching.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace palpate {

namespace {

constexpr int kAlong = 4, kApart = 2;  // number of nodes of a region along an axis, and from one region to the next
constexpr std::size_t kRegionsOfBlock = 16, kNodesOfBlock = 256;

template <class Each>
void forEachOf(std::size_t count, std::size_t ofBlock, WorkerTeam& team, Each&& each) {
  team.forEach((count + ofBlock - 1) / ofBlock, [&](std::size_t block) {
    for (std::size_t i = block * ofBlock; i < std::min((block + 1) * ofBlock, count); ++i) each(i);
  });
}

// Number of regions along an axis with nodes from 0 to `last`: the last region has at least two layers if the axis has.
int regionsAlong(int last) { return std::max(1, (last - 1 + kApart - 1) / kApart); }

// The rotation R that maximises the trace of R^T `now`, for any `now`: the eigenvector of Horn's matrix (1987) with the
// largest eigenvalue, by Jacobi rotations.
DQuat bestTurnOf(const glm::dmat3& now) {
  constexpr int kSweeps = 12;
  const auto n = [&](int row, int column) { return now[column][row]; };
  double a[4][4] = {{n(0, 0) + n(1, 1) + n(2, 2), n(2, 1) - n(1, 2), n(0, 2) - n(2, 0), n(1, 0) - n(0, 1)},
                    {0, n(0, 0) - n(1, 1) - n(2, 2), n(0, 1) + n(1, 0), n(2, 0) + n(0, 2)},
                    {0, 0, n(1, 1) - n(0, 0) - n(2, 2), n(1, 2) + n(2, 1)},
                    {0, 0, 0, n(2, 2) - n(0, 0) - n(1, 1)}};
  double vectors[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) a[i][j] = a[j][i];
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int p = 0; p < 3; ++p)
      for (int q = p + 1; q < 4; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 4; ++k) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y;
          a[k][q] = s * x + c * y;
        }
        for (int k = 0; k < 4; ++k) {
          const double x = a[p][k], y = a[q][k], v = vectors[k][p], w = vectors[k][q];
          a[p][k] = c * x - s * y;
          a[q][k] = s * x + c * y;
          vectors[k][p] = c * v - s * w;
          vectors[k][q] = s * v + c * w;
        }
      }
  int best = 0;
  for (int k = 1; k < 4; ++k) best = a[k][k] > a[best][best] ? k : best;
  return glm::normalize(DQuat(vectors[0][best], vectors[1][best], vectors[2][best], vectors[3][best]));
}

// The same, by Newton's method from a nearby rotation: if the system is positive definite, this optimum is unique.
// Otherwise, as for an inverted region, falls back to bestTurnOf().
DQuat bestTurn(const glm::dmat3& now, DQuat turn) {
  constexpr int kMaxSteps = 6;
  constexpr double kMinTurn = 1e-10, kMaxTurn = 0.5, kMinShare = 1e-3;
  for (int step = 0; step < kMaxSteps; ++step) {
    const glm::dmat3 along = now * glm::transpose(glm::mat3_cast(turn));
    const double trace = along[0][0] + along[1][1] + along[2][2];
    const glm::dmat3 bends = trace * glm::dmat3(1) - 0.5 * (along + glm::transpose(along));
    const double least = kMinShare * trace, second = bends[0][0] * bends[1][1] - bends[1][0] * bends[1][0];
    const double third = glm::determinant(bends);
    if (!(trace > 0 && bends[0][0] > least && second > least * least && third > least * least * least)) break;
    const DVec3 torque(along[1][2] - along[2][1], along[2][0] - along[0][2], along[0][1] - along[1][0]);
    const DVec3 more = glm::inverse(bends) * torque;
    const double angle = glm::length(more);
    if (!(angle < kMaxTurn)) break;
    if (angle < kMinTurn) return turn;
    turn = glm::normalize(glm::angleAxis(angle, more / angle) * turn);
  }
  return bestTurnOf(now);
}

}  // namespace

MatchingRules MatchingRules::inSubstep(double stiffness, double substep_s) {
  return {.stiffness_1_s2 = stiffness / (substep_s * substep_s),
          .damping_1_s = stiffness / substep_s,
          .energy_1_s2 = stiffness / (1 - stiffness) / (substep_s * substep_s)};
}

ShapeMatching::ShapeMatching(const SoftLattice& lattice, std::span<const float> masses, const MatchingRules& rules)
    : lattice_(lattice.rest()), rules_(rules), forces_(lattice.nodes(), Vec3(0)) {
  DVec3 low(lattice.rest().front());
  for (const Vec3& place : lattice.rest()) low = glm::min(low, DVec3(place));
  IVec3 last(0);
  const auto numberOf = [&](std::size_t node) {
    return IVec3(glm::round((DVec3(lattice.rest()[node]) - low) / lattice.spacing_m()));
  };
  for (std::size_t i = 0; i < lattice.nodes(); ++i) last = glm::max(last, numberOf(i));
  const IVec3 count(regionsAlong(last.x), regionsAlong(last.y), regionsAlong(last.z));
  const LatticeBox boxes{.cells = count};
  std::vector<std::vector<std::uint32_t>> nodesOf(
      static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y) * static_cast<std::size_t>(count.z));
  std::vector<std::uint32_t> regionsOf(lattice.nodes(), 0);
  for (std::uint32_t i = 0; i < lattice.nodes(); ++i) {
    const IVec3 at = numberOf(i), home = at / kApart;
    for (int k = 0; k < 8; ++k) {
      const IVec3 box = home - IVec3(k & 1, k >> 1 & 1, k >> 2 & 1);
      if (!boxes.holds(box) || glm::any(glm::greaterThanEqual(at - kApart * box, IVec3(kAlong)))) continue;
      nodesOf[boxes.numberOf(box)].push_back(i);
      ++regionsOf[i];
    }
  }
  std::vector<std::vector<Part>> parts(lattice.nodes());
  for (const auto& nodes : nodesOf) {
    if (nodes.empty()) continue;
    Region region{.first = static_cast<std::uint32_t>(members_.size())};
    for (const std::uint32_t node : nodes) {
      parts[node].push_back({.region = static_cast<std::uint32_t>(regions_.size()),
                             .member = static_cast<std::uint32_t>(members_.size())});
      members_.push_back({.node = node, .mass = static_cast<double>(masses[node]) / regionsOf[node]});
    }
    region.last = static_cast<std::uint32_t>(members_.size());
    regions_.push_back(region);
  }
  for (const auto& ofNode : parts) {
    firstPart_.push_back(static_cast<std::uint32_t>(parts_.size()));
    parts_.insert(parts_.end(), ofNode.begin(), ofNode.end());
  }
  firstPart_.push_back(static_cast<std::uint32_t>(parts_.size()));
  setRest(std::vector<Vec3>(lattice.nodes(), Vec3(0)));
}

void ShapeMatching::begin() {
  for (Region& region : regions_) region.turn = DQuat(1, 0, 0, 0);
}

std::vector<DQuat> ShapeMatching::turns() const {
  std::vector<DQuat> turns;
  for (const Region& region : regions_) turns.push_back(region.turn);
  return turns;
}

void ShapeMatching::setTurns(std::span<const DQuat> turns) {
  for (std::size_t i = 0; i < regions_.size(); ++i) regions_[i].turn = turns[i];
}

void ShapeMatching::setRest(std::span<const Vec3> displacements) {
  for (Region& region : regions_) {
    double mass = 0;
    region.atRest = DVec3(0);
    for (std::size_t k = region.first; k < region.last; ++k) {
      members_[k].arm = DVec3(lattice_[members_[k].node]) + DVec3(displacements[members_[k].node]);
      region.atRest += members_[k].mass * members_[k].arm;
      mass += members_[k].mass;
    }
    region.atRest /= mass;
    for (std::size_t k = region.first; k < region.last; ++k) members_[k].arm -= region.atRest;
  }
}

DVec3 ShapeMatching::placeOf(const Member& member, std::span<const Vec3> displacements) const {
  return DVec3(lattice_[member.node]) + DVec3(displacements[member.node]);
}

// Updates the region's centroid and rotation.
void ShapeMatching::place(Region& region, std::span<const Vec3> displacements) const {
  double mass = 0;
  region.middle = DVec3(0);
  for (std::size_t k = region.first; k < region.last; ++k) {
    region.middle += members_[k].mass * placeOf(members_[k], displacements);
    mass += members_[k].mass;
  }
  region.middle /= mass;
  glm::dmat3 now(0);
  for (std::size_t k = region.first; k < region.last; ++k)
    now += members_[k].mass * glm::outerProduct(placeOf(members_[k], displacements) - region.middle, members_[k].arm);
  region.turn = bestTurn(now, region.turn);
  region.rotation = glm::mat3_cast(region.turn);
}

// Updates its rigid motion, from its momentum and angular momentum.
void ShapeMatching::follow(Region& region, std::span<const Vec3> displacements,
                           std::span<const Vec3> velocities) const {
  constexpr double kMinInertia = 1e-9;  // of the trace: regularises a rotation around an axis that contains all nodes
  double mass = 0;
  DVec3 momentum(0), angular(0);
  glm::dmat3 inertia(0);
  for (std::size_t k = region.first; k < region.last; ++k) {
    mass += members_[k].mass;
    momentum += members_[k].mass * DVec3(velocities[members_[k].node]);
  }
  region.velocity = momentum / mass;
  for (std::size_t k = region.first; k < region.last; ++k) {
    const DVec3 arm = placeOf(members_[k], displacements) - region.middle;
    angular += members_[k].mass * glm::cross(arm, DVec3(velocities[members_[k].node]) - region.velocity);
    inertia += members_[k].mass * (glm::dot(arm, arm) * glm::dmat3(1) - glm::outerProduct(arm, arm));
  }
  const double size = inertia[0][0] + inertia[1][1] + inertia[2][2];
  region.spin = size > 0 ? glm::inverse(inertia + kMinInertia * size * glm::dmat3(1)) * angular : DVec3(0);
}

void ShapeMatching::push(std::span<const Vec3> displacements, std::span<const Vec3> velocities, WorkerTeam& team) {
  forEachOf(regions_.size(), kRegionsOfBlock, team, [&](std::size_t i) {
    place(regions_[i], displacements);
    follow(regions_[i], displacements, velocities);
  });
  forEachOf(forces_.size(), kNodesOfBlock, team, [&](std::size_t node) {
    DVec3 force(0);
    for (std::uint32_t k = firstPart_[node]; k < firstPart_[node + 1]; ++k) {
      const Region& region = regions_[parts_[k].region];
      const Member& member = members_[parts_[k].member];
      const DVec3 place = placeOf(member, displacements);
      const DVec3 asWhole = region.velocity + glm::cross(region.spin, place - region.middle);
      force += member.mass * (rules_.stiffness_1_s2 * (goalOf(region, member) - place) +
                              rules_.damping_1_s * (asWhole - DVec3(velocities[node])));
    }
    forces_[node] = Vec3(force);
  });
}

double ShapeMatching::energy_J(std::span<const Vec3> displacements) const {
  double energy = 0;
  for (Region region : regions_) {
    place(region, displacements);
    for (std::size_t k = region.first; k < region.last; ++k) {
      const DVec3 away = placeOf(members_[k], displacements) - goalOf(region, members_[k]);
      energy += rules_.energy_1_s2 * members_[k].mass * glm::dot(away, away) / 2;
    }
  }
  return energy;
}

}  // namespace palpate
