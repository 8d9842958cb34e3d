// ctest: waits
// The calls of shared sessions: lists, cameras, refusals, settling and closing.
#include <atomic>
#include <memory>
#include <thread>

#include "tests/labels.hpp"
#include "tests/library/serving.hpp"
#include "tests/near.hpp"

namespace palpate::sharing_calls_test {

namespace {

/// A server whose thread can be halted: it then receives nothing and answers no client.
class StandingServer {
 public:
  explicit StandingServer(const char* name) : name_(name) {
    pp_serve_options options = pp_default_serve_options();
    options.network = &network_;
    options.mm_per_unit = 1;
    options.log_user = this;
    options.log = [](void* user, std::int32_t, const char* line) {
      auto& own = *static_cast<StandingServer*>(user);
      if (std::string(line).find("fetches the points") == std::string::npos) return;
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

}  // namespace

TEST_CASE("sessions of a network are listed, and invalid joins and servers are refused with a reason") {
  if (!isBuilt()) return;
  const Serving serving("listed"), other("another");
  const pp_network network = ownNetwork();
  pp_served_session seen[1]{};
  std::uint64_t count = 0;
  for (int i = 0; i < 30 && (count != 2 || seen[0].answered == 0); ++i)
    PP_REQUIRE_OK(pp_network_discover(&network, 1, seen, 1, &count));
  CHECK(count == 2);  // only one fits into the array
  CHECK((std::string(seen[0].name) == "listed" || std::string(seen[0].name) == "another"));
  CHECK(seen[0].points == 20'000);
  CHECK(seen[0].compatible == 1);
  CHECK(seen[0].answered > 0);
  CHECK(seen[0].round_trip_ms > 0);
  CHECK(pp_network_discover(&network, -1, seen, 1, &count) == PP_ERROR_ARGUMENT);
  CHECK(pp_network_discover(&network, 0, nullptr, 1, &count) == PP_ERROR_ARGUMENT);
  CHECK(pp_network_discover(&network, 0, seen, 1, nullptr) == PP_ERROR_ARGUMENT);

  pp_join_options join = pp_default_join_options();
  join.network = &network;
  join.timeout_s = 0.5;
  pp_session session{};
  const pp_session_options options = cpuOptions();
  CHECK(pp_session_join("town", &join, &options, &session) == PP_ERROR_NETWORK);
  CHECK(lastErrorSays("'town'"));
  CHECK(pp_session_join(nullptr, &join, &options, &session) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_join("", &join, &options, &session) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_join("listed", &join, &options, nullptr) == PP_ERROR_ARGUMENT);
  join.timeout_s = 0;
  CHECK(pp_session_join("listed", &join, &options, &session) == PP_ERROR_ARGUMENT);
  join.timeout_s = 1;
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
  PP_REQUIRE_OK(pp_session_publish_camera(anna, &place));
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
  CHECK(pp_session_publish_camera(anna, &place) == PP_ERROR_ARGUMENT);
  PP_CHECK_OK(pp_session_publish_camera(anna, nullptr));
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
          return pp_network_discover(&network, 60, nullptr, 0, &count);
        },
        most);
    refuses(
        [](const pp_network& network) {
          pp_join_options join = pp_default_join_options();
          join.network = &network;
          join.timeout_s = 60;
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
  CHECK(pp_session_other_hands(ball.session, nullptr, 0, &count) == PP_ERROR_STATE);
  CHECK(pp_session_settle(ball.session, 1, nullptr) == PP_ERROR_STATE);
  CHECK(pp_session_cameras(ball.session, nullptr, 0, &count) == PP_ERROR_STATE);
  CHECK(pp_session_publish_camera(ball.session, nullptr) == PP_ERROR_STATE);
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
  CHECK(pp_session_other_hands(session, nullptr, 0, &count) == PP_ERROR_HANDLE);
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
  options.log = [](void* user, std::int32_t, const char* line) {
    auto& to = *static_cast<Heard*>(user);
    if (std::string(line).find("fetches the points") == std::string::npos) return;
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

TEST_CASE("a stroke whose server does not answer, and the close after it, say so within their timeout") {
  if (!isBuilt()) return;
  StandingServer server("silent");
  const pp_network network = ownNetwork();
  pp_join_options join = pp_default_join_options();
  join.network = &network;
  join.timeout_s = 2;
  pp_session_options options = cpuOptions();
  options.mm_per_unit = 0;
  pp_session session{};
  PP_REQUIRE_OK(pp_session_join("silent", &join, &options, &session));
  touch(session, pathOf(pressPath(1)));
  server.stand();
  const auto rows = pressPath(4);
  const pp_path path = pathOf(rows);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 6;
  std::vector<pp_tick> ticks(200);
  std::uint64_t count = 7;
  const auto before = std::chrono::steady_clock::now();
  const auto since_s = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count(); };
  PP_CHECK_FAILS(pp_session_stroke(session, &path, &brush, ticks.data(), ticks.size(), &count), PP_ERROR_NETWORK,
                 "the server has not confirmed this stroke within 2 s");
  CHECK(count == 0);
  CHECK(ticks.back().t_s == 0);
  CHECK(since_s() < 2 + 3);  // the stroke itself, and a busy machine
  for (const auto undo : {true, false}) {
    const double begun_s = since_s();
    const pp_status status = undo ? pp_session_undo(session, 1, &count) : pp_session_redo(session, 1, &count);
    CHECK(since_s() - begun_s < 2 + 1.5);
    CHECK(status == PP_ERROR_NETWORK);
    CHECK_MESSAGE(lastErrorSays(undo ? "not confirmed this undo" : "not confirmed this redo"),
                  std::string(pp_last_error()));
    CHECK(count == 1);
  }
  const double begun_s = since_s();
  PP_CHECK_FAILS(pp_session_close(session), PP_ERROR_NETWORK, "may be lost; the session is closed");
  CHECK(since_s() - begun_s < 2 + 1.5);
  CHECK(pp_session_close(session) == PP_ERROR_HANDLE);
  server.goOn();
}

TEST_CASE("closing a session delivers a pulled hand's last edits, even if the server is halted for a while") {
  if (!isBuilt()) return;
  StandingServer server("standing");
  pp_session_options options = cpuOptions();
  options.budget_us = 100'000;
  const pp_session session = joined("standing", "anna", options);
  pushUntilDented(session);
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

}  // namespace palpate::sharing_calls_test
