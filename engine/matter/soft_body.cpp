#include "engine/matter/soft_body.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

namespace {

// Symplectic Euler is stable for w^2 dt^2 + 2 d dt < 4, with frequency w and damping rate d; the margin is for cells
// stiffer than at rest, such as crushed and stretched ones.
constexpr double kBudget = 3;
// Ratio of the skin's stiffness to that below it, in squared frequencies.
constexpr double kTouchStiffness = 2;

// Work items of one thread; fixed, so that sums do not depend on the number of threads.
constexpr std::size_t kGroupsOfBlock = 16, kNodesOfBlock = 256;

std::size_t blocksIn(std::size_t all, std::size_t block) { return (all + block - 1) / block; }

template <class Real>
shared::SoftRulesOf<Real> rulesIn(const shared::SoftRules& rules) {
  return {.shear = Real(rules.shear),
          .bulk = Real(rules.bulk),
          .restVolume = Real(rules.restVolume),
          .viscosity = Real(rules.viscosity),
          .bend = Real(rules.bend),
          .twist = Real(rules.twist),
          .bendDrag = Real(rules.bendDrag),
          .perEdges = Real(rules.perEdges)};
}

template <class Real>
shared::CellRestOf<Real> cellRestIn(const shared::CellRest* rest) {
  using Vector = glm::vec<3, Real>;
  using Matrix = glm::mat<3, 3, Real>;
  if (!rest)
    return {.inverse = Matrix(1), .bent = {Vector(0), Vector(0), Vector(0), Vector(0)}, .volume = 1, .bend = 1};
  return {.inverse = Matrix(rest->inverse),
          .bent = {Vector(rest->bent[0]), Vector(rest->bent[1]), Vector(rest->bent[2]), Vector(rest->bent[3])},
          .volume = static_cast<Real>(rest->volume),
          .bend = static_cast<Real>(rest->bend)};
}

}  // namespace

shared::SoftRules softRules(const SoftMaterial& material, double spacing_m) {
  const double shear = material.shear_Pa();
  const double lame = material.bulk_Pa() - 2.0 / 3 * shear;
  // So that small strains follow Hooke's law (Smith, de Goes, Kim 2018, section 3.4).
  const double energyShear = 4.0 / 3 * shear, energyBulk = lame + 5.0 / 6 * shear;
  const double square = spacing_m * spacing_m;
  shared::SoftRules rules{};
  rules.shear = static_cast<float>(energyShear);
  rules.bulk = static_cast<float>(energyBulk);
  rules.restVolume = static_cast<float>(1 + 0.75 * energyShear / energyBulk);
  rules.viscosity = static_cast<float>(material.viscosity_Pa_s);
  // Mean square distance from the centre of a cell, a twelfth of the squared edge, by which bending strains; and its
  // square.
  rules.bend = static_cast<float>(material.young_Pa / (48 * square));
  rules.twist = static_cast<float>(material.young_Pa / (144 * square));
  rules.bendDrag = static_cast<float>(3 * material.viscosity_Pa_s / (48 * square));  // 3: Trouton, as for stretching
  rules.perEdges = static_cast<float>(1 / (4 * spacing_m));
  return rules;
}

double highestFrequency(const SoftMaterial& material, double spacing_m) {
  return std::sqrt(12 * material.bulk_Pa() / material.density_kg_m3) / spacing_m;
}

double touchFrequency(const SoftMaterial& material, double spacing_m) {
  return std::sqrt(kTouchStiffness) * highestFrequency(material, spacing_m);
}

double longestSubstep(const SoftMaterial& material, double spacing_m, double touched_kg_per_kg, double stiffer) {
  const double own = highestFrequency(material, spacing_m), touch = touchFrequency(material, spacing_m);
  const double both = 1 + touched_kg_per_kg;
  const double square = stiffer * own * own + touch * touch * both;
  const double damping = stiffer * 8 * material.viscosity_Pa_s / (material.density_kg_m3 * spacing_m * spacing_m) +
                         kTouchDamping * touch * both;
  return kBudget / (damping + std::sqrt(damping * damping + square * kBudget));
}

std::vector<float> nodeMasses(const SoftLattice& lattice, double mass_kg) {
  std::vector<float> masses;
  for (const double share : lattice.nodeShares()) masses.push_back(static_cast<float>(mass_kg * share));
  return masses;
}

std::vector<char> nodesWithin(const SoftLattice& lattice, std::span<const PlaceBox> boxes) {
  std::vector<char> within;
  for (const Vec3& rest : lattice.rest())
    within.push_back(std::ranges::any_of(boxes, [&](const PlaceBox& box) { return box.holds(DVec3(rest)); }) ? 1 : 0);
  return within;
}

SoftBody::SoftBody(const SoftLattice& lattice, const SoftMaterial& material, std::span<const PlaceBox> pinned)
    : lattice_(lattice),
      rules_(softRules(material, lattice.spacing_m())),
      mass_kg_(material.density_kg_m3 * lattice.volume_m3()),
      masses_(nodeMasses(lattice, mass_kg_)),
      pinned_(nodesWithin(lattice, pinned)),
      incident_(lattice.incident()),
      rest_(lattice, rules_) {
  filled_.resize(blocksIn(lattice.cells(), Lanes::kCount));
  for (std::size_t group = 0; group < filled_.size(); ++group) {
    std::array<float, Lanes::kCount> filled{};
    for (std::size_t lane = 0; lane < Lanes::kCount && group * Lanes::kCount + lane < lattice.cells(); ++lane)
      filled[lane] = lattice.filled()[group * Lanes::kCount + lane];
    filled_[group] = Lanes(filled);
  }
  cornerForces_.assign(lattice.cells() / Lanes::kCount + 1, {});
  leastVolumes_.resize(blocksIn(filled_.size(), kGroupsOfBlock));
  sums_.resize(blocksIn(lattice.nodes(), kNodesOfBlock));
  reset();
}

void SoftBody::reset() {
  moved_.assign(rest_.displacements().begin(), rest_.displacements().end());
  velocities_.assign(lattice_.nodes(), Vec3(0));
  loads_ = velocities_;
}

std::size_t SoftBody::yield(std::span<const RestPlace> ways) {
  constexpr float kMaxCrushed = 0.1f, kMaxDrawn = 4;  // beyond these strains the rest displacement cannot be derived
  std::vector<RestPlace> places;
  std::vector<Vec3> before;
  for (const RestPlace& way : ways) {
    if (isPinned(way.node)) continue;
    const glm::mat3 elastic = elasticAt(way.node);
    if (!(glm::determinant(elastic) > kMaxCrushed)) continue;
    const Vec3 atRest = glm::inverse(elastic) * way.moved;
    if (!(glm::length(atRest) <= kMaxDrawn * glm::length(way.moved))) continue;
    before.push_back(rest_.displacements()[way.node]);
    places.push_back({.node = way.node, .moved = before.back() + atRest});
  }
  std::vector<Vec3> now = moved_;
  for (const RestPlace& way : ways) now[way.node] += way.moved;
  const std::size_t moved = rest_.yield(places);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const std::uint32_t node = places[k].node;
    if (rest_.displacements()[node] != before[k]) moved_[node] = now[node];
  }
  return moved;
}

void SoftBody::putRest(std::span<const RestPlace> places) {
  std::vector<glm::mat3> elastic;
  std::vector<Vec3> before;
  for (const RestPlace& place : places) {
    elastic.push_back(elasticAt(place.node));
    before.push_back(rest_.displacements()[place.node]);
  }
  rest_.put(places);
  for (std::size_t k = 0; k < places.size(); ++k)
    if (!isPinned(places[k].node)) moved_[places[k].node] += elastic[k] * (places[k].moved - before[k]);
}

// Deformation gradient over the rest shape: mean of the cells around a node, weighted by their fill.
glm::mat3 SoftBody::elasticAt(std::size_t node) const {
  glm::mat3 sum(0);
  float weight = 0;
  for (const std::uint32_t slot : incident_[node]) {
    const std::size_t cell = slot / 8;
    if (cell == lattice_.cells()) continue;
    shared::Corners modes = atCorners(cell, moved_);
    shared::takeModes(modes);
    sum += lattice_.filled()[cell] * rest_.elastic(cell, modes);
    weight += lattice_.filled()[cell];
  }
  return sum / weight;
}

shared::Corners SoftBody::atCorners(std::size_t cell, std::span<const Vec3> values) const {
  shared::Corners corners;
  const SoftLattice::Corners& nodes = lattice_.corners()[cell];
  for (std::size_t k = 0; k < 8; ++k) corners.at[k] = values[nodes[k]];
  return corners;
}

// Lanes beyond the last cell repeat it, with a fill of 0.
SoftBody::LanesOfCorners SoftBody::atCornersOfGroup(std::size_t group, std::span<const Vec3> values) const {
  std::array<const SoftLattice::Corners*, Lanes::kCount> nodes;
  for (std::size_t lane = 0; lane < Lanes::kCount; ++lane)
    nodes[lane] = &lattice_.corners()[std::min(group * Lanes::kCount + lane, lattice_.cells() - 1)];
  LanesOfCorners corners;
  for (std::size_t k = 0; k < 8; ++k) {
    const Vec3 &a = values[(*nodes[0])[k]], &b = values[(*nodes[1])[k]], &c = values[(*nodes[2])[k]],
               &d = values[(*nodes[3])[k]];
    corners.at[k] = {Lanes({a.x, b.x, c.x, d.x}), Lanes({a.y, b.y, c.y, d.y}), Lanes({a.z, b.z, c.z, d.z})};
  }
  return corners;
}

void SoftBody::pushCells(std::size_t block) {
  const std::size_t begin = block * kGroupsOfBlock, end = std::min(begin + kGroupsOfBlock, filled_.size());
  const auto rules = rulesIn<Lanes>(rules_);
  const Lanes cube(std::pow(lattice_.spacing_m(), 3));
  std::array<float, Lanes::kCount> least;
  least.fill(1);
  for (std::size_t group = begin; group < end; ++group) {
    LanesOfCorners moved = atCornersOfGroup(group, moved_), velocity = atCornersOfGroup(group, velocities_);
    shared::takeModes(moved);
    shared::takeModes(velocity);
    const RestShape::CellRestOfLanes* const rest = rest_.ofGroup(group);
    const auto f = rest ? shared::sculptedGradient(rules, *rest, moved)
                        : shared::gradientOf(rules, moved) + glm::mat<3, 3, Lanes>(Lanes(1));
    const Lanes volume = shared::volumeShare(f);
    for (std::size_t lane = 0; lane < Lanes::kCount; ++lane) least[lane] = std::min(least[lane], volume[lane]);
    cornerForces_[group] = rest ? shared::sculptedForces(rules, cube * filled_[group], *rest, moved, velocity)
                                : shared::cellForces(rules, cube * filled_[group], moved, velocity);
  }
  leastVolumes_[block] = *std::ranges::min_element(least);
}

Vec3 SoftBody::ofCells(std::size_t node) const {
  Vec3 force(0);
  for (const std::uint32_t slot : incident_[node]) {
    const std::uint32_t cell = slot / 8, lane = cell % Lanes::kCount;
    const auto& part = cornerForces_[cell / Lanes::kCount].at[slot % 8];
    force += Vec3(part.x[lane], part.y[lane], part.z[lane]);
  }
  return force;
}

void SoftBody::moveNodes(std::size_t block, const Vec3& fall, float step_s, SoftSums& sums) {
  const std::size_t begin = block * kNodesOfBlock, end = std::min(begin + kNodesOfBlock, size());
  sums = {};
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 force = forceOn(i);
    loads_[i] = Vec3(0);
    if (isPinned(i)) {
      sums.pinImpulse += static_cast<double>(step_s) * DVec3(force);
      continue;
    }
    const auto mass = static_cast<double>(masses_[i]);
    velocities_[i] += step_s / masses_[i] * force + fall;
    moved_[i] += step_s * velocities_[i];
    const DVec3 velocity(velocities_[i]);
    sums.momentum += mass * velocity;
    sums.kinetic_J += mass / 2 * glm::dot(velocity, velocity);
    sums.gravityImpulse += mass * DVec3(fall);
  }
}

SoftSums SoftBody::substep(const DVec3& gravity_m_s2, double step_s, WorkerTeam& team) {
  strain(team);
  return move(gravity_m_s2, step_s, team);
}

void SoftBody::strain(WorkerTeam& team) {
  team.forEach(leastVolumes_.size(), [&](std::size_t block) { pushCells(block); });
}

SoftSums SoftBody::move(const DVec3& gravity_m_s2, double step_s, WorkerTeam& team) {
  const Vec3 fall(gravity_m_s2 * step_s);
  team.forEach(sums_.size(),
               [&](std::size_t block) { moveNodes(block, fall, static_cast<float>(step_s), sums_[block]); });
  SoftSums all;
  for (const SoftSums& sums : sums_) {
    all.momentum += sums.momentum;
    all.kinetic_J += sums.kinetic_J;
    all.gravityImpulse += sums.gravityImpulse;
    all.pinImpulse += sums.pinImpulse;
  }
  for (const float least : leastVolumes_) all.leastVolume = std::min(all.leastVolume, least);
  return all;
}

std::vector<DVec3> SoftBody::forces(WorkerTeam& team) {
  strain(team);
  std::vector<DVec3> forces;
  for (std::size_t i = 0; i < size(); ++i) forces.emplace_back(ofCells(i));
  return forces;
}

void SoftBody::stiffnessTimes(std::span<const DVec3> changes, std::vector<DVec3>& forces, WorkerTeam& team) {
  // A central difference over strains of about a thousandth, which single precision resolves.
  constexpr double kStrain = 1e-3;
  double most = 0;
  for (const DVec3& change : changes) most = std::max(most, glm::length(change));
  forces.assign(size(), DVec3(0));
  if (!(most > 0)) return;
  const double scale = kStrain * lattice_.spacing_m() / most;
  const std::vector<Vec3> now = moved_;
  for (const double sign : {1.0, -1.0}) {
    for (std::size_t i = 0; i < size(); ++i)
      if (!isPinned(i)) moved_[i] = DVec3(now[i]) + sign * scale * changes[i];
    const std::vector<DVec3> pushed = this->forces(team);
    for (std::size_t i = 0; i < size(); ++i)
      if (!isPinned(i)) forces[i] -= sign / (2 * scale) * pushed[i];
  }
  moved_ = now;
}

// In double precision: energies at rest and strained are almost the same.
double SoftBody::strainEnergy_J() const {
  const auto rules = rulesIn<double>(rules_);
  const double atRest = shared::softEnergy(rules, glm::dmat3(1)), cube = std::pow(lattice_.spacing_m(), 3);
  double energy = 0;
  for (std::size_t c = 0; c < lattice_.cells(); ++c) {
    shared::CornersOf<double> modes;
    for (std::size_t k = 0; k < 8; ++k) modes.at[k] = DVec3(moved_[lattice_.corners()[c][k]]);
    shared::takeModes(modes);
    const auto rest = cellRestIn<double>(rest_.ofCell(c));
    const glm::dmat3 f = shared::sculptedGradient(rules, rest, modes);
    const auto square = [&](int mode, int bent) {
      const DVec3 beyond = modes.at[mode] - f * rest.bent[bent];
      return glm::dot(beyond, beyond);
    };
    const double bent = square(3, 0) + square(5, 1) + square(6, 2), twisted = square(7, 3);
    const double beyond = rest.bend * (rules.bend * bent + rules.twist * twisted) / 2;
    const double strained = shared::softEnergy(rules, f) + beyond;
    energy += cube * rest.volume * static_cast<double>(lattice_.filled()[c]) * (strained - atRest);
  }
  return energy;
}

glm::mat3 SoftBody::gradientOf(std::size_t cell) const {
  shared::Corners modes = atCorners(cell, moved_);
  shared::takeModes(modes);
  return shared::gradientOf(rules_, modes);
}

void SoftBody::gradients(std::vector<glm::mat3>& gradients, WorkerTeam& team) const {
  gradients.resize(size());
  team.forEach(sums_.size(), [&](std::size_t block) {
    const std::size_t begin = block * kNodesOfBlock, end = std::min(begin + kNodesOfBlock, size());
    for (std::size_t i = begin; i < end; ++i) {
      glm::mat3 sum(0);
      float weight = 0;
      for (const std::uint32_t slot : incident_[i]) {
        const std::size_t cell = slot / 8;
        if (cell == lattice_.cells()) continue;
        sum += lattice_.filled()[cell] * gradientOf(cell);
        weight += lattice_.filled()[cell];
      }
      gradients[i] = sum / weight;
    }
  });
}

}  // namespace palpate
