// A program that forks while it has open sessions: its child, and a child that another program replaces.
// ctest: waits
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <functional>

#include "tests/labels.hpp"
#include "tests/library/desk.hpp"

namespace palpate::fork_test {

namespace {

/// The wait status of a child that has 20 s.
int statusOf(const std::function<void()>& child) {
  const pid_t number = ::fork();
  REQUIRE(number >= 0);
  if (number == 0) {
    ::alarm(20);
    child();
    ::_exit(99);
  }
  int status = 0;
  REQUIRE(::waitpid(number, &status, 0) == number);
  return status;
}

/// In a child: the calls that fail otherwise, as bits.
int wrongAnswers(pp_session session, pp_cloud cloud) {
  const pp_pose pose{.t_s = 0, .hip = {0, 0, 49}};
  pp_contact contact{};
  pp_tick tick{};
  std::uint64_t count = 0;
  pp_cloud now{};
  const auto isRefused = [](pp_status status) { return status == PP_ERROR_STATE && lastErrorSays("fork"); };
  int wrong = 0;
  wrong |= isRefused(pp_touch(session, &pose, &contact)) ? 0 : 1;
  wrong |= isRefused(pp_live_read_ticks(session, &tick, 1, &count)) ? 0 : 2;
  wrong |= isRefused(pp_live_stop(session)) ? 0 : 4;
  wrong |= isRefused(pp_session_cloud(session, &now)) ? 0 : 8;
  wrong |= pp_session_close(session) == PP_OK ? 0 : 16;
  pp_session_options options = cpuOptions();
  pp_session own{};
  const pp_pose outside{.t_s = 0, .hip = {0, 0, 52}}, inside{.t_s = 0.001, .hip = {0, 0, 49}};
  wrong |= pp_session_open(cloud, &options, &own) == PP_OK && pp_touch(own, &outside, &contact) == PP_OK &&
                   pp_touch(own, &inside, &contact) == PP_OK && contact.contact == 1 && pp_session_close(own) == PP_OK
               ? 0
               : 32;
  return wrong;
}

}  // namespace

TEST_CASE("a child of fork() neither hangs nor reaches the device of its parent, whose force goes on" * kClock) {
  Desk desk;
  const OpenBall ball(smallBall());
  const pp_live_options live = haply();
  desk.rest();
  PP_REQUIRE_OK(pp_live_start(ball.session, &live));
  std::vector<pp_tick> ticks;
  const auto readUntil = [&](const std::function<bool(const pp_tick&)>& is) {
    bool came = false;
    return comes(30, [&] {
      std::vector<pp_tick> more(512);
      std::uint64_t count = 0;
      PP_REQUIRE_OK(pp_live_read_ticks(ball.session, more.data(), more.size(), &count));
      ticks.insert(ticks.end(), more.begin(), more.begin() + static_cast<std::ptrdiff_t>(count));
      came = came || std::any_of(more.begin(), more.begin() + static_cast<std::ptrdiff_t>(count), is);
      return came;
    });
  };
  REQUIRE(readUntil([](const pp_tick&) { return true; }));
  desk.tap();
  REQUIRE(readUntil([](const pp_tick& tick) { return lengthOf(tick.force_N) > 0.4; }));

  CHECK(WEXITSTATUS(statusOf([&] { ::_exit(wrongAnswers(ball.session, ball.cloud.cloud)); })) == 0);
  CHECK(statusOf([] { std::exit(0); }) == 0);  // with everything that a program does at its end
  CHECK(WTERMSIG(statusOf([] { ::raise(SIGTERM); })) == SIGTERM);
  CHECK(statusOf([] { ::execl("/bin/true", "true", nullptr); }) == 0);

  const double forked_s = ticks.back().t_s;
  REQUIRE(readUntil([&](const pp_tick& tick) { return tick.t_s > forked_s + 1 && lengthOf(tick.force_N) > 0.4; }));
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  const Desk::Received received = desk.leave();
  CHECK(received.most_N > 0.4);
  CHECK(received.last_N == 0);
  CHECK(received.gap_s < 0.5);
}

}  // namespace palpate::fork_test
