// Sessions shared between several clients, within one test program.
#pragma once

#include <algorithm>
#include <cstring>

#include "tests/library/ball.hpp"
#include "tests/own_domain.hpp"

namespace palpate {

/// A network domain that no other test program uses, on this machine only.
inline pp_network ownNetwork() {
  pp_network network = pp_default_network();
  network.domain = ownDomain();
  return network;
}

inline bool isBuilt() {
  if (pp_can_share()) return true;
  MESSAGE("skipped: this palpate was built without PALPATE_NETWORK");
  return false;
}

struct Serving {
  pp_network network = ownNetwork();
  BallCloud cloud;
  pp_server server{};

  explicit Serving(const char* name, bool readOnly = false, const char* journal = nullptr, const char* save = nullptr) {
    pp_serve_options options = pp_default_serve_options();
    options.network = &network;
    options.mm_per_unit = 1;
    options.read_only = readOnly ? 1 : 0;
    options.journal = journal;
    options.save = save;
    options.model = "a test's ball";
    PP_REQUIRE_OK(pp_serve(cloud.cloud, name, &options, &server));
  }
  ~Serving() { pp_server_close(server); }
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;
  pp_server_info info() const {
    pp_server_info info = pp_default_server_info();
    PP_REQUIRE_OK(pp_server_get_info(server, &info));
    return info;
  }
  std::vector<float> points() const {
    pp_cloud now{};
    PP_REQUIRE_OK(pp_server_cloud(server, &now));
    return bytesOf(now);
  }
  // Positions and normals of a cloud, bit by bit; closes the cloud.
  static std::vector<float> bytesOf(pp_cloud cloud) {
    pp_points points{};
    PP_REQUIRE_OK(pp_cloud_view(cloud, &points));
    std::vector<float> all(points.positions, points.positions + 3 * points.count);
    all.insert(all.end(), points.normals, points.normals + 3 * points.count);
    PP_REQUIRE_OK(pp_cloud_close(cloud));
    return all;
  }
};

enum class JoinedTo { sculpt, feel, feelNear };

inline pp_session joined(const char* name, const char* hand, pp_session_options options = cpuOptions(),
                         JoinedTo aim = JoinedTo::sculpt) {
  const pp_network network = ownNetwork();
  pp_join_options join = pp_default_join_options();
  join.network = &network;
  join.hand_name = hand;
  join.read_only = aim == JoinedTo::feel ? 1 : 0;
  join.partial = aim == JoinedTo::feelNear ? 1 : 0;
  join.timeout_s = 20;
  options.mm_per_unit = 0;  // the scale of the server
  pp_session session{};
  PP_REQUIRE_OK(pp_session_join(name, &join, &options, &session));
  return session;
}

inline pp_sharing sharingOf(pp_session session) {
  pp_sharing sharing = pp_default_sharing();
  PP_REQUIRE_OK(pp_session_get_sharing(session, &sharing));
  return sharing;
}

inline std::vector<float> pointsOf(pp_session session) {
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_session_cloud(session, &cloud));
  return Serving::bytesOf(cloud);
}

inline bool isSame(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

/// Above or in the ball, not quite on its axis.
inline pp_pose poseAt(std::size_t tick, double z) {
  return {.t_s = 1e-3 * static_cast<double>(tick), .hip = {0.3, -0.2, z}};
}

/// Pushes a pulled hand down, and holds it there until the dent exists, however long an edit takes.
inline void pushUntilDented(pp_session session) {
  pp_brush push = pp_default_brush();
  push.radius_mm = 5;
  PP_REQUIRE_OK(pp_session_set_brush(session, &push));
  pp_contact contact{};
  std::size_t tick = 0;
  CHECK(comes(30, [&] {
    const pp_pose pose = poseAt(tick, std::max(48.0, 52 - 0.05 * static_cast<double>(tick)));
    ++tick;
    PP_REQUIRE_OK(pp_touch(session, &pose, &contact));
    return tick > 100 && contact.penetration_mm < 1;
  }));
}

}  // namespace palpate
