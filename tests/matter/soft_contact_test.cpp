// Balls and walls that press on soft bodies: Hertz, and the stiffness of the floor.
#include <cmath>

#include "engine/matter/soft_contact.hpp"
#include "tests/labels.hpp"
#include "tests/matter/soft_bodies.hpp"

namespace palpate::soft_contact_test {

namespace {

// A ball held above a block and pressed into it to a given depth; its force after everything is at rest.
struct Indentation {
  TestBody body;
  SoftContact contact;
  double ball_m, top_m, middle_m;

  Indentation(double poisson, int width, int depth, double ball_spacings)
      : body(boxSolid(DVec3(0), DVec3(width, depth, width) * kSoftSpacing_m, kSoftSpacing_m),
             {.young_Pa = 5e4, .poisson = poisson, .density_kg_m3 = 1000},
             std::array{PlaceBox{DVec3(-1), DVec3(1, 1e-6, 1)}}),
        contact(body.body, body.solid.surface,
                {.box_m = DVec3(10),
                 .ball_m = ball_spacings * kSoftSpacing_m,
                 .frequency_rad_s = touchFrequency(body.material, kSoftSpacing_m)}),
        ball_m(ball_spacings * kSoftSpacing_m),
        top_m(depth * kSoftSpacing_m),
        middle_m(width * kSoftSpacing_m / 2) {}

  double forceAt(double depth_m) {
    const BodyMotion ball{.place = {middle_m, top_m + ball_m - depth_m, middle_m}};
    contact.list(body.body, {&ball, 1}, 0, body.team);
    const double slowest = 1.57 * std::sqrt(body.material.shear_Pa() / 1000) / top_m * body.step_s;
    const auto kept = static_cast<float>(std::exp(-1.5 * slowest));
    Exchange exchange;
    for (int k = 0; k < 7 / slowest; ++k) {
      DVec3 walls(0);
      exchange = {};
      contact.press(body.body, {&ball, 1}, body.step_s, walls, {&exchange, 1}, body.team);
      body.substep();
      for (Vec3& velocity : body.body.velocities()) velocity *= kept;
    }
    return exchange.impulse.y / body.step_s;
  }
};

double hertz(double poisson, double ball_m, double depth_m) {
  return 4.0 / 3 * 5e4 / (1 - poisson * poisson) * std::sqrt(ball_m) * std::pow(depth_m, 1.5);
}

}  // namespace

namespace {

void checkHertz(double poisson, int width, int depth, int ball, std::initializer_list<double> shares, double within) {
  CAPTURE(poisson);
  Indentation indentation(poisson, width, depth, ball);
  for (const double share : shares) {
    CAPTURE(share);
    const double depth_m = share * indentation.ball_m;
    checkTruth(fmt::format("Hertz, ball of {} spacings, Poisson's ratio {:g}, d = {:g} R, N", ball, poisson, share),
               indentation.forceAt(depth_m), hertz(poisson, indentation.ball_m, depth_m), within);
  }
}

}  // namespace

TEST_CASE("a deep block pushes back a pressed ball as Hertz predicts" * kFull) {
  for (const double poisson : {0.3, 0.45}) checkHertz(poisson, 32, 24, 8, {0.05, 0.1}, 0.08);
}

// The shallower a block, the stiffer it is, so that this bound is wider.
TEST_CASE("a block of few cells pushes back a pressed ball nearly as Hertz predicts") {
  for (const double poisson : {0.3, 0.45}) checkHertz(poisson, 16, 12, 5, {0.1}, 0.12);
}

TEST_CASE("the force of a ball hardly depends on its position between the nodes") {
  Indentation between(0.3, 20, 14, 5), onNode(0.3, 20, 14, 5);
  between.middle_m += kSoftSpacing_m / 2;
  const double depth = 0.1 * onNode.ball_m;
  CHECK(isWithin(0.06, between.forceAt(depth), onNode.forceAt(depth)));
}

}  // namespace palpate::soft_contact_test
