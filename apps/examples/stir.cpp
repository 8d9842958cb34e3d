// Water in a tank, first alone, then stirred by two hands: stir
// 77: this library was built without PALPATE_SIMULATION.
#include <cstdio>
#include <palpate/palpate.hpp>

int main() try {
  if (!pp_can_simulate()) return 77;
  pp_matter_options alone = pp_default_matter_options();
  alone.gpu = "cpu";
  pp::Matter dam("dam", alone);
  const double before_mm = dam.state().front_mm;
  dam.step(20);
  const pp::Frame frame = dam.frame();
  const pp_moving_points points = frame.view();
  if (points.points.count == 0 || !points.velocities || dam.state().front_mm <= before_mm) return 1;

  pp_session_options options = pp_default_session_options();
  options.gpu = "cpu";
  options.hands = 2;
  pp::Session water = pp::Session::ofMatter("water", options);
  water.setParameter("gain", 2);
  const pp_points box = water.cloud().view();
  const double x = (box.min[0] + box.max[0]) / 2, y = box.max[1], z = (box.min[2] + box.max[2]) / 2;
  const double one[] = {0, x / 2, y + 30, z, 0.1, x / 2, y - 10, z},
               two[] = {0, 3 * x / 2, y + 30, z, 0.1, 3 * x / 2, y + 30, z};
  const auto ticks = water.touchHands({pp::timedPath(one, 2), pp::timedPath(two, 2)});
  const pp_motion motion = water.motion();
  std::printf("%s: %zu rows, %.3f N and %.3f N, %.2g J\n", pp::version().c_str(), ticks.size(),
              ticks[ticks.size() - 2].force_N[1], ticks.back().force_N[1], motion.energy_J[0]);
  return motion.failed == 0 && ticks.back().valid == 1 ? 0 : 1;
} catch (const pp::Error& error) {
  std::fprintf(stderr, "stir: %s\n", error.what());
  return 1;
}
