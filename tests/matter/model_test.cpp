// A closed, fixed cloud in water or sand.
#include <cmath>
#include <cstring>
#include <numbers>

#include "engine/cloud/analytic_shape.hpp"
#include "tests/error_of.hpp"
#include "tests/labels.hpp"
#include "tests/matter/matter_scenes.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::model_test {

namespace {

// A sphere with about ten times denser points on one side, with normals, in its own unit.
PointCloud unevenSphere() {
  PointCloud cloud = sampleShape(*makeShape("sphere", 2), {.count = 12000});
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.positions[i].x > 0.2f && i % 11 != 0) continue;
    cloud.positions[kept] = cloud.positions[i];
    cloud.normals[kept++] = cloud.normals[i];
  }
  cloud.positions.resize(kept);
  cloud.normals.resize(kept);
  return cloud;
}

PointCloud withoutCap(double height) {
  PointCloud cloud = sampleShape(*makeShape("sphere", 2), {.count = 20000});
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.positions[i].y > static_cast<float>(height)) continue;
    cloud.positions[kept] = cloud.positions[i];
    cloud.normals[kept++] = cloud.normals[i];
  }
  cloud.positions.resize(kept);
  cloud.normals.resize(kept);
  return cloud;
}

MatterMaker withModel(std::shared_ptr<const MatterModel> model) {
  return [model](const MatterScene& scene, std::size_t tools, std::vector<Vec3> places) {
    return std::make_unique<MatterWorld>(scene, MatterOptions{.threads = 2, .tools = tools, .model = model},
                                         std::move(places));
  };
}

std::string refusalOf(PointCloud cloud, const MatterScene& scene) {
  return errorOf([&] { const MatterModel model(std::move(cloud), scene, 2); });
}

}  // namespace

TEST_CASE("no water enters an uneven scan, compared with its true shape") {
  const MatterScene scene = modelInTank("sphere", 80);
  const auto model = std::make_shared<const MatterModel>(unevenSphere(), scene, 2);
  CHECK(isWithin(0.02, model->volume_m3(), 4 * 3.14159265 / 3 * std::pow(0.04, 3)));
  const auto world = withModel(model)(scene, 0, placesAtRest(scene));
  const DVec3 middle = DVec3(0.07, 0.06, 0.07);
  REQUIRE(withinBall(*world, middle, 0.04) == 0);
  for (int k = 0; k < 30; ++k) {
    run(*world, 10);
    REQUIRE(withinBall(*world, middle, 0.04) == 0);
  }
  checkModelKeepsOut(withModel(model), scene, 300);
}

TEST_CASE("no grain enters a model, and a heap on it comes to rest" * kMoreInFull) {
  const MatterScene scene = modelInTank("sphere", 70, Matter::sand);
  checkModelKeepsOut(onCpu(), scene, byTier(200, 300));
  const auto world = atRest(onCpu(), scene);
  run(*world, byTier(500, 1500));
  CHECK(world->insideModel() == 0);
  CHECK(world->totals().kinetic_J < 1e-5);
}

TEST_CASE("the field of a model gives the distance to its surface and its share of the volume around a position") {
  const MatterScene scene = modelInTank("sphere", 80);
  const MatterModel model(builtInModel(scene, 2), scene, 2);
  const auto at = [&](double x) { return model.at(Vec3(0.07 + x, 0.06, 0.07)); };
  for (const double far_m : {0.0, 0.003, 0.008, -0.004, -0.009}) {
    CAPTURE(far_m);
    const shared::ModelAt here = at(0.04 + far_m);
    CHECK(std::abs(static_cast<double>(here.distance) - far_m) < 1.2e-3);  // an eighth of a spacing
    CHECK(here.outwards.x > 0.99f);
    CHECK(here.slope.x > 0);
    const double step = 1e-5;
    const double slope =
        static_cast<double>(at(0.04 + far_m - step).share - at(0.04 + far_m + step).share) / (2 * step);
    CHECK(isWithin(0.02, here.slope.x, slope));
  }
  CHECK(at(0.04).share > 0.4f);
  CHECK(at(0.04).share < 0.5f);  // less for a ball than for a plane
  CHECK(at(0.0).share == near(1, 1e-6));
  CHECK(at(0.0401 + 0.02).share < 1e-3f);
  CHECK(at(0.5).share == 0);
  CHECK(at(0.5).distance > 1);
  CHECK(model.at(Vec3(std::nanf(""))).share == 0);
}

TEST_CASE("a model, and the water around it, do not depend on the number of threads") {
  const MatterScene scene = modelInTank("torus", 80);
  const MatterModel one(builtInModel(scene, 1), scene, 1), three(builtInModel(scene, 3), scene, 3);
  REQUIRE(one.nodes().size() == three.nodes().size());
  CHECK(std::memcmp(one.nodes().data(), three.nodes().data(), one.nodes().size_bytes()) == 0);
  const auto a = atRest(onCpu(1), scene), b = atRest(onCpu(3), scene);
  run(*a, 30);
  run(*b, 30);
  CHECK(sameBytes(*a, *b));
  CHECK(a->onModel().force_N == b->onModel().force_N);
  a->reset();
  CHECK(a->impulses().onModel == DVec3(0));
  CHECK(a->onModel().force_N == DVec3(0));
  run(*a, 30);
  CHECK(sameBytes(*a, *b));
}

TEST_CASE("water far from a model moves as it does without one") {
  MatterScene scene = tank({14, 30, 14}, 8);
  const auto without = atRest(onCpu(), scene);
  scene.model = "builtin:sphere";
  scene.model_mm = DVec3(60);
  scene.model_at_mm = DVec3(70, 200, 70);
  const auto with = atRest(onCpu(), scene);
  CHECK(with->leftOut() == 0);
  run(*without, 50);
  run(*with, 50);
  CHECK(sameBytes(*with, *without));
  CHECK(with->impulses().onModel == DVec3(0));
}

TEST_CASE("an open model is refused with the position and width of its hole, and a small hole is closed") {
  const MatterScene scene = modelInTank("sphere", 80);
  const std::string open = refusalOf(withoutCap(0.5), scene);
  CHECK(says(open, "model: is not closed: there is a hole about"));
  CHECK(says(open, "mm wide at"));
  CHECK(refusalOf(withoutCap(0.99), scene).empty());
  MatterScene strict = scene;
  strict.hole_mm = 5;
  CHECK(says(refusalOf(withoutCap(0.97), strict), "model: is not closed"));
  CHECK(says(refusalOf(sampleShape(*makeShape("sphere", 2), {.count = 50}), scene), "model: has 50 points"));
  PointCloud turned = withoutCap(2);
  for (Vec3& normal : turned.normals) normal = -normal;
  CHECK(says(refusalOf(std::move(turned), scene), "model: its normals point inwards"));
}

TEST_CASE("a model that cannot stand there is refused with the field's name before the start") {
  const auto with = [](auto change) {
    MatterScene scene = modelInTank("sphere", 80);
    change(scene);
    return refusal(scene);
  };
  CHECK(with([](MatterScene&) {}).empty());
  CHECK(with([](MatterScene& s) { s.model_mm = DVec3(0), s.model_at_mm = {}; }).empty());
  CHECK(says(with([](MatterScene& s) { s.model_mm = DVec3(-1, 80, 80); }), "model_mm: is -1;"));
  CHECK(says(with([](MatterScene& s) { s.model_mm = DVec3(30); }), "model_mm: is 30 on its longest side"));
  CHECK(says(with([](MatterScene& s) { s.model_mm = DVec3(80, 80, 141); }), "model_mm: is 141 along z;"));
  CHECK(says(with([](MatterScene& s) { s.model_mm.x = std::nan(""); }), "model_mm: is nan;"));
  CHECK(says(with([](MatterScene& s) { s.model_at_mm = DVec3(70, 110, 70); }), "model_at_mm: puts the model from 110"));
  CHECK(says(with([](MatterScene& s) { s.model_at_mm = DVec3(20, 0, 70); }), "model_at_mm: puts the model from -20"));
  CHECK(says(with([](MatterScene& s) { s.model_at_mm = DVec3(std::nan("")); }), "model_at_mm: puts the model"));
  CHECK(says(with([](MatterScene& s) { s.hole_mm = -1; }), "hole_mm: is -1;"));
  CHECK(says(with([](MatterScene& s) { s.model.clear(); }), "model: is missing"));
  MatterScene large = modelInTank("sphere", 80);
  large.box_mm = DVec3(3000), large.model_mm = DVec3(3000), large.model_at_mm = {};
  CHECK(says(refusal(large, 1 << 28), "spacing_mm:"));
  MatterScene file = modelInTank("sphere", 80);
  file.model = "scan.ply";
  CHECK_THROWS_WITH(MatterWorld(file, {.threads = 1}), "model: scan.ply is a file that was not read");
  file.model = "builtin:lava";
  CHECK_THROWS(MatterWorld(file, {.threads = 1}));
}

TEST_CASE("a ball that starts in water or sand grows there and pushes the particles out" * kMoreInFull) {
  for (const Matter matter : {Matter::water, Matter::sand}) {
    const int steps = matter == Matter::water ? byTier(500, 600) : byTier(250, 600);
    MatterScene scene = tank({12, 18, 12}, 12);
    scene.matter = matter;
    const double radius_m = 0.03;
    scene.tool = {.radius_mm = radius_m * 1e3, .mass_kg = 4 * std::numbers::pi / 3 * 1000 * std::pow(radius_m, 3)};
    const HandPose hand{.place_m = {0.055, 0.055, 0.065}};  // a particle starts at its centre
    const auto world = atRest(onCpu(), scene, 1);
    const std::size_t within = withinBall(*world, hand.place_m, radius_m + 0.25 * 0.01);
    REQUIRE(within > 100);
    double most_J = 0, mostForce_N = 0;
    for (int k = 0; k < steps; ++k) {
      world->step({&hand, 1});
      REQUIRE(world->state() == MatterState::running);
      most_J = std::max(most_J, world->totals().kinetic_J);
      mostForce_N = std::max(mostForce_N, glm::length(world->answers()[0].force_N));
    }
    CHECK(world->pushedOut(0) == within);
    CHECK(world->particles() == 12 * 12 * 12);
    // No water is left inside; grains, which hold each other, may be inside by up to half of their size.
    CHECK(withinBall(*world, world->answers()[0].place_m, radius_m - (matter == Matter::sand ? 0.005 : 0)) == 0);
    CHECK(missingMomentum(*world) <= 1e-5);
    CHECK(world->portEnergy_J(0) >= -1e-3);
    if (matter == Matter::sand) continue;
    CHECK(most_J < 0.1);  // of the 17 J of the ball at the speed of sound
    const double expected = scene.tool.mass_kg * kGravity_m_s2;
    CHECK(mostForce_N < 3 * expected);
    CHECK(isWithin(0.1, world->answers()[0].reaction_N.y, expected));
  }
}

}  // namespace palpate::model_test
