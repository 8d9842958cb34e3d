// The formulas shared by GLSL, CUDA and C++, in single and double precision, against formulas and known results written
// here: at zeros of both signs, denormals, vectors of length zero and coincident points.
#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <random>

#include "engine/core/vec.hpp"
#include "shaders/shared/frame.h"
#include "shaders/shared/look_ahead.h"
#include "shaders/shared/plane_fit.h"
#include "shaders/shared/proxy.h"
#include "shaders/shared/resample.h"
#include "shaders/shared/surface.h"
#include "tests/near.hpp"

namespace palpate::shared_formulas_test {

namespace {

template <class Real>
using V3 = glm::vec<3, Real>;

// A thousand roundings.
template <class Real>
constexpr double kRounding = 1e3 * static_cast<double>(std::numeric_limits<Real>::epsilon());
template <class Real>
constexpr Real kDenormal = std::numeric_limits<Real>::denorm_min();

template <class Real>
double off(const V3<Real>& is, const DVec3& shouldBe) {
  return glm::length(DVec3(is) - shouldBe);
}

std::vector<DVec3> directions(std::size_t count) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<DVec3> all;
  // Braces, since the evaluation order of a call's arguments is unspecified.
  while (all.size() < count) all.push_back(glm::normalize(DVec3{normal(random), normal(random), normal(random)}));
  return all;
}

// Adds one neighbour, as the callers that sum do.
template <class Real>
void add(shared::SurfaceSumsOf<Real>& sums, const DVec3& offset, const DVec3& normal) {
  const V3<Real> d(offset), n(normal);
  const Real w = shared::wendland(glm::length(d));
  sums.offsets += w * glm::vec<4, Real>(d, 1);
  sums.normals += glm::vec<4, Real>(w * n, 1);
  sums.products += w * glm::vec<2, Real>(glm::dot(d, d), glm::dot(d, n));
}

template <class Real>
void become(shared::BrushOf<Real>& brush, BrushKind kind) {
  brush.kind = static_cast<shared::uint>(kind);
  brush.traits = traitsOf(kind).traits;
}

}  // namespace

TEST_CASE_TEMPLATE("surface weights fall from one to zero, and are reduced for points of the other face", Real, float,
                   double) {
  for (const double r : {-0.0, 0.0, static_cast<double>(kDenormal<Real>), 1e-3, 0.25, 0.5, 0.75, 1.0}) {
    const double truth = std::pow(1 - r, 4) * (4 * r + 1);
    CHECK(std::abs(static_cast<double>(shared::wendland(static_cast<Real>(r))) - truth) < kRounding<Real>);
  }
  const std::array<std::pair<double, double>, 6> facing{{{1, 1}, {0, 1}, {-0.0, 1}, {-0.25, 0.5}, {-0.5, 0}, {-1, 0}}};
  for (const auto& [cosine, weight] : facing)
    CHECK(static_cast<double>(shared::facingWeight(static_cast<Real>(cosine))) == weight);
}

TEST_CASE_TEMPLATE("a frame around a normal is right-handed and of unit vectors, for a zero of either sign", Real,
                   float, double) {
  std::vector<DVec3> normals = directions(1000);
  for (const double z : {0.0, -0.0, static_cast<double>(kDenormal<Real>), -static_cast<double>(kDenormal<Real>)})
    for (const DVec3& n : {DVec3(1, 0, z), DVec3(-1, 0, z), DVec3(0, 1, z), DVec3(0.6, -0.8, z)}) normals.push_back(n);
  for (const DVec3& n : {DVec3(0, 0, 1), DVec3(0, 0, -1), DVec3(-0.0, -0.0, -1)}) normals.push_back(n);
  for (const DVec3& n : normals) {
    V3<Real> u, v;
    shared::frameAround(V3<Real>(n), u, v);
    CAPTURE(n.z);
    CHECK(off(u, DVec3(u) / glm::length(DVec3(u))) < kRounding<Real>);
    CHECK(off(v, DVec3(v) / glm::length(DVec3(v))) < kRounding<Real>);
    CHECK(off(V3<Real>(glm::cross(DVec3(u), DVec3(v))), n) < kRounding<Real>);
    // The frame flips with the sign of z, of -0 too: then v.y is near -1 for a normal along x.
    if (n.y == 0 && std::abs(n.x) == 1) CHECK(static_cast<double>(v.y) == (std::signbit(n.z) ? -1 : 1));
    const Frame3 frame = frameAround(n);
    CHECK(off(u, frame.u) < kRounding<Real>);
    CHECK(off(v, frame.v) < kRounding<Real>);
  }
}

TEST_CASE_TEMPLATE("the spacing is derived from the weights on an even plane", Real, float, double) {
  Real weights = 0;
  constexpr int kReach = 12;
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x <= kReach; ++x)
      if (const Real r = glm::length(glm::vec<2, Real>(x, y)) / kReach; r < 1) weights += shared::wendland(r);
  CHECK(static_cast<double>(shared::spacingFrom(Real(0.5) * kReach, weights)) == near(0.5, 2e-3));
  // The support radius is a number of spacings, within its bounds; without any weight it is the largest.
  CHECK(static_cast<double>(shared::localRadius(Real(kReach), weights, Real(1), Real(20))) == near(4, 2e-3));
  CHECK(shared::localRadius(Real(kReach), weights, Real(5), Real(20)) == 5);
  for (const Real none : {Real(0), Real(-0.0), kDenormal<Real>})
    CHECK(shared::localRadius(Real(2), none, Real(1), Real(2)) == 2);
}

TEST_CASE_TEMPLATE("a sphere surface passes through its points, and an average surface through their mean", Real, float,
                   double) {
  const double radius = 2.5, rho = 10;  // of the support and of the sphere
  for (const double height : {-0.5, 0.0, 0.25}) {
    shared::SurfaceSumsOf<Real> sums{};
    double weights = 0;
    DVec3 mean(0);
    for (const DVec3& n : directions(50'000)) {
      const DVec3 d = (rho * n - DVec3(0, 0, rho + height)) / radius;
      if (glm::length(d) >= 1) continue;
      add<Real>(sums, d, n);
      const double w = std::pow(1 - glm::length(d), 4) * (4 * glm::length(d) + 1);
      weights += w;
      mean += w * d;
    }
    const auto sphere = shared::surfaceFrom(sums, static_cast<Real>(radius), shared::kSurfaceSphere);
    REQUIRE(sphere.defined);
    // The minimum spread in the formula flattens the sphere a little.
    CHECK(std::abs(static_cast<double>(sphere.distance) - height) < 1e-4 + kRounding<Real>);
    // It also tilts the sphere, in proportion to the offset of the points to one side.
    CHECK(off(sphere.normal, DVec3(0, 0, 1)) < 1e-5 + 20 * kRounding<Real>);
    const auto average = shared::surfaceFrom(sums, static_cast<Real>(radius), shared::kSurfaceAverage);
    REQUIRE(average.defined);
    const double truth = -radius * glm::dot(DVec3(average.normal), mean / weights);
    CHECK(std::abs(static_cast<double>(average.distance) - truth) < 20 * kRounding<Real>);
  }
}

TEST_CASE_TEMPLATE("coincident points give a plane; too few points, or cancelling normals, give no surface", Real,
                   float, double) {
  const auto kinds = {shared::kSurfaceAverage, shared::kSurfaceSphere, shared::kSurfaceSharp};
  for (const shared::uint kind : kinds) {
    for (const DVec3& d : {DVec3(0), DVec3(-0.0), DVec3(0, 0, -0.25), DVec3(static_cast<double>(kDenormal<Real>))}) {
      shared::SurfaceSumsOf<Real> sums{};
      CHECK_FALSE(shared::surfaceFrom(sums, Real(2), kind).defined);
      for (int i = 0; i < 5; ++i) {
        const auto surface = shared::surfaceFrom(sums, Real(2), kind);
        CHECK(surface.defined == (i >= 3));
        CHECK(surface.neighbours == static_cast<shared::uint>(i));
        CHECK(std::abs(static_cast<double>(surface.distance) - (i < 3 ? 0 : -2 * d.z)) < kRounding<Real>);
        CHECK(off(surface.normal, DVec3(0, 0, i < 3 ? 0 : 1)) < kRounding<Real>);
        add<Real>(sums, d, {0, 0, 1});
      }
    }
    shared::SurfaceSumsOf<Real> opposed{};
    for (const double z : {1, -1, 1, -1}) add<Real>(opposed, DVec3(0.1, 0, 0), {0, 0, z});
    CHECK_FALSE(shared::surfaceFrom(opposed, Real(2), kind).defined);
    // A surface ends past its last points.
    shared::SurfaceSumsOf<Real> aside{};
    for (int i = 0; i < 4; ++i) add<Real>(aside, DVec3(0.6, 0, 0), {0, 0, 1});
    CHECK_FALSE(shared::surfaceFrom(aside, Real(2), kind).defined);
  }
}

TEST_CASE_TEMPLATE("sharp weights drop across an edge, and a radius shrinks where normals disagree", Real, float,
                   double) {
  const V3<Real> up(0, 0, 1), d(Real(0.25), 0, Real(-0.125));
  CHECK(shared::robustWeight(up, Real(0.125), d, up) == 1);
  const double turn = 2 / 0.25, height = (-0.25 - 0.125) / 0.5;  // squared for the angle of the normals
  CHECK(std::abs(static_cast<double>(shared::robustWeight(up, Real(0.125), d, V3<Real>(1, 0, 0))) -
                 std::exp(-turn - height * height)) < kRounding<Real>);
  CHECK(shared::turnWeight(shared::kSurfaceSphere, Real(-0.25)) == Real(0.5));
  CHECK(shared::turnWeight(shared::kSurfaceSharp, Real(0.25)) == 0);
  CHECK(shared::turnWeight(shared::kSurfaceSharp, Real(0.5)) == 1);
  CHECK(shared::wideWhereFlat(Real(1), Real(2), Real(1)) == 2);
  CHECK(shared::wideWhereFlat(Real(1), Real(2), Real(0)) == 1);
}

TEST_CASE("a HIP crosses a surface only from the face that it came from, and remembers that face") {
  using namespace shared;
  CHECK(crosses(kFaceOutside, false));
  CHECK(crosses(kFaceBehind, true));
  for (const uint face : {kFaceUnknown, kFaceInside}) CHECK_FALSE((crosses(face, true) || crosses(face, false)));
  CHECK_FALSE(crosses(kFaceOutside, true));
  CHECK_FALSE(crosses(kFaceBehind, false));
  for (const bool traced : {false, true}) {
    for (const uint face : {kFaceUnknown, kFaceOutside, kFaceInside, kFaceBehind}) {
      CHECK(faceAfter(face, true, false, true, traced) == kFaceOutside);
      CHECK(faceAfter(face, false, false, false, traced) == (face == kFaceInside ? kFaceInside : kFaceUnknown));
      CHECK(faceAfter(face, false, true, false, traced) == kFaceUnknown);  // past the rim of a sheet
    }
    CHECK(faceAfter(kFaceUnknown, true, false, false, traced) == (traced ? kFaceBehind : kFaceInside));
    CHECK(faceAfter(kFaceInside, true, false, false, traced) == kFaceInside);
    CHECK(faceAfter(kFaceBehind, true, false, false, traced) == kFaceBehind);
  }
}

TEST_CASE_TEMPLATE("a proxy slides as far as friction allows, and a step that reverses is halved", Real, float,
                   double) {
  const Real endless = std::numeric_limits<Real>::infinity();
  const std::array<std::pair<Real, shared::uint>, 8> ways{{{Real(0), 1u},
                                                           {Real(-0.0), 1u},
                                                           {kDenormal<Real>, 1u},
                                                           {Real(1), 1u},
                                                           {Real(1.5), 2u},
                                                           {Real(16), 16u},
                                                           {Real(17), 16u},
                                                           {endless, 16u}}};
  for (const auto& [way, steps] : ways) CHECK(shared::substepsOn(way) == steps);

  const V3<Real> none(0), up(0, 0, 1);
  for (const bool sticking : {false, true}) {
    CHECK(shared::againstFriction(none, Real(0), Real(0), sticking) == none);
    CHECK(shared::againstFriction(none, Real(-1), Real(0.5), sticking) == none);
    CHECK(shared::slideAlong(up, none, Real(0.5), sticking) == none);
    // Depth 2: a coefficient of 0.5 holds a slide of 1, and of 1.25 while sticking.
    const V3<Real> slid = shared::slideAlong(up, V3<Real>(Real(-1.125), 0, 2), Real(0.5), sticking);
    CHECK(off(slid, DVec3(sticking ? 0 : 0.125, 0, 0)) < kRounding<Real>);
  }
  CHECK(shared::shortened(none, Real(1)) == none);
  CHECK(shared::shortened(V3<Real>(kDenormal<Real>, 0, 0), Real(1)).x == kDenormal<Real>);
  CHECK(off(shared::shortened(V3<Real>(0, -3, 4), Real(1)), DVec3(0, -0.6, 0.8)) < kRounding<Real>);

  auto tracking = shared::trackingFrom(V3<Real>(1, 0, 0), true, Real(0.5));
  CHECK(tracking.slid);
  CHECK_FALSE(tracking.sticking);
  const auto step = shared::nextStep(tracking, V3<Real>(2, 0, 1), up, Real(0.25), Real(0));
  CHECK(off(step.lift, DVec3(0, 0, -0.25)) == 0);
  CHECK(off(step.slide, DVec3(-2, 0, 0)) == 0);
  CHECK(step.size == 2);
  CHECK(off(shared::takeStep(tracking, step, Real(10)), DVec3(-1, 0, -0.25)) < kRounding<Real>);
  CHECK(tracking.relaxation == Real(0.5));
  CHECK_FALSE(shared::trackingFrom(none, false, Real(0.5)).slid);
}

TEST_CASE_TEMPLATE("a point stops a spacing before what stays behind, and goes on along what moves with it", Real,
                   float, double) {
  shared::BrushOf<Real> brush{.falloff = 3, .radius = 4, .longestMove = 1, .support = 4};
  become(brush, BrushKind::push);
  const V3<Real> up(0, 0, 1), aside(1, 0, 0), origin(0, 0, 0);
  shared::BrushToolOf<Real> tool{.center = V3<Real>(0, 0, 3), .acts = 1, .outward = up, .share = 1, .height = 1};
  // From the origin, found there with `found`, until a point at `offset`; 2 if nothing is in the way.
  const auto free = [&](const V3<Real>& found, const V3<Real>& offset, const V3<Real>& normal, bool moves = true) {
    const auto path = shared::pathOf(brush, tool, origin, {origin, found, Real(shared::kUnseen)}, Real(0.25));
    return shared::freeUntil(brush, tool, path, {offset, normal, moves}, Real(2));
  };
  const auto is = [](Real value, double truth) { return std::abs(static_cast<double>(value) - truth) < 1e-6; };
  const V3<Real> below(Real(0.2), 0, -1);
  CHECK(is(free(up, below, -up), 0.75));                          // the far side of a plate
  CHECK(is(free(up, V3<Real>(Real(0.6), 0, -1), -up), 2));        // too far aside
  CHECK(is(free(up, -below, -up), 2));                            // behind
  CHECK(is(free(up, V3<Real>(0, 0, Real(-0.2)), -up), 0));        // nearer than a spacing
  CHECK(is(free(up, below, aside), 2));                           // the wall of a dent
  CHECK(is(free(up, below, up), 2));                              // the same sheet
  CHECK(is(free(up, below, up, false), 0.75));                    // another one, which the brush does not move
  CHECK(is(free(up, V3<Real>(0, 0, Real(-0.4)), up, false), 2));  // its own, at the border of the brush
  // A rim goes down to the far side, and not past it.
  CHECK(is(free(V3<Real>(Real(0.6), 0, Real(-0.8)), V3<Real>(0, 0, Real(-0.5)), -up), 0.5));
  // The far side of a part at a right angle to the axis, whose near side the tool is in front of, stays.
  const V3<Real> beside(Real(-0.5), 0, 0);
  tool.center = V3<Real>(-3, 0, 2);
  CHECK(is(free(aside, beside, -aside), 0));
  CHECK(is(free(aside, beside, aside), 2));
  tool.center = V3<Real>(3, 0, 2);
  CHECK(free(aside, V3<Real>(Real(-0.3), 0, Real(-0.1)), -aside) < Real(0.2));  // the tool is in front: it is pressed
  // Two sides that are inflated meet half way; what is smoothed comes alone.
  become(brush, BrushKind::inflate);
  CHECK(is(free(up, V3<Real>(0, 0, 1), -up), 0.375));
  become(brush, BrushKind::smooth);
  CHECK(is(free(up, below, -up), 0.75));
  // Grab carries along what it holds.
  become(brush, BrushKind::grab);
  tool.motion = V3<Real>(0, 0, -3);
  CHECK(is(free(up, below, -up), 2));
  CHECK(is(free(up, below, -up, false), 0.75));
  // Beside a blocked point that lies a unit aside, and was found there: a quarter of their distance and of a spacing.
  const auto besideBlocked = [&](const V3<Real>& itsBack, const V3<Real>& itsNormal, double gone = 0) {
    become(brush, BrushKind::push);
    const V3<Real> place(0, 0, Real(-gone)), offset = V3<Real>(1, 0, 0) - itsBack - place;
    const auto path = shared::pathOf(brush, tool, place, {origin, up, Real(shared::kUnseen)}, Real(0.25));
    return shared::freeBeside(brush, path, offset, itsBack, itsNormal, Real(2));
  };
  tool.center = V3<Real>(0, 0, 3);
  CHECK(is(besideBlocked(origin, up), 0.3125));
  CHECK(is(besideBlocked(origin, up, 0.2), 0.1125));
  CHECK(is(besideBlocked(origin, up, 0.5), 0));
  CHECK(is(besideBlocked(V3<Real>(0, 0, 1), up), 1.3125));  // it has gone a unit itself
  CHECK(is(besideBlocked(origin, -up), 2));                 // another side
  // What overhangs the hand is not pressed; what rises to it is.
  const auto presses = [&](const V3<Real>& normal, double height) {
    become(brush, BrushKind::push);
    const V3<Real> place(1, 0, Real(height));
    return shared::brushed(brush, tool, place, normal, {place, normal, Real(shared::kUnseen)}).position != place;
  };
  const V3<Real> slanting(Real(-0.8), 0, Real(-0.6));
  CHECK_FALSE(presses(slanting, 2));
  CHECK(presses(slanting, -0.5));
  CHECK(presses(aside, 2));
  CHECK(presses(up, 2));
  // No step is longer than what is free.
  const auto step = [&](Real room) { return shared::afterStep(brush, origin, {origin, up, room}, V3<Real>(0, 0, -3)); };
  CHECK(is(step(Real(0.3)).z, -0.3));
  CHECK(is(step(Real(shared::kUnseen)).z, -1));
  CHECK(step(Real(-1e-6)) == origin);
  // It is blocked if hardly any of it is, as far as a point may go in one edit.
  const auto blocks = [&](double room, double way) {
    const shared::FoundPointOf<Real> point{origin, up, Real(room)};
    return shared::mayBlock(brush, point) && shared::isBlocked(brush, origin, point, V3<Real>(0, 0, Real(-way)));
  };
  CHECK(blocks(0, 0.5));
  CHECK(blocks(-1e-6, 0.001));
  CHECK_FALSE(blocks(0, 0.0003));
  CHECK(blocks(0.03, 1));
  CHECK_FALSE(blocks(0.03, 0.9));
  CHECK_FALSE(blocks(double{shared::kFirstStep} * 4, 1));
}

TEST_CASE_TEMPLATE("each brush moves or removes points by its tool, also at the tool's centre", Real, float, double) {
  shared::BrushOf<Real> brush{.falloff = 3, .radius = 4, .longestMove = 100, .support = 1};
  become(brush, BrushKind::push);
  const V3<Real> up(0, 0, 1);
  shared::BrushToolOf<Real> tool{.center = V3<Real>(1, 2, 7.5), .acts = 1, .outward = up, .share = 1};
  const auto positionOf = [&](const V3<Real>& place) {
    return shared::brushed(brush, tool, place, up, {place, up, Real(shared::kUnseen)}).position;
  };
  // The whole displacement at once: every point in the ball comes to rest on its underside, straight below its
  // position.
  for (const DVec3& direction : directions(100)) {
    const DVec3 offset = 2.5 * direction;
    const DVec3 wall(offset.x, offset.y, -std::sqrt(16 - offset.x * offset.x - offset.y * offset.y));
    CHECK(off(positionOf(V3<Real>(DVec3(tool.center) + offset)), DVec3(tool.center) + wall) < 10 * kRounding<Real>);
  }
  for (const V3<Real>& middle : {tool.center, tool.center + V3<Real>(kDenormal<Real>)})
    CHECK(off(positionOf(middle), DVec3(tool.center) - DVec3(0, 0, 4)) < 10 * kRounding<Real>);
  // On the shaft too, but not beyond its end.
  tool.shaft = 6;
  CHECK(off(positionOf(tool.center + V3<Real>(0, 0, 5)), DVec3(tool.center) - DVec3(0, 0, 4)) < 10 * kRounding<Real>);
  const V3<Real> over = tool.center + V3<Real>(0, 0, 7);
  CHECK(positionOf(over) == over);
  for (const double distance : {0.0, 1.0, 3.9, 4.0, 5.0}) {
    const double truth = distance < 4 ? std::pow(1 - distance * distance / 16, 3) : 0;
    CHECK(std::abs(static_cast<double>(shared::brushWeight(brush, static_cast<Real>(distance))) - truth) <
          kRounding<Real>);
  }
  become(brush, BrushKind::carve);
  const auto taken = [&](const V3<Real>& place, const V3<Real>& normal) {
    return shared::brushed(brush, tool, place, normal, {place, normal, Real(shared::kUnseen)}).taken == 1;
  };
  const V3<Real> aside(1, 0, 0);
  CHECK(taken(tool.center + aside, aside));   // faces away from the middle
  CHECK(taken(tool.center + aside, -aside));  // deeper than two support radii
  CHECK_FALSE(taken(tool.center + Real(3) * aside, -aside));
  CHECK_FALSE(taken(tool.center + Real(3) * aside + Real(5) * up, -aside));  // of the shaft
  tool.shaft = 0;
  CHECK_FALSE(taken(tool.center + Real(5) * up, up));
}

TEST_CASE_TEMPLATE("the surface normal and height over a hand are measured to a few thousandths", Real, float, double) {
  const shared::BrushOf<Real> brush{.kind = shared::kBrushPush, .radius = 4, .longestMove = 1, .support = 1};
  const DVec3 outward = glm::normalize(DVec3(1, 2, 3));
  const shared::BrushToolOf<Real> tool{
      .acts = 1, .outward = V3<Real>(outward), .share = 1, .hand = V3<Real>(7, 8, 9), .hearing = 5};
  // A plane tilted against the tool, a quarter of its radius above the hand.
  const DVec3 normal = glm::normalize(outward + DVec3(0.1, -0.2, 0));
  const Frame3 frame = frameAround(normal);
  double weights = 0, heights = 0;
  DVec3 normals(0);
  for (double u = -6; u < 6; u += 0.1)
    for (double v = -6; v < 6; v += 0.1) {
      const DVec3 place = DVec3(tool.hand) + 1.0 * normal + u * frame.u + v * frame.v;
      const auto point = shared::measured(brush, tool, {V3<Real>(place), V3<Real>(normal)});
      weights += point.weight;
      heights += point.height;
      normals += DVec3(point.normal);
      CHECK(shared::measured(brush, tool, {V3<Real>(place), V3<Real>(-normal)}).weight == 0);
    }
  CHECK(weights > 0);
  CHECK(off(V3<double>(normals / (weights * 511)), normal) < 5e-3);
  CHECK(heights / (weights * 255) * 4 == within(glm::dot(normal, outward), 0.02));
  // Points below the hand, and points too far away, do not count.
  CHECK(shared::measured(brush, tool, {V3<Real>(DVec3(tool.hand) - outward), V3<Real>(outward)}).weight == 0);
  CHECK(shared::measured(brush, tool, {V3<Real>(DVec3(tool.hand) + 5.0 * outward), V3<Real>(outward)}).weight == 0);
}

TEST_CASE_TEMPLATE("the midpoint between two points of a circle lies on it; between coincident points it is that point",
                   Real, float, double) {
  for (const double angle : {0.05, 0.2, 0.4}) {
    const DVec3 here(0, 0, 1), there(std::sin(angle), 0, std::cos(angle));
    const V3<Real> middle = shared::halfWay(V3<Real>(there - here), V3<Real>(here), V3<Real>(there));
    CHECK(std::abs(glm::length(DVec3(middle) + here) - 1) < 0.025 * std::pow(angle, 4) + kRounding<Real>);
  }
  CHECK(shared::halfWay(V3<Real>(0), V3<Real>(0, 0, 1), V3<Real>(1, 0, 0)) == V3<Real>(0));
}

TEST_CASE_TEMPLATE("the plane of points has their direction of least spread as normal, if there is one", Real, float,
                   double) {
  for (const DVec3& n : directions(100)) {
    const Frame3 frame = frameAround(n);
    shared::MomentsOf<Real> plane{}, line{}, place{};
    for (const auto& [u, v] : {std::pair(0.5, 0.1), {-0.4, 0.3}, {0.1, -0.6}, {-0.3, -0.2}, {0.2, 0.45}}) {
      shared::addNeighbour(plane, V3<Real>(u * frame.u + v * frame.v), Real(0.5));
      shared::addNeighbour(line, V3<Real>(u, 0, 0), Real(0.5));
      shared::addNeighbour(place, V3<Real>(0), Real(0.5));
    }
    const DVec3 found(shared::planeNormal(plane));
    CHECK(std::abs(std::abs(glm::dot(found, n)) - 1) < kRounding<Real>);
    CHECK(shared::planeNormal(line) == V3<Real>(0));
    CHECK(shared::planeNormal(place) == V3<Real>(0));
    CHECK(shared::planeNormal(shared::MomentsOf<Real>{}) == V3<Real>(0));
    CHECK(std::abs(glm::dot(DVec3(shared::besides(V3<Real>(n))), n)) < kRounding<Real>);
  }
}

}  // namespace palpate::shared_formulas_test
