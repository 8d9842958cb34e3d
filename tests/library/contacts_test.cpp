// Beginning and end of contacts: by path, tick by tick and live.
#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "tests/library/ball.hpp"
#include "tests/near.hpp"

namespace palpate::contacts_test {

namespace {

struct Heard {
  std::vector<pp_contact_event> events;
  std::vector<std::thread::id> threads;
  pp_session session{};
  int refusals = 0;
  static void hear(void* user, const pp_contact_event* event) {
    auto& self = *static_cast<Heard*>(user);
    self.events.push_back(*event);
    self.threads.push_back(std::this_thread::get_id());
    pp_session_info info = pp_default_session_info();
    self.refusals += pp_session_get_info(self.session, &info) == PP_ERROR_STATE;
  }
  explicit Heard(pp_session of) : session(of) { PP_REQUIRE_OK(pp_session_on_contact(of, &hear, this)); }
  ~Heard() { pp_session_on_contact(session, nullptr, nullptr); }
  Heard(const Heard&) = delete;
  Heard& operator=(const Heard&) = delete;
};

pp_pose poseAt(int tick, double z) { return {.t_s = 1e-3 * tick, .hip = {0.3, -0.2, z}}; }

}  // namespace

TEST_CASE("a hand that presses and withdraws twice is told of two beginnings and two ends, at their ticks") {
  const OpenBall ball;
  Heard heard(ball.session);
  bool touched = false;
  std::vector<std::pair<double, bool>> expected;
  pp_contact inContact{}, contact{};
  for (int i = 0; i < 400; ++i) {
    const pp_pose pose = poseAt(i, 50 + 1.5 * std::cos(2 * std::numbers::pi * i / 200));
    PP_REQUIRE_OK(pp_touch(ball.session, &pose, &contact));
    if ((contact.contact != 0) != touched) {
      touched = contact.contact != 0;
      expected.emplace_back(pose.t_s, touched);
      REQUIRE(heard.events.size() == expected.size());  // before the call returned
      const pp_contact_event& event = heard.events.back();
      CHECK(event.t_s == pose.t_s);
      CHECK(event.begins == (touched ? 1 : 0));
      CHECK(event.hand == 0);
      const pp_contact& of = touched ? contact : inContact;  // at the end: of the last tick in contact
      for (int k = 0; k < 3; ++k) {
        CHECK(event.proxy[k] == of.proxy[k]);
        CHECK(event.normal[k] == of.normal[k]);
        CHECK(event.force_N[k] == of.force_N[k]);
      }
    }
    CHECK(contact.fresh == 1);
    CHECK(contact.age_s == 0);
    if (contact.contact) inContact = contact;
  }
  CHECK(expected.size() == 4);
  CHECK(heard.events.size() == 4);
  CHECK(heard.refusals == 4);  // it cannot call the session
  for (const std::thread::id id : heard.threads) CHECK(id == std::this_thread::get_id());
}

TEST_CASE("a contact ends when the hand is lifted, at a fault, and when a path ends the touching") {
  const OpenBall ball;
  Heard heard(ball.session);
  pp_contact contact{};
  const auto press = [&] {
    for (int i = 0; i < 100; ++i) {
      const pp_pose pose = poseAt(i, 52 - 0.03 * i);
      PP_REQUIRE_OK(pp_touch(ball.session, &pose, &contact));
    }
    REQUIRE(heard.events.size() == 1);
    CHECK(heard.events.back().begins == 1);
  };
  const auto ended = [&] {
    REQUIRE(heard.events.size() == 2);
    CHECK(heard.events.back().begins == 0);
    heard.events.clear();
  };
  press();
  PP_REQUIRE_OK(pp_touch_lift(ball.session));
  ended();
  press();
  const pp_pose outOfReach{.t_s = 0.1, .hip = {1e300, 0, 0}};  // the back end cannot answer this
  PP_REQUIRE_OK(pp_touch(ball.session, &outOfReach, &contact));
  CHECK(contact.valid == 0);
  CHECK(contact.age_s < 0);
  CHECK(lengthOf(contact.force_N) == 0);
  ended();
  PP_REQUIRE_OK(pp_touch_lift(ball.session));
  press();
  const std::vector<double> above{0, 0, 60};
  touch(ball.session, pathOf(above));
  ended();
}

TEST_CASE("by path each contact is told in order once the path is over, of each hand") {
  pp_session_options options = cpuOptions();
  options.hands = 2;
  const OpenBall ball(options);
  Heard heard(ball.session);
  const auto first = pressPath(1), second = pressPath(0.5, 150, 10);
  const pp_path one = pathOf(first), other = pathOf(second);
  const std::array<const pp_path*, 2> paths{&one, &other};
  std::vector<pp_tick> ticks(1000);
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_session_touch_hands(ball.session, paths.data(), 2, nullptr, ticks.data(), nullptr, 1000, &count));
  REQUIRE(heard.events.size() == 4);
  CHECK(heard.events[0].begins == 1);
  CHECK(heard.events[0].hand == 0);
  CHECK(heard.events[1].begins == 1);
  CHECK(heard.events[1].hand == 1);
  CHECK(heard.events[1].t_s > heard.events[0].t_s);
  for (const std::size_t i : {2u, 3u}) {
    CHECK(heard.events[i].begins == 0);
    CHECK(heard.events[i].t_s == ticks[count - 1].t_s);
  }
}

TEST_CASE("a live contact is told by the call that reads its ticks, and ends with the session") {
  const OpenBall ball;
  Heard heard(ball.session);
  const std::vector<double> rows{0, 0, 0, 52, 0.05, 0, 0, 49};
  const pp_path path = pathOf(rows, 4);
  pp_live_options options = pp_default_live_options();
  options.path = &path;
  PP_REQUIRE_OK(pp_live_start(ball.session, &options));
  CHECK(pp_session_on_contact(ball.session, nullptr, nullptr) == PP_ERROR_STATE);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  CHECK(heard.events.empty());  // the servo thread calls nothing
  std::vector<pp_tick> all;
  const auto readAll = [&] {
    std::vector<pp_tick> ticks(64);
    std::uint64_t count = 0;
    do {
      PP_REQUIRE_OK(pp_live_read_ticks(ball.session, ticks.data(), ticks.size(), &count));
      all.insert(all.end(), ticks.begin(), ticks.begin() + static_cast<std::ptrdiff_t>(count));
    } while (count > 0);
  };
  for (int i = 0; i < 200 && (all.empty() || !all.back().contact); ++i) {
    readAll();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  REQUIRE(heard.events.size() == 1);
  CHECK(heard.events[0].begins == 1);
  const auto begin = std::ranges::find_if(all, [](const pp_tick& tick) { return tick.contact != 0; });
  CHECK(heard.events[0].t_s == begin->t_s);
  CHECK(heard.events[0].normal[2] == within(1, 0.01));
  PP_REQUIRE_OK(pp_live_stop(ball.session));
  readAll();
  REQUIRE(heard.events.size() == 2);
  CHECK(heard.events[1].begins == 0);
  for (const std::thread::id id : heard.threads) CHECK(id == std::this_thread::get_id());
}

TEST_CASE("a contact function that throws leaves no force, and the call fails with its words") {
  const OpenBall ball;
  PP_REQUIRE_OK(pp_session_on_contact(
      ball.session, [](void*, const pp_contact_event*) { throw std::runtime_error("the bell is broken"); }, nullptr));
  pp_contact contact{};
  pp_status status = PP_OK;
  for (int i = 0; i < 200 && status == PP_OK; ++i) {
    const pp_pose pose = poseAt(i, 52 - 0.02 * i);
    status = pp_touch(ball.session, &pose, &contact);
  }
  CHECK(status == PP_ERROR_FAILED);
  CHECK(lastErrorSays("the bell is broken"));
  CHECK(lengthOf(contact.force_N) == 0);
  CHECK(contact.valid == 0);
}

}  // namespace palpate::contacts_test
