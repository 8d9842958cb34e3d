// Reads a model, dents it, undoes and redoes the dent, and saves it: dent MODEL OUT
#include <cstdio>
#include <palpate/palpate.hpp>

int main(int count, char** words) try {
  if (count != 3) return 2;
  const pp::Cloud cloud = pp::Cloud::read(words[1]);
  pp_session_options options = pp_default_session_options();
  options.gpu = "cpu";
  pp::Session session(cloud, options);

  const pp_points points = cloud.view();
  const double x = (points.min[0] + points.max[0]) / 2, y = (points.min[1] + points.max[1]) / 2, top = points.max[2];
  const double side = points.max[2] - points.min[2];
  const double way[] = {0, x, y, top + 0.02 * side, 0.15, x, y, top - 0.05 * side, 0.2, x, y, top - 0.05 * side};
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 8;
  const auto ticks = session.stroke(pp::timedPath(way, 3), brush);
  if (session.undo() != 1 || session.redo() != 1) return 1;
  session.cloud().write(words[2]);
  std::printf("%s: %zu ticks, %.3f N at the end\n", pp::version().c_str(), ticks.size(), ticks.back().force_N[2]);
  return 0;
} catch (const pp::Error& error) {
  std::fprintf(stderr, "dent: %s\n", error.what());
  return 1;
}
