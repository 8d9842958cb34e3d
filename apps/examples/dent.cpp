// Reads a model, dents it where it is nearest to its top, undoes and redoes the dent, and saves it: dent MODEL OUT
#include <cstdio>
#include <palpate/palpate.hpp>
#include <utility>
#include <vector>

int main(int count, char** words) try {
  if (count != 3) {
    std::fputs("usage: dent MODEL OUT\n", stderr);
    return 2;
  }
  const pp::Cloud cloud = pp::Cloud::read(words[1]);
  pp_session_options options = pp_default_session_options();
  options.gpu = "cpu";
  pp::Session session(cloud, options);

  const pp_points points = cloud.view();
  const double x = (points.min[0] + points.max[0]) / 2, y = (points.min[1] + points.max[1]) / 2;
  const pp_surface_point found = session.nearest({x, y, 2 * points.max[2] - points.min[2]}).front();
  const double units_per_mm = 1 / session.info().mm_per_unit;
  std::vector<double> way;  // from 2 mm above the surface to 3 mm below it, and a rest
  for (const auto& [t_s, depth_mm] : {std::pair(0.0, -2.0), std::pair(0.15, 3.0), std::pair(0.2, 3.0)}) {
    way.push_back(t_s);
    for (int k = 0; k < 3; ++k) way.push_back(found.position[k] - depth_mm * units_per_mm * found.normal[k]);
  }
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 8;
  const auto ticks = session.stroke(pp::timedPath(way.data(), 3), brush);
  if (session.undo() != 1 || session.redo() != 1) {
    std::fputs("dent: the hand has changed nothing\n", stderr);
    return 1;
  }
  session.cloud().write(words[2]);
  std::printf("%s: %zu ticks, %.3f N at the end\n", pp::version().c_str(), ticks.size(), ticks.back().force_N[2]);
  return 0;
} catch (const pp::Error& error) {
  std::fprintf(stderr, "dent: %s\n", error.what());
  return 1;
}
