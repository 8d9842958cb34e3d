// ctest: waits
// Shared sessions through the C interface: a cloud is served, joined twice, and sculpted by both clients.
#include <atomic>
#include <memory>
#include <thread>

#include "tests/labels.hpp"
#include "tests/library/serving.hpp"
#include "tests/near.hpp"

namespace palpate::sharing_test {

namespace {

/// A server whose thread can be halted: it then receives nothing and answers no client.
class StandingServer {
 public:
  explicit StandingServer(const char* name) : name_(name) {
    pp_serve_options options = pp_default_serve_options();
    options.network = &network_;
    options.mm_per_unit = 1;
    options.log_user = this;
    options.log = [](void* user, const char* line) {
      auto& own = *static_cast<StandingServer*>(user);
      if (std::string(line).find("takes the points") == std::string::npos) return;
      for (own.stands_ = own.told_.load(); own.told_;) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    PP_REQUIRE_OK(pp_serve(cloud_.cloud, name, &options, &server));
  }
  ~StandingServer() {
    goOn();
    pp_server_close(server);
  }
  StandingServer(const StandingServer&) = delete;
  StandingServer& operator=(const StandingServer&) = delete;
  // Another client joins; the log function, which is told of it, then blocks the server's thread.
  void stand() {
    told_ = true;
    comer_ = std::thread([this] { PP_CHECK_OK(pp_session_close(joined(name_, "comer"))); });
    CHECK(comes(20, [&] { return stands_.load(); }));
  }
  void goOn() {
    told_ = false;
    if (comer_.joinable()) comer_.join();
  }
  pp_server server{};

 private:
  const char* name_;
  pp_network network_ = ownNetwork();
  BallCloud cloud_;
  std::atomic<bool> told_ = false, stands_ = false;
  std::thread comer_;
};

pp_pose poseAt(std::size_t tick, double z) { return {.t_s = 1e-3 * static_cast<double>(tick), .hip = {0.3, -0.2, z}}; }

}  // namespace

TEST_CASE("a library built without PALPATE_NETWORK shares nothing, and reports that") {
  if (pp_can_share()) return;
  const BallCloud ball;
  pp_server server{};
  pp_session session{};
  std::uint64_t count = 0;
  CHECK(pp_serve(ball.cloud, "a", nullptr, &server) == PP_ERROR_UNSUPPORTED);
  CHECK(lastErrorSays("built without PALPATE_NETWORK"));
  CHECK(pp_session_join("a", nullptr, nullptr, &session) == PP_ERROR_UNSUPPORTED);
  CHECK(pp_network_survey(nullptr, 0, nullptr, 0, &count) == PP_ERROR_UNSUPPORTED);
}

TEST_CASE("two hands sculpt a served cloud by path, and both and the server end with the same points, bit by bit") {
  if (!isBuilt()) return;
  const Serving serving("shared ball");
  const auto before = serving.points();
  const pp_session one = joined("shared ball", "anna"), two = joined("shared ball", "ben");
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(one, &info));
  CHECK(info.mm_per_unit == 1);
  CHECK(isSame(pointsOf(one), before));

  pp_brush push = pp_default_brush(), carve = pp_default_brush();
  push.radius_mm = 5;
  carve.kind = "carve";
  carve.radius_mm = 3;
  const auto down = pressPath(3);
  auto beside = pressPath(3);
  for (std::size_t i = 0; i < beside.size(); i += 3) beside[i] += 4;
  CHECK(stroke(one, pathOf(down), push).back().contact == 1);
  CHECK(stroke(two, pathOf(beside), carve).back().valid == 1);

  for (const pp_session session : {one, two}) {
    std::uint32_t same = 0;
    PP_REQUIRE_OK(pp_session_settle(session, 60, &same));
    CHECK(same == 1);
  }
  const auto after = serving.points();
  CHECK_FALSE(isSame(after, before));
  CHECK(isSame(pointsOf(one), after));
  CHECK(isSame(pointsOf(two), after));
  const pp_sharing sharing = sharingOf(two);
  CHECK(sharing.sculptable == 1);
  CHECK(sharing.heard == 1);
  CHECK(sharing.delivered == 1);
  CHECK(sharing.same == 1);
  CHECK(sharing.sent > 10);
  CHECK(sharing.received > 10);
  CHECK(std::string(sharing.name) == "shared ball");
  CHECK(std::string(sharing.model) == "a test's ball");
  CHECK(std::string(sharing.host) != "");
  CHECK(std::string(sharing.fault) == "");
  CHECK(serving.info().sculptors == 2);
  CHECK(serving.info().clients == 2);
  CHECK(serving.info().states > 20);
  CHECK(std::string(serving.info().openness).find("programs of this machine") != std::string::npos);

  // Undoes this hand's stroke, whose points no other hand has changed since; a later client receives the result.
  std::uint64_t done = 0;
  PP_CHECK_OK(pp_session_undo(two, 1, &done));
  CHECK(done == 1);
  CHECK_FALSE(isSame(serving.points(), after));
  const pp_session late = joined("shared ball", "late");
  PP_CHECK_OK(pp_session_settle(late, 60, nullptr));
  CHECK(isSame(pointsOf(late), serving.points()));
  for (const pp_session session : {one, two, late}) PP_CHECK_OK(pp_session_close(session));
}

TEST_CASE("a pulled hand on a joined cloud is seen while it sculpts, and others feel its dent") {
  if (!isBuilt()) return;
  const Serving serving("pulled");
  pp_session_options options = cpuOptions();
  options.budget_us = 2'000;
  const pp_session puller = joined("pulled", "puller", options), watcher = joined("pulled", "watcher");
  pp_brush push = pp_default_brush();
  push.radius_mm = 5;
  PP_REQUIRE_OK(pp_session_set_brush(puller, &push));
  std::atomic<bool> done = false;
  std::atomic<int> wrong = 0, seen = 0;
  std::thread servo([&] {
    pp_contact contact{};
    for (std::size_t i = 0; i < 600 || (seen == 0 && i < 30'000); ++i) {
      const pp_pose pose = poseAt(i, std::max(46.0, 52 - 0.01 * static_cast<double>(i)));
      wrong += pp_touch(puller, &pose, &contact) != PP_OK;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    wrong += contact.contact != 1;
    done = true;
  });
  while (!done) {
    wrong += pp_session_follow(puller) != PP_OK;
    pp_other_hand hands[4];
    std::uint64_t count = 0;
    wrong += pp_session_others(watcher, hands, 4, &count) != PP_OK;
    if (count == 1 && std::string(hands[0].name) == "puller" && hands[0].sculpts && hands[0].touching &&
        hands[0].position[2] < hands[0].proxy[2])
      ++seen;
    wrong += sharingOf(puller).heard != 1;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  servo.join();
  CHECK(wrong == 0);
  CHECK(seen > 0);
  std::uint32_t same = 0;
  PP_REQUIRE_OK(pp_session_settle(puller, 60, &same));
  CHECK(same == 1);
  CHECK(isSame(pointsOf(puller), serving.points()));
  PP_REQUIRE_OK(pp_session_settle(watcher, 60, &same));
  CHECK(same == 1);
  CHECK(isSame(pointsOf(watcher), serving.points()));
  // Another client feels the dent.
  const auto touched = touch(watcher, pathOf(pressPath(1)));
  CHECK(touched.back().penetration_mm < 0.5);
  PP_CHECK_OK(pp_session_close(puller));
  PP_CHECK_OK(pp_session_close(watcher));
}

TEST_CASE("pending edits of a pulled hand are delivered when its session is closed") {
  if (!isBuilt()) return;
  const Serving serving("left");
  pp_session_options options = cpuOptions();
  options.budget_us = 100'000;
  const pp_session session = joined("left", "anna", options);
  pp_brush push = pp_default_brush();
  push.radius_mm = 5;
  PP_REQUIRE_OK(pp_session_set_brush(session, &push));
  pp_contact contact{};
  // Down, and held there until the dent exists, however long an edit takes.
  std::size_t tick = 0;
  CHECK(comes(30, [&] {
    const pp_pose pose = poseAt(tick, std::max(48.0, 52 - 0.05 * static_cast<double>(tick)));
    ++tick;
    PP_REQUIRE_OK(pp_touch(session, &pose, &contact));
    return tick > 100 && contact.penetration_mm < 1;
  }));
  CHECK(serving.info().states == 0);
  PP_CHECK_OK(pp_session_close(session));
  CHECK(serving.info().states > 20);
  const pp_session late = joined("left", "late");
  PP_CHECK_OK(pp_session_settle(late, 60, nullptr));
  CHECK(touch(late, pathOf(pressPath(1))).back().penetration_mm < 0.5);
  PP_CHECK_OK(pp_session_close(late));
}

TEST_CASE("a live hand sculpts a joined cloud, and a later client receives its strokes") {
  if (!isBuilt()) return;
  const Serving serving("lively");
  const auto before = serving.points();
  const pp_session live = joined("lively", nullptr);
  pp_brush push = pp_default_brush();
  PP_REQUIRE_OK(pp_session_set_brush(live, &push));
  pp_live_options options = pp_default_live_options();
  options.builtin = "press";
  PP_REQUIRE_OK(pp_live_start(live, &options));
  std::vector<pp_tick> ticks(4096);
  std::uint64_t count = 0, all = 0;
  CHECK(comes(30, [&] {
    PP_REQUIRE_OK(pp_live_take(live, ticks.data(), ticks.size(), &count));
    all += count;
    return sharingOf(live).sent > 20;
  }));
  CHECK(all > 0);
  CHECK(pp_session_settle(live, 1, nullptr) == PP_ERROR_STATE);
  PP_CHECK_OK(pp_session_close(live));
  const auto after = serving.points();
  CHECK_FALSE(isSame(after, before));
  const pp_session late = joined("lively", "late");
  PP_CHECK_OK(pp_session_settle(late, 60, nullptr));
  CHECK(isSame(pointsOf(late), after));
  PP_CHECK_OK(pp_session_close(late));
}

TEST_CASE("a lost server fades a pulled hand's force to zero, and one restarted without edits gives an error" *
          kClock) {
  if (!isBuilt()) return;
  auto serving = std::make_unique<Serving>("brief");
  pp_session_options options = cpuOptions();
  const pp_session session = joined("brief", "left behind", options);
  pp_contact contact{};
  std::size_t tick = 0;
  const auto touchOnce = [&] {
    const pp_pose pose = poseAt(tick, std::max(49.0, 52 - 0.02 * static_cast<double>(tick)));
    ++tick;
    const pp_status status = pp_touch(session, &pose, &contact);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return status;
  };
  CHECK(comes(10, [&] {
    PP_REQUIRE_OK(touchOnce());
    return lengthOf(contact.force_N) > 0.5;
  }));
  serving.reset();
  for (int i = 0; i < 500; ++i) PP_REQUIRE_OK(touchOnce());
  CHECK(lengthOf(contact.force_N) > 0.5);  // a short silence is tolerated
  CHECK(comes(20, [&] {
    PP_REQUIRE_OK(touchOnce());
    return lengthOf(contact.force_N) == 0;
  }));
  CHECK(contact.valid == 1);
  CHECK(sharingOf(session).heard == 0);
  CHECK(sharingOf(session).silent_s > 1.8);

  serving = std::make_unique<Serving>("brief");
  CHECK(comes(20, [&] {
    PP_REQUIRE_OK(touchOnce());
    return sharingOf(session).fault[0] != '\0';
  }));
  CHECK(lengthOf(contact.force_N) == 0);
  CHECK(pp_session_follow(session) == PP_ERROR_NETWORK);
  CHECK(lastErrorSays("was restarted without its edits"));
  CHECK(std::string(pp_status_name(pp_last_status())) == "network");
  const auto path = pressPath(1);
  const pp_path way = pathOf(path);
  std::vector<pp_tick> ticks(300);
  std::uint64_t count = 0;
  CHECK(pp_session_touch(session, &way, ticks.data(), ticks.size(), &count) == PP_ERROR_NETWORK);
  pp_live_options live = pp_default_live_options();
  live.builtin = "press";
  CHECK(pp_live_start(session, &live) == PP_ERROR_NETWORK);
  CHECK(pointsOf(session).size() == 6 * 20'000);  // the points are not lost
  PP_CHECK_OK(pp_session_close(session));
}

TEST_CASE("a server with a journal resumes after a restart, and so do its joined sessions") {
  if (!isBuilt()) return;
  const std::string journal = "/tmp/palpate_library_journal_" + std::to_string(getpid());
  auto serving = std::make_unique<Serving>("kept", false, journal.c_str());
  const pp_session session = joined("kept", "anna");
  pp_brush push = pp_default_brush();
  stroke(session, pathOf(pressPath(3)), push);
  const auto before = serving->points();
  serving.reset();
  serving = std::make_unique<Serving>("kept", false, journal.c_str());
  CHECK(isSame(serving->points(), before));
  stroke(session, pathOf(pressPath(5)), push);
  std::uint32_t same = 0;
  PP_REQUIRE_OK(pp_session_settle(session, 60, &same));
  CHECK(same == 1);
  CHECK_FALSE(isSame(serving->points(), before));
  CHECK(isSame(pointsOf(session), serving->points()));
  PP_CHECK_OK(pp_session_close(session));
  serving.reset();
  unlink(journal.c_str());
}

TEST_CASE("a session served read-only, or joined read-only, accepts no brush") {
  if (!isBuilt()) return;
  const Serving felt("felt", true), shared("shared");
  const pp_session alone = joined("felt", "anna"), careful = joined("shared", "ben", cpuOptions(), JoinedTo::feel);
  pp_brush push = pp_default_brush();
  CHECK(pp_session_set_brush(alone, &push) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("served read-only"));
  CHECK(pp_session_set_brush(careful, &push) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("read_only"));
  for (const pp_session session : {alone, careful}) {
    PP_CHECK_OK(pp_session_set_brush(session, nullptr));
    const auto path = pressPath(1);
    CHECK(touch(session, pathOf(path)).back().contact == 1);
  }
  CHECK(sharingOf(alone).sculptable == 0);
  CHECK(sharingOf(careful).sculptable == 1);
  CHECK(pp_session_record(careful, "/tmp/none.session") == PP_ERROR_STATE);
  CHECK(lastErrorSays("the strokes of others"));
  PP_CHECK_OK(pp_session_close(alone));
  PP_CHECK_OK(pp_session_close(careful));
}

TEST_CASE("a client with only the points around the hand feels what one with all points feels") {
  if (!isBuilt()) return;
  const Serving serving("near");
  const auto before = serving.points();
  const pp_session near = joined("near", "anna", cpuOptions(), JoinedTo::feelNear);
  const pp_session whole = joined("near", "ben", cpuOptions(), JoinedTo::feel);
  const auto path = pressPath(2);
  const auto far = touch(near, pathOf(path)), all = touch(whole, pathOf(path));
  REQUIRE(far.size() == all.size());
  CHECK(far.back().contact == 1);
  for (std::size_t i = 0; i < far.size(); ++i)
    for (int k = 0; k < 3; ++k) CHECK(far[i].force_N[k] == all[i].force_N[k]);
  // Each client sees the other's hand.
  const auto sees = [](pp_session who, const std::string& name) {
    pp_other_hand hands[4];
    std::uint64_t count = 0;
    PP_REQUIRE_OK(pp_session_others(who, hands, 4, &count));
    return count == 1 && hands[0].name == name && hands[0].touching && !hands[0].sculpts &&
           hands[0].position[2] < hands[0].proxy[2];
  };
  // A hand at the end of its path is still being sent, and is shown for a second.
  const auto isSeen = [&](pp_session hand, const std::string& name, pp_session who) {
    return comes(10, [&] {
      touch(hand, pathOf(path));
      return comes(0.5, [&] { return sees(who, name); });
    });
  };
  CHECK(isSeen(near, "anna", whole));
  CHECK(isSeen(whole, "ben", near));
  const pp_sharing sharing = sharingOf(near);
  CHECK(sharing.restarts == 0);
  CHECK(sharing.sculptable == 1);
  CHECK(sharing.heard == 1);
  CHECK(sharing.pings > 0);
  CHECK(sharing.sent == 0);
  CHECK(std::string(sharing.fault).empty());
  const pp_brush push = pp_default_brush();
  stroke(near, pathOf(path), push);
  const pp_sharing sculpted = sharingOf(near);
  CHECK(sculpted.sent > 10);
  CHECK(sculpted.delivered == 1);
  std::uint64_t undone = 1;
  CHECK(pp_session_undo(near, 1, &undone) != PP_OK);
  CHECK(lastErrorSays("only the points around the hand"));
  // Edits of a live hand are delivered when it ends.
  PP_CHECK_OK(pp_session_set_brush(near, &push));
  pp_live_options options = pp_default_live_options();
  options.builtin = "press";
  PP_REQUIRE_OK(pp_live_start(near, &options));
  CHECK(comes(30, [&] { return sharingOf(near).sent > sculpted.sent + 20; }));
  PP_CHECK_OK(pp_session_close(near));
  const std::uint64_t states = serving.info().states;
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(serving.info().states == states);
  CHECK(states > sculpted.sent + 20);
  CHECK_FALSE(isSame(serving.points(), before));
  PP_CHECK_OK(pp_session_close(whole));
}

TEST_CASE("sessions of a network are listed, and invalid joins and servers are refused with a reason") {
  if (!isBuilt()) return;
  const Serving serving("listed"), other("another");
  const pp_network network = ownNetwork();
  pp_seen_session seen[1]{};
  std::uint64_t count = 0;
  for (int i = 0; i < 30 && (count != 2 || seen[0].answered == 0); ++i)
    PP_REQUIRE_OK(pp_network_survey(&network, 1, seen, 1, &count));
  CHECK(count == 2);  // only one fits into the array
  CHECK((std::string(seen[0].name) == "listed" || std::string(seen[0].name) == "another"));
  CHECK(seen[0].points == 20'000);
  CHECK(seen[0].fits == 1);
  CHECK(seen[0].answered > 0);
  CHECK(seen[0].round_trip_ms > 0);
  CHECK(pp_network_survey(&network, -1, seen, 1, &count) == PP_ERROR_ARGUMENT);
  CHECK(pp_network_survey(&network, 0, nullptr, 1, &count) == PP_ERROR_ARGUMENT);
  CHECK(pp_network_survey(&network, 0, seen, 1, nullptr) == PP_ERROR_ARGUMENT);

  pp_join_options join = pp_default_join_options();
  join.network = &network;
  join.patience_s = 0.5;
  pp_session session{};
  const pp_session_options options = cpuOptions();
  CHECK(pp_session_join("town", &join, &options, &session) == PP_ERROR_NETWORK);
  CHECK(lastErrorSays("'town'"));
  CHECK(pp_session_join(nullptr, &join, &options, &session) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_join("", &join, &options, &session) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_join("listed", &join, &options, nullptr) == PP_ERROR_ARGUMENT);
  join.patience_s = 0;
  CHECK(pp_session_join("listed", &join, &options, &session) == PP_ERROR_ARGUMENT);
  join.patience_s = 1;
  pp_network wrong = network;
  wrong.interface_name = "nowhere0";
  join.network = &wrong;
  CHECK(pp_session_join("listed", &join, &options, &session) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("on domain"));  // the domain is already in use with another configuration
  wrong.domain = network.domain + 100;
  CHECK(pp_session_join("listed", &join, &options, &session) == PP_ERROR_NETWORK);
  CHECK(lastErrorSays("nowhere0"));
  wrong = network;
  wrong.security = "/nowhere/keys";
  CHECK(pp_session_join("listed", &join, &options, &session) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("on domain"));
  wrong.domain = network.domain + 101;
  CHECK(pp_session_join("listed", &join, &options, &session) == PP_ERROR_FILE);
  CHECK(lastErrorSays("/nowhere/keys"));
  wrong = network;
  wrong.domain = 5000;
  CHECK(pp_session_join("listed", &join, &options, &session) == PP_ERROR_ARGUMENT);
  wrong = network;
  wrong.peer_count = 1;
  CHECK(pp_session_join("listed", &join, &options, &session) == PP_ERROR_ARGUMENT);

  pp_serve_options serve = pp_default_serve_options();
  serve.network = &network;
  pp_server server{};
  CHECK(pp_serve(serving.cloud.cloud, "listed", &serve, &server) == PP_ERROR_NETWORK);
  CHECK(lastErrorSays("give this one another name"));
  CHECK(pp_serve(serving.cloud.cloud, "a\nb", &serve, &server) == PP_ERROR_ARGUMENT);
  CHECK(pp_serve(serving.cloud.cloud, nullptr, &serve, &server) == PP_ERROR_ARGUMENT);
  CHECK(pp_serve({}, "free", &serve, &server) == PP_ERROR_HANDLE);
  serve.read_only = 1;
  serve.journal = "/tmp/none";
  CHECK(pp_serve(serving.cloud.cloud, "free", &serve, &server) == PP_ERROR_ARGUMENT);
  const pp_cloud_arrays none = pp_default_cloud_arrays();
  pp_cloud empty{};
  PP_REQUIRE_OK(pp_cloud_create(&none, &empty));
  serve.read_only = 0;
  serve.journal = nullptr;
  CHECK(pp_serve(empty, "free", &serve, &server) == PP_ERROR_ARGUMENT);
  PP_CHECK_OK(pp_cloud_close(empty));
}

TEST_CASE("cameras are shown, seen by others, and hidden again") {
  if (!isBuilt()) return;
  const Serving serving("looked at");
  const pp_session anna = joined("looked at", "anna"), ben = joined("looked at", "ben");
  pp_camera_place place{{10, 20, 300}, {0, 1, 0, 0}, 50, 1.5};
  pp_other_camera cameras[4];
  std::uint64_t count = 7;
  PP_REQUIRE_OK(pp_session_cameras(ben, cameras, 4, &count));
  CHECK(count == 0);
  PP_REQUIRE_OK(pp_session_show_camera(anna, &place));
  const auto isSeen = [&](std::uint64_t wanted) {
    for (int i = 0; i < 1000; ++i) {
      PP_REQUIRE_OK(pp_session_cameras(ben, cameras, 4, &count));
      if (count == wanted) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  };
  REQUIRE(isSeen(1));
  CHECK(std::string(cameras[0].name) == "anna");
  CHECK(cameras[0].place.position[2] == 300);
  CHECK(cameras[0].place.orientation[1] == 1);
  CHECK(cameras[0].place.fov_deg == near(50, 1e-6));
  CHECK(cameras[0].place.aspect == 1.5);
  PP_REQUIRE_OK(pp_session_cameras(anna, nullptr, 0, &count));
  CHECK(count == 0);
  place.aspect = 0;
  CHECK(pp_session_show_camera(anna, &place) == PP_ERROR_ARGUMENT);
  PP_CHECK_OK(pp_session_show_camera(anna, nullptr));
  CHECK(isSeen(0));
  PP_CHECK_OK(pp_session_close(anna));
  PP_CHECK_OK(pp_session_close(ben));
}

TEST_CASE("waiting network calls end when the program's stop function returns 1, and call it often") {
  if (!isBuilt()) return;
  struct Patience {
    int asked = 0, most = 0;
    std::thread::id thread;
    static std::int32_t isOver(void* user) {
      auto& patience = *static_cast<Patience*>(user);
      patience.thread = std::this_thread::get_id();
      return ++patience.asked > patience.most ? 1 : 0;
    }
  };
  const auto refuses = [](auto&& call, int most) {
    Patience patience{.most = most};
    pp_network network = ownNetwork();
    network.stop = &Patience::isOver;
    network.stop_user = &patience;
    CHECK(call(network) == PP_ERROR_NETWORK);
    CHECK(lastErrorSays("interrupted"));
    CHECK(patience.asked == most + 1);
    CHECK(patience.thread == std::this_thread::get_id());
  };
  for (const int most : {0, 3}) {
    refuses(
        [](const pp_network& network) {
          std::uint64_t count = 0;
          return pp_network_survey(&network, 60, nullptr, 0, &count);
        },
        most);
    refuses(
        [](const pp_network& network) {
          pp_join_options join = pp_default_join_options();
          join.network = &network;
          join.patience_s = 60;
          pp_session session{};
          return pp_session_join("nobody's", &join, nullptr, &session);
        },
        most);
    refuses(
        [](const pp_network& network) {
          pp_serve_options serve = pp_default_serve_options();
          serve.network = &network;
          const BallCloud ball;
          pp_server server{};
          return pp_serve(ball.cloud, "mine", &serve, &server);
        },
        most);
  }
}

TEST_CASE("sharing calls refuse handles that are closed, of another kind or not joined") {
  const OpenBall ball;
  pp_sharing sharing = pp_default_sharing();
  std::uint64_t count = 0;
  CHECK(pp_session_get_sharing(ball.session, &sharing) == PP_ERROR_STATE);
  CHECK(lastErrorSays("was not joined"));
  CHECK(pp_session_others(ball.session, nullptr, 0, &count) == PP_ERROR_STATE);
  CHECK(pp_session_settle(ball.session, 1, nullptr) == PP_ERROR_STATE);
  CHECK(pp_session_cameras(ball.session, nullptr, 0, &count) == PP_ERROR_STATE);
  CHECK(pp_session_show_camera(ball.session, nullptr) == PP_ERROR_STATE);
  pp_server_info info = pp_default_server_info();
  pp_cloud cloud{};
  CHECK(pp_server_get_info({}, &info) == PP_ERROR_HANDLE);
  CHECK(pp_server_cloud({ball.session.id}, &cloud) == PP_ERROR_HANDLE);
  CHECK(pp_server_close({ball.session.id}) == PP_ERROR_HANDLE);
  if (!isBuilt()) return;
  auto serving = std::make_unique<Serving>("closed");
  const pp_server server = serving->server;
  info.size = 4;
  CHECK(pp_server_get_info(server, &info) == PP_ERROR_ARGUMENT);
  CHECK(pp_server_get_info(server, nullptr) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_close({server.id}) == PP_ERROR_HANDLE);
  const pp_session session = joined("closed", "anna");
  serving.reset();
  info = pp_default_server_info();
  CHECK(pp_server_get_info(server, &info) == PP_ERROR_HANDLE);
  CHECK(pp_server_close(server) == PP_ERROR_HANDLE);
  CHECK(pp_session_get_sharing(session, nullptr) == PP_ERROR_ARGUMENT);
  PP_CHECK_OK(pp_session_close(session));
  CHECK(pp_session_get_sharing(session, &sharing) == PP_ERROR_HANDLE);
  CHECK(pp_session_others(session, nullptr, 0, &count) == PP_ERROR_HANDLE);
}

TEST_CASE("a server's log function is told of new clients, and cannot query or close its own server") {
  if (!isBuilt()) return;
  struct Heard {
    std::atomic<std::uint64_t> server = 0;
    std::atomic<int> told = 0, refused = 0;
  } heard;
  const pp_network network = ownNetwork();
  const BallCloud ball;
  pp_serve_options options = pp_default_serve_options();
  options.network = &network;
  options.log_user = &heard;
  options.log = [](void* user, const char* line) {
    auto& to = *static_cast<Heard*>(user);
    if (std::string(line).find("takes the points") == std::string::npos) return;
    pp_server_info info = pp_default_server_info();
    to.refused += pp_server_get_info({to.server}, &info) == PP_ERROR_STATE;
    to.refused += pp_server_close({to.server}) == PP_ERROR_STATE;
    ++to.told;
  };
  pp_server server{};
  PP_REQUIRE_OK(pp_serve(ball.cloud, "told", &options, &server));
  heard.server = server.id;
  const pp_session session = joined("told", "anna");
  CHECK(heard.told == 1);
  CHECK(heard.refused == 2);
  PP_CHECK_OK(pp_session_close(session));
  PP_CHECK_OK(pp_server_close(server));
}

TEST_CASE("settle reports no agreement while the server does not answer, even if all points agreed before") {
  if (!isBuilt()) return;
  StandingServer server("held");
  const pp_session session = joined("held", "anna");
  std::uint32_t same = 0;
  PP_REQUIRE_OK(pp_session_settle(session, 60, &same));
  CHECK(same == 1);
  server.stand();
  CHECK(sharingOf(session).same == 1);  // as in the last answer
  PP_CHECK_OK(pp_session_settle(session, 0.3, &same));
  CHECK(same == 0);
  server.goOn();
  PP_CHECK_OK(pp_session_settle(session, 60, &same));
  CHECK(same == 1);
  PP_CHECK_OK(pp_session_close(session));
}

TEST_CASE("closing a session delivers a pulled hand's last edits, even if the server is halted for a while") {
  if (!isBuilt()) return;
  StandingServer server("standing");
  pp_session_options options = cpuOptions();
  options.budget_us = 100'000;
  const pp_session session = joined("standing", "anna", options);
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
  server.stand();
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::seconds(3));
    server.goOn();
  });
  PP_CHECK_OK(pp_session_close(session));
  later.join();
  pp_server_info info = pp_default_server_info();
  PP_REQUIRE_OK(pp_server_get_info(server.server, &info));
  CHECK(info.states > 20);
}

TEST_CASE("a server and a joined session can be queried by many threads while they are closed") {
  if (!isBuilt()) return;
  auto serving = std::make_unique<Serving>("busy");
  const pp_server server = serving->server;
  const pp_session session = joined("busy", "anna");
  std::atomic<bool> end = false;
  std::atomic<int> wrong = 0, answered = 0;
  std::vector<std::thread> askers;
  for (int i = 0; i < 4; ++i)
    askers.emplace_back([&] {
      while (!end) {
        pp_server_info info = pp_default_server_info();
        const pp_status of = pp_server_get_info(server, &info);
        pp_sharing sharing = pp_default_sharing();
        const pp_status with = pp_session_get_sharing(session, &sharing);
        wrong += of != PP_OK && of != PP_ERROR_HANDLE;
        wrong += with != PP_OK && with != PP_ERROR_HANDLE && with != PP_ERROR_THREAD;
        answered += of == PP_OK;
      }
    });
  CHECK(comes(20, [&] { return answered > 8; }));
  while (pp_session_close(session) == PP_ERROR_THREAD) std::this_thread::yield();
  serving.reset();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  end = true;
  for (std::thread& asker : askers) asker.join();
  CHECK(wrong == 0);
}

}  // namespace palpate::sharing_test
