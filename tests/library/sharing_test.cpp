// ctest: waits
// Shared sessions through the C interface: a cloud is served, joined twice, and sculpted by both clients.
#include <atomic>
#include <memory>
#include <thread>

#include "engine/core/clock.hpp"
#include "tests/labels.hpp"
#include "tests/library/serving.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::sharing_test {

namespace {}  // namespace

TEST_CASE("a library built without PALPATE_NETWORK shares nothing, and reports that") {
  if (pp_can_share()) return;
  const BallCloud ball;
  pp_server server{};
  pp_session session{};
  std::uint64_t count = 0;
  CHECK(pp_serve(ball.cloud, "a", nullptr, &server) == PP_ERROR_UNSUPPORTED);
  CHECK(lastErrorSays("built without PALPATE_NETWORK"));
  CHECK(pp_session_join("a", nullptr, nullptr, &session) == PP_ERROR_UNSUPPORTED);
  CHECK(pp_network_discover(nullptr, 0, nullptr, 0, &count) == PP_ERROR_UNSUPPORTED);
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
  CHECK(sharing.connected == 1);
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
  CHECK(std::string(serving.info().access).find("programs of this machine") != std::string::npos);

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
    wrong += pp_session_apply_edits(puller) != PP_OK;
    pp_other_hand hands[4];
    std::uint64_t count = 0;
    wrong += pp_session_other_hands(watcher, hands, 4, &count) != PP_OK;
    if (count == 1 && std::string(hands[0].name) == "puller" && hands[0].sculpts && hands[0].touching &&
        hands[0].position[2] < hands[0].proxy[2])
      ++seen;
    wrong += sharingOf(puller).connected != 1;
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
  pushUntilDented(session);
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
    PP_REQUIRE_OK(pp_live_read_ticks(live, ticks.data(), ticks.size(), &count));
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
  for (const Stopwatch since; since.elapsed_s() < 0.5;) PP_REQUIRE_OK(touchOnce());
  CHECK(lengthOf(contact.force_N) > 0.5);  // a short silence is tolerated
  CHECK(contact.withheld == 0);
  CHECK(comes(20, [&] {
    PP_REQUIRE_OK(touchOnce());
    return lengthOf(contact.force_N) == 0;
  }));
  CHECK(contact.valid == 1);
  CHECK((contact.contact == 1 && contact.withheld == 1));
  CHECK(sharingOf(session).connected == 0);
  CHECK(sharingOf(session).silent_s > 1.8);

  serving = std::make_unique<Serving>("brief");
  CHECK(comes(20, [&] {
    PP_REQUIRE_OK(touchOnce());
    return sharingOf(session).fault[0] != '\0';
  }));
  CHECK(lengthOf(contact.force_N) == 0);
  CHECK(pp_session_apply_edits(session) == PP_ERROR_NETWORK);
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

TEST_CASE("a joined program, also a live one, has the server write its file, if it has one") {
  if (!isBuilt()) return;
  const ScratchFolder folder;
  const std::string file = (folder / "ball.ply").string();
  const Serving without("without");
  const Serving serving("with", false, nullptr, file.c_str());
  pp_server_save save = pp_default_server_save();
  const pp_session refused = joined("without", "anna");
  PP_CHECK_OK(pp_session_save_at_server(refused, 20, &save));
  CHECK(save.written == 0);
  CHECK(save.points == 0);
  CHECK(std::string(save.text) == "it was started without --save");
  const pp_session session = joined("with", "ben");
  stroke(session, pathOf(pressPath(3)), pp_default_brush());
  PP_CHECK_OK(pp_session_save_at_server(session, 20, &save));
  CHECK(save.written == 1);
  CHECK(std::string(save.text) == file);
  const auto saved = [&] {
    pp_cloud cloud{};
    PP_REQUIRE_OK(pp_cloud_read(file.c_str(), nullptr, &cloud));
    return Serving::bytesOf(cloud);
  };
  CHECK(save.points == saved().size() / 6);
  CHECK(isSame(saved(), serving.points()));
  pp_live_options options = pp_default_live_options();
  options.builtin = "press";
  PP_REQUIRE_OK(pp_live_start(session, &options));
  CHECK(pp_session_save_at_server(session, -1, &save) == PP_ERROR_ARGUMENT);
  PP_CHECK_OK(pp_session_save_at_server(session, 20, &save));
  CHECK(save.written == 1);
  PP_CHECK_OK(pp_session_save_at_server(session, 0, &save));
  CHECK(save.written == 0);
  CHECK(std::string(save.text).find("within 0 s") != std::string::npos);
  PP_CHECK_OK(pp_session_close(session));
  CHECK(pp_session_save_at_server(session, 1, &save) == PP_ERROR_HANDLE);
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
    PP_REQUIRE_OK(pp_session_other_hands(who, hands, 4, &count));
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
  CHECK(sharing.connected == 1);
  CHECK(sharing.pings > 0);
  CHECK(sharing.sent == 0);
  CHECK(std::string(sharing.fault).empty());
  const pp_brush push = pp_default_brush();
  stroke(near, pathOf(path), push);
  const pp_sharing sculpted = sharingOf(near);
  CHECK(sculpted.sent > 10);
  CHECK(sculpted.delivered == 1);
  CHECK_FALSE(isSame(serving.points(), before));
  std::uint64_t undone = 0;
  PP_CHECK_OK(pp_session_undo(near, 1, &undone));
  CHECK(undone == 1);
  CHECK(comes(10, [&] { return isSame(serving.points(), before); }));
  const pp_sharing back = sharingOf(near);
  // Edits of a live hand are delivered when it ends.
  PP_CHECK_OK(pp_session_set_brush(near, &push));
  pp_live_options options = pp_default_live_options();
  options.builtin = "press";
  PP_REQUIRE_OK(pp_live_start(near, &options));
  CHECK(comes(30, [&] { return sharingOf(near).sent > back.sent + 20; }));
  PP_CHECK_OK(pp_session_close(near));
  const std::uint64_t states = serving.info().states;
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(serving.info().states == states);
  CHECK(states > back.sent + 20);
  CHECK_FALSE(isSame(serving.points(), before));
  PP_CHECK_OK(pp_session_close(whole));
}

}  // namespace palpate::sharing_test
