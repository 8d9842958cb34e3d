// Looks for a model with rays, presses on it where one hits, and reacts to the contact: probe MODEL
#include <cstdio>
#include <palpate/palpate.hpp>
#include <vector>

int main(int count, char** words) try {
  if (count != 2) {
    std::fputs("usage: probe MODEL\n", stderr);
    return 2;
  }
  const pp::Cloud cloud = pp::Cloud::read(words[1]);
  pp_session_options options = pp_default_session_options();
  options.gpu = "cpu";
  options.budget_us = 500;
  options.log = [](void*, int32_t level, const char* line) {
    std::printf("%s: %s\n", level == PP_LOG_WARNING ? "warning" : "note", line);
  };
  pp::Session session(cloud, options);

  // A row of rays, straight down.
  const pp_points box = cloud.view();
  const double above = box.max[2] + 1, depth = box.max[2] - box.min[2];
  std::vector<double> origins, directions;
  for (int i = 0; i < 9; ++i) {
    const double share = 0.1 + 0.1 * i;
    origins.insert(origins.end(),
                   {box.min[0] + share * (box.max[0] - box.min[0]), (box.min[1] + box.max[1]) / 2, above});
    directions.insert(directions.end(), {0, 0, -1});
  }
  const auto hits = session.raycast(origins, directions);
  const pp_surface_point& middle = hits[4];
  if (!middle.found) return 1;

  int begun = 0, ended = 0;
  session.onContact([&](const pp_contact_event& event) {
    ++(event.begins ? begun : ended);
    std::printf("contact %s at %.3f s, %.3f units high\n", event.begins ? "begins" : "ends", event.t_s, event.proxy[2]);
  });
  // The servo loop of the program: down on the surface, and up again.
  const double start = middle.position[2] + 0.02 * depth;
  pp_pose pose{0, {middle.position[0], middle.position[1], start}, 0, 0};
  for (int tick = 0; tick < 400; ++tick) {
    pose.t_s = 1e-3 * tick;
    pose.hip[2] = start - 0.04 * depth * (tick < 200 ? tick : 400 - tick) / 200.0;
    const pp_contact contact = session.touch(pose);
    if (pp::validityOf(contact) == pp::Validity::none) return 1;  // a real loop would give its device no force
  }
  const auto foot = session.nearest({pose.hip[0], pose.hip[1], pose.hip[2]});
  std::printf("hit %.3f units high, point %llu; %.3f units from the hand\n", middle.position[2],
              static_cast<unsigned long long>(middle.row), foot.front().distance);
  return begun == 1 && ended == 1 ? 0 : 1;
} catch (const pp::Error& error) {
  std::fprintf(stderr, "probe: %s\n", error.what());
  return 1;
}
