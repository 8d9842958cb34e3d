// A hand on the data of ROS sensors, through the program.
#pragma once

#include <algorithm>

#include "tests/apps/running_program.hpp"
#include "tests/own_domain.hpp"
#include "tests/sharing/ros_camera.hpp"

namespace palpate {

constexpr DepthCamera kCamera{.width = 64, .height = 48, .fx = 120, .fy = 120, .cx = 31.5, .cy = 23.5};
constexpr double kStiffness_N_per_mm = 0.5;

// A domain that no other test uses at the same time.
inline NetworkConfig network() { return {.domain = ownDomain()}; }

inline std::string touching(const std::filesystem::path& folder, const DVec3& hip_m, double duration_s) {
  std::ofstream(folder / "path.csv") << fmt::format("t_s,x,y,z\n0,{0},{1},0.4\n0.3,{0},{1},{2}\n{3},{0},{1},{2}\n",
                                                    hip_m.x, hip_m.y, hip_m.z, duration_s);
  return fmt::format(" --realtime --backend cpu --stiffness {} --path {} --trace {} --json {} --domain {}",
                     kStiffness_N_per_mm, (folder / "path.csv").string(), (folder / "t.csv").string(),
                     (folder / "r.json").string(), network().domain);
}

inline std::vector<Row> between(const std::vector<Row>& rows, double from_s, double to_s) {
  std::vector<Row> found;
  std::ranges::copy_if(rows, std::back_inserter(found),
                       [&](const Row& row) { return row.t_s >= from_s && row.t_s < to_s; });
  return found;
}

}  // namespace palpate
