// Soft bodies with a sculpted rest shape: what yields, what does not, and the body's behaviour afterwards.
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "engine/matter/soft_scene.hpp"
#include "engine/matter/soft_sculpture.hpp"
#include "engine/matter/soft_source.hpp"
#include "engine/matter/soft_world.hpp"
#include "tests/edit/tool_at.hpp"
#include "tests/history_steps.hpp"
#include "tests/matter/soft_bodies.hpp"
#include "tests/matter/soft_maker.hpp"

namespace palpate::soft_sculpt_test {

namespace {

constexpr SoftMaterial kJelly{.young_Pa = 5e4, .poisson = 0.4, .density_kg_m3 = 1000, .viscosity_Pa_s = 0};

SoftSolid block(const DVec3& spacings) { return boxSolid(DVec3(0), spacings * kSoftSpacing_m, kSoftSpacing_m); }

// Every node's rest position is displaced by up to that fraction of a spacing along each axis.
std::vector<RestPlace> scattered(const SoftLattice& lattice, float share, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> to(-share, share);
  std::vector<RestPlace> places;
  for (std::uint32_t i = 0; i < lattice.nodes(); ++i) {
    RestPlace& place = places.emplace_back(RestPlace{.node = i});
    for (int axis = 0; axis < 3; ++axis) place.moved[axis] = static_cast<float>(lattice.spacing_m()) * to(random);
  }
  return places;
}

// A linear map of all nodes.
std::vector<RestPlace> stretched(const SoftLattice& lattice, const DVec3& scales) {
  std::vector<RestPlace> places;
  for (std::uint32_t i = 0; i < lattice.nodes(); ++i)
    places.push_back({.node = i, .moved = (scales - 1.0) * DVec3(lattice.rest()[i])});
  return places;
}

double largest(const std::vector<DVec3>& forces) {
  double most = 0;
  for (const DVec3& force : forces) most = std::max(most, glm::length(force));
  return most;
}

// The force of a strain of 1 over the face of a cell.
double faceForce() { return kJelly.young_Pa * kSoftSpacing_m * kSoftSpacing_m; }

// A sculptor of a body.
struct Sculptor {
  SoftSurface surface;
  SoftSculpture sculpture;

  explicit Sculptor(TestBody& body) : surface(body.solid.lattice, body.solid.surface), sculpture(body.body, surface) {}

  // Displaces all surface points that are now within a radius of `middle` by `way`.
  std::vector<PlaceWay> around(const SoftBody& body, const DVec3& middle, double radius, const DVec3& way) const {
    std::vector<PlaceWay> ways;
    for (std::uint32_t i = 0; i < surface.size(); ++i)
      if (glm::distance(DVec3(surface.placeOf(body, i)), middle) < radius) ways.push_back({.place = i, .way = way});
    return ways;
  }
};

std::vector<Vec3> copyOf(std::span<const Vec3> values) { return {values.begin(), values.end()}; }

}  // namespace

TEST_CASE("a body is free of stress in its rest shape, also when rotated, shifted and rotating") {
  const DVec3 axis = glm::normalize(DVec3(1, -2, 0.5));
  for (const double angle : {0.0, 0.7, 3.0}) {
    CAPTURE(angle);
    SoftMaterial syrup = kJelly;
    syrup.viscosity_Pa_s = 20;
    TestBody body(block({5, 4, 3}), syrup);
    body.body.putRest(scattered(body.solid.lattice, 0.15f, 1));
    const DQuat turn = glm::angleAxis(angle, axis);
    for (std::size_t i = 0; i < body.body.size(); ++i) {
      const DVec3 rest = DVec3(body.solid.lattice.rest()[i]) + DVec3(body.body.rest().displacements()[i]);
      body.body.displacements()[i] = turn * rest + DVec3(0.01, 0, 0) - DVec3(body.solid.lattice.rest()[i]);
      body.body.velocities()[i] = glm::cross(3.0 * axis, turn * rest);
    }
    CHECK(largest(body.body.forces(body.team)) < 2e-5 * faceForce());
    CHECK(std::abs(body.body.strainEnergy_J()) < 1e-9 * kJelly.young_Pa * body.solid.lattice.volume_m3());
  }
}

TEST_CASE("the nodal forces of a sculpted body are the derivative of its energy, without net force or torque") {
  TestBody body(block({3, 2, 2}), kJelly);
  body.body.putRest(scattered(body.solid.lattice, 0.15f, 2));
  for (const RestPlace& more : scattered(body.solid.lattice, 0.1f, 3))
    body.body.displacements()[more.node] += more.moved;
  const std::vector<DVec3> forces = body.body.forces(body.team);
  DVec3 sum(0), torque(0);
  for (std::size_t i = 0; i < body.body.size(); ++i) {
    sum += forces[i];
    torque += glm::cross(DVec3(body.solid.lattice.rest()[i]) + DVec3(body.body.displacements()[i]), forces[i]);
  }
  CHECK(largest(forces) > 0.01 * faceForce());
  CHECK(glm::length(sum) < 1e-5 * largest(forces));
  CHECK(glm::length(torque) < 1e-5 * largest(forces) * 3 * kSoftSpacing_m);
  for (const std::size_t node : {std::size_t{0}, std::size_t{7}, std::size_t{17}, body.body.size() - 1})
    for (int axis = 0; axis < 3; ++axis) {
      constexpr float kStep = 2e-6f;
      float& at = body.body.displacements()[node][axis];
      const float before = at;
      at = before + kStep;
      const double more_J = body.body.strainEnergy_J(), up = static_cast<double>(at);
      at = before - kStep;
      const double less_J = body.body.strainEnergy_J(), way = up - static_cast<double>(at);
      at = before;
      CHECK(std::abs((more_J - less_J) / way + forces[node][axis]) < 2e-3 * largest(forces));
    }
}

TEST_CASE("a bar sculpted longer or shorter has the stiffness E A / L of its new length") {
  for (const double scale : {1.25, 0.8}) {
    CAPTURE(scale);
    SoftMaterial material = kJelly;
    material.poisson = 0.3;
    TestBody bar(block({24, 4, 4}), material, std::array{sheetAt(0)});
    bar.body.putRest(stretched(bar.solid.lattice, {scale, 1, 1}));
    bar.step_s = longestSubstep(material, kSoftSpacing_m, 0, bar.body.rest().stiffest());
    const double length = scale * 24 * kSoftSpacing_m, area = 16 * kSoftSpacing_m * kSoftSpacing_m;
    const double force = 0.002 * material.young_Pa * area;
    const auto face = nodesIn(bar.solid.lattice, sheetAt(24 * kSoftSpacing_m));
    const auto shares = faceShares(bar.solid.lattice, face);
    // The mass is unchanged.
    const double slowest = 1.571 * std::sqrt(material.young_Pa / (1000 / scale)) / length;
    bar.relax(slowest, [&](std::span<Vec3> loads) {
      for (std::size_t k = 0; k < face.size(); ++k) loads[face[k]] = Vec3(shares[k] * force, 0, 0);
    });
    double moved = 0;
    for (std::size_t k = 0; k < face.size(); ++k)
      moved += shares[k] *
               static_cast<double>(bar.body.displacements()[face[k]].x - bar.body.rest().displacements()[face[k]].x);
    CHECK(isWithin(0.02, force / moved, material.young_Pa * area / length));
  }
}

TEST_CASE("a cell sculpted larger bends like a larger cell") {
  const double h = kSoftSpacing_m, scale = 1.2;
  TestBody cell(block({1, 1, 1}), kJelly);
  cell.body.putRest(stretched(cell.solid.lattice, DVec3(scale)));
  const DVec3 middle = scale * DVec3(h / 2);
  for (std::size_t i = 0; i < 8; ++i) {
    const DVec3 arm = scale * DVec3(cell.solid.lattice.rest()[i]) - middle;
    cell.body.displacements()[i].x += static_cast<float>(arm.x * arm.y);
  }
  const double large = scale * h;
  CHECK(isWithin(0.01, cell.body.strainEnergy_J(), std::pow(large, 3) * kJelly.young_Pa * large * large / 24));
}

TEST_CASE("a stroke moves only nodes within its reach, is at rest at once, and is undone and redone bit by bit") {
  TestBody body(block({12, 8, 8}), kJelly, std::array{sheetAt(0)});
  Sculptor sculptor(body);
  const std::vector<float> masses(body.body.masses().begin(), body.body.masses().end());
  const DVec3 top = kSoftSpacing_m * DVec3(8, 8, 4), way(0, -4e-4, 1e-4);
  const double radius = 1.5 * kSoftSpacing_m;
  std::size_t moved = 0;
  for (int tick = 0; tick < 5; ++tick) moved = sculptor.sculpture.yield(sculptor.around(body.body, top, radius, way));
  CHECK(moved > 20);
  sculptor.sculpture.endStroke();
  const std::vector<Vec3> first = copyOf(body.body.rest().displacements()), there = copyOf(body.body.displacements());
  const double reach = radius + 5 * glm::length(way) + SoftSculpture::kReach_spacings * kSoftSpacing_m;
  double most = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double away = glm::distance(DVec3(body.solid.lattice.rest()[i]), top);
    if (away > reach || body.body.isPinned(i)) CHECK(first[i] == Vec3(0));
    CHECK(glm::distance(first[i], there[i]) < 1e-7f);
    most = std::max(most, static_cast<double>(-first[i].y));
  }
  CHECK(most > 0.5 * 5 * 4e-4);
  CHECK(most < 5 * 4e-4);
  // It fades with depth.
  const auto lowered = [&](double depth) {
    const DVec3 place = top - DVec3(0, depth, 0);
    const auto node = nodesIn(body.solid.lattice, {place - 1e-6, place + 1e-6}).front();
    return static_cast<double>(-first[node].y);
  };
  CHECK(lowered(0) == most);
  CHECK(lowered(kSoftSpacing_m) > 0);
  CHECK(lowered(kSoftSpacing_m) < 0.5 * most);
  CHECK(lowered(3 * kSoftSpacing_m) == 0);
  CHECK(largest(body.body.forces(body.team)) < 1e-4 * faceForce());
  CHECK(std::ranges::equal(masses, body.body.masses()));

  sculptor.sculpture.yield(sculptor.around(body.body, kSoftSpacing_m * DVec3(12, 4, 4), radius, {3e-4, 0, 0}));
  sculptor.sculpture.endStroke();
  const std::vector<Vec3> second = copyOf(body.body.rest().displacements());
  CHECK(second != first);
  sculptor.sculpture.endStroke();  // no stroke is in progress
  ShapeHistory strokes(sculptor.sculpture);
  CHECK(strokes.counts().strokes == 2);
  CHECK(strokes.undo());
  CHECK(copyOf(body.body.rest().displacements()) == first);
  CHECK(strokes.undo());
  CHECK(copyOf(body.body.rest().displacements()) == std::vector<Vec3>(first.size(), Vec3(0)));
  for (const Vec3& displacement : body.body.displacements()) CHECK(glm::length(displacement) < 1e-7f);
  CHECK(body.body.rest().stiffest() == 1);
  for (std::size_t cell = 0; cell < body.solid.lattice.cells(); ++cell) CHECK(body.body.rest().ofCell(cell) == nullptr);
  CHECK_FALSE(strokes.undo());
  CHECK(strokes.redo());
  CHECK(copyOf(body.body.rest().displacements()) == first);
  CHECK(strokes.redo());
  CHECK(copyOf(body.body.rest().displacements()) == second);
  CHECK_FALSE(strokes.redo());
  // A new stroke replaces the undone ones.
  strokes.undo();
  sculptor.sculpture.yield(sculptor.around(body.body, kSoftSpacing_m * DVec3(8, 0, 4), radius, {0, -2e-4, 0}));
  sculptor.sculpture.endStroke();
  CHECK(strokes.counts().redoCount == 0);
  CHECK(strokes.counts().undoCount == 2);
}

TEST_CASE("pinned nodes yield to no brush, and their neighbours do") {
  TestBody body(block({8, 4, 4}), kJelly, std::array{sheetAt(0)});
  Sculptor sculptor(body);
  for (int tick = 0; tick < 3; ++tick)
    sculptor.sculpture.yield(sculptor.around(body.body, kSoftSpacing_m * DVec3(1, 4, 2), 0.008, {-2e-4, -4e-4, 0}));
  sculptor.sculpture.endStroke();
  double beside = 0;
  for (std::size_t i = 0; i < body.body.size(); ++i) {
    const Vec3 rest = body.body.rest().displacements()[i];
    if (!body.body.isPinned(i)) {
      beside = std::max(beside, static_cast<double>(glm::length(rest)));
      continue;
    }
    CHECK(rest == Vec3(0));
    CHECK(body.body.displacements()[i] == Vec3(0));
  }
  CHECK(beside > 5e-4);
}

TEST_CASE("a push into a thin soft plate on the floor stops before its far side, however deep the hand is") {
  for (const int cells : {1, 2}) {
    CAPTURE(cells);
    TestBody body(block({14, cells, 14}), kJelly, std::array{PlaceBox{DVec3(-1, -1e-6, -1), DVec3(1, 1e-6, 1)}});
    Sculptor sculptor(body);
    const BrushOptions push{.yieldDepth = 0, .pushRate = 0.3, .radius = 4};
    const PlacedBrush brush = brushAt(push, 2, DVec3(7, -1, 7), DVec3(0, 1 + cells, 0));
    std::vector<Vec3> before;
    for (std::uint32_t i = 0; i < sculptor.surface.size(); ++i)
      before.push_back(sculptor.surface.placeOf(body.body, i));
    for (int tick = 0; tick < 100; ++tick) sculpt(sculptor.sculpture, brush, kSoftSpacing_m);
    double lowest = cells;
    for (std::uint32_t i = 0; i < before.size(); ++i)
      if (before[i].y > 0.999 * cells * kSoftSpacing_m)
        lowest = std::min(lowest, double{sculptor.surface.placeOf(body.body, i).y} / kSoftSpacing_m);
    CHECK(lowest < 0.7 * cells);
    CHECK(lowest > 0.1 * cells);
  }
}

TEST_CASE("a bar sculpted at its end has its stiffness unchanged elsewhere") {
  SoftMaterial material = kJelly;
  material.poisson = 0.3;
  TestBody bar(block({24, 4, 4}), material, std::array{sheetAt(0)}),
      twin(block({24, 4, 4}), material, std::array{sheetAt(0)});
  Sculptor sculptor(bar);
  for (int tick = 0; tick < 6; ++tick)
    sculptor.sculpture.yield(sculptor.around(bar.body, kSoftSpacing_m * DVec3(20, 4, 2), 0.006, {0, -3e-4, 0}));
  sculptor.sculpture.endStroke();
  // The same strain has the same effect on nodes beyond the reach of a brush.
  const float reach =
      static_cast<float>(kSoftSpacing_m * 20 - 0.006 - (SoftSculpture::kReach_spacings + 1) * kSoftSpacing_m);
  for (const RestPlace& more : scattered(bar.solid.lattice, 0.1f, 7)) {
    bar.body.displacements()[more.node] += more.moved;
    twin.body.displacements()[more.node] += more.moved;
  }
  const std::vector<DVec3> forces = bar.body.forces(bar.team), expected = twin.body.forces(twin.team);
  std::size_t others = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (bar.solid.lattice.rest()[i].x < reach)
      CHECK(glm::distance(forces[i], expected[i]) < 2e-6 * largest(expected));
    else
      others += glm::distance(forces[i], expected[i]) > 1e-4 * largest(expected) ? 1 : 0;
  }
  CHECK(others > 5);
  bar.body.reset();
  bar.step_s = longestSubstep(material, kSoftSpacing_m, 0, bar.body.rest().stiffest());
  const double length = 12 * kSoftSpacing_m, area = 16 * kSoftSpacing_m * kSoftSpacing_m;
  const double force = 0.002 * material.young_Pa * area;
  const auto face = nodesIn(bar.solid.lattice, sheetAt(24 * kSoftSpacing_m));
  const auto shares = faceShares(bar.solid.lattice, face);
  bar.relax(1.571 * std::sqrt(material.young_Pa / 1000) / (2 * length), [&](std::span<Vec3> loads) {
    for (std::size_t k = 0; k < face.size(); ++k) loads[face[k]] = Vec3(shares[k] * force, 0, 0);
  });
  const auto middle = nodesIn(bar.solid.lattice, sheetAt(length));
  double moved = 0;
  for (const std::size_t node : middle)
    moved += static_cast<double>(bar.body.displacements()[node].x) / static_cast<double>(middle.size());
  CHECK(isWithin(0.03, force / moved, material.young_Pa * area / length));
}

TEST_CASE("a rotated body yields to a brush like an unrotated one, and a strained one stays strained") {
  TestBody still(block({6, 6, 6}), kJelly), turned(block({6, 6, 6}), kJelly);
  Sculptor ofStill(still), ofTurned(turned);
  const DQuat turn = glm::angleAxis(1.3, glm::normalize(DVec3(1, 2, -1)));
  const DVec3 stretch(1.1, 0.95, 0.95);
  for (std::size_t i = 0; i < still.body.size(); ++i) {
    const DVec3 rest(still.solid.lattice.rest()[i]);
    still.body.displacements()[i] = stretch * rest - rest;
    turned.body.displacements()[i] = turn * (stretch * rest) - rest;
  }
  const double before_J = still.body.strainEnergy_J();
  const DVec3 top = stretch * (kSoftSpacing_m * DVec3(3, 6, 3)), way(2e-4, -6e-4, 0);
  for (int tick = 0; tick < 4; ++tick) {
    ofStill.sculpture.yield(ofStill.around(still.body, top, 0.009, way));
    ofTurned.sculpture.yield(ofTurned.around(turned.body, turn * top, 0.009, turn * way));
  }
  double most = 0;
  for (std::size_t i = 0; i < still.body.size(); ++i) {
    const Vec3 is = turned.body.rest().displacements()[i], expected = still.body.rest().displacements()[i];
    CHECK(glm::distance(is, expected) < 1e-6f);
    most = std::max(most, static_cast<double>(glm::length(expected)));
  }
  CHECK(most > 5e-4);
  // Without the change of the rest shape, the displacement would have added its strain energy.
  TestBody other(block({6, 6, 6}), kJelly);
  for (std::size_t i = 0; i < other.body.size(); ++i) other.body.displacements()[i] = still.body.displacements()[i];
  const double changed_J = std::abs(still.body.strainEnergy_J() - before_J);
  CHECK(changed_J < 0.2 * std::abs(other.body.strainEnergy_J() - before_J));
}

TEST_CASE("no cell is inverted by a long brush stroke, and the body still moves") {
  MatterScene scene = softBlock();
  scene.fill_mm = {30, 40, 30};
  scene.tool = {};
  SoftWorld world(scene);
  run(world, 300);
  SoftSculpture& sculpture = *world.sculpture();
  const SoftLattice& lattice = world.body().lattice();
  std::vector<PlaceWay> ways;
  const DVec3 top = 1e-3 * DVec3(scene.box_mm.x / 2, scene.fill_mm.y, scene.box_mm.z / 2);
  for (std::uint32_t i = 0; i < sculpture.surface().size(); ++i)
    if (glm::distance(DVec3(sculpture.surface().placeOf(world.body(), i)), top) < 0.012)
      ways.push_back({.place = i, .way = {0, -5e-4, 0}});
  REQUIRE(ways.size() > 20);
  for (int tick = 0; tick < 150; ++tick) {
    sculpture.yield(ways);
    world.step();
  }
  REQUIRE(world.state() == MatterState::running);
  sculpture.endStroke();
  const double stiffest = world.body().rest().stiffest();
  CHECK(stiffest > 1.5);
  CHECK(stiffest <= 4);
  CHECK(substepsOf(scene, world.plan(), stiffest) > world.plan().substeps);
  for (const SoftLattice::Corners& nodes : lattice.corners()) {
    const auto at = [&](std::size_t k) {
      return DVec3(lattice.rest()[nodes[k]]) + DVec3(world.body().rest().displacements()[nodes[k]]);
    };
    for (std::size_t k = 0; k < 8; ++k) {
      const auto edge = [&](std::size_t axis) { return ((k & axis) != 0 ? -1.0 : 1.0) * (at(k ^ axis) - at(k)); };
      CHECK(glm::dot(edge(1), glm::cross(edge(2), edge(4))) > 0.09 * std::pow(lattice.spacing_m(), 3));
    }
  }
  // The dent stays, and the body comes to rest with it.
  run(world, 1000);
  CHECK(world.observe().kinetic_J < 1e-7);
  const DVec3 missing =
      world.totals().momentum - (world.impulses().gravity - world.impulses().onWalls - world.impulses().onTools);
  CHECK(glm::length(missing) <= 1e-5 * glm::length(world.impulses().gravity));
  float deepest = 1;
  for (const std::uint32_t place : {sculpture.surface().nearest(world.body(), top - DVec3(0, 0.01, 0))})
    deepest = std::min(deepest, sculpture.surface().placeOf(world.body(), place).y);
  CHECK(static_cast<double>(deepest) < top.y - 0.004);
  // It keeps that shape after a reset.
  const std::vector<Vec3> shape = copyOf(world.body().rest().displacements());
  world.reset();
  CHECK(copyOf(world.body().rest().displacements()) == shape);
  CHECK(copyOf(world.body().displacements()) == shape);
}

}  // namespace palpate::soft_sculpt_test
