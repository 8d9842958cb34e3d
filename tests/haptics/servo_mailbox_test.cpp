// Commands from other threads, between the ticks of a servo loop.
#include "haptics/servo_mailbox.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <random>
#include <thread>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/devices/guided_touch.hpp"
#include "haptics/devices/simulated_touch.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/allocation_count.hpp"
#include "tests/haptics/contact_doubles.hpp"

namespace palpate::servo_mailbox_test {

namespace {

/// A loop over a sphere, on a thread of its own, until it is destroyed.
class Running {
 public:
  explicit Running(ServoMailbox& mailbox, SteppedClock* clock = nullptr) {
    mailbox.open(clock);
    if (clock) clock->hold();
    thread_ = std::jthread([this, &mailbox, clock] {
      SimulatedTouch hand(Path({{0, {0, 0, 9}}, {1, {0, 0, 9}}}), {});
      SphereContact sphere(10);
      ServoLoop loop(hand, sphere, ForceLaw({}, {}),
                     {.endless = true, .realtime = true, .clock = clock, .stop = &stop_, .mailbox = &mailbox});
      ticks_ = loop.run().step_us.count();
      mailbox.close();
      if (clock) clock->leave();
    });
    if (clock) letGo_ = [clock] { clock->letGo(); };
  }
  ~Running() { end(); }
  std::uint64_t end() {
    stop_ = true;
    if (letGo_) letGo_();
    if (thread_.joinable()) thread_.join();
    return ticks_;
  }

 private:
  std::atomic<bool> stop_ = false;
  std::uint64_t ticks_ = 0;
  std::function<void()> letGo_;
  std::jthread thread_;
};

}  // namespace

TEST_CASE("commands of several threads run on the loop's thread, each once, and those of a thread in their order") {
  ServoMailbox mailbox;
  std::array<std::vector<int>, 4> ran;
  std::atomic<int> elsewhere = 0;
  for (auto& each : ran) each.reserve(200);
  {
    Running loop(mailbox);
    std::thread::id loops;
    REQUIRE(mailbox.post([&loops]() noexcept { loops = std::this_thread::get_id(); }));
    std::vector<std::jthread> posters;
    for (std::size_t i = 0; i < ran.size(); ++i)
      posters.emplace_back([&, i] {
        for (int k = 0; k < 50; ++k)
          mailbox.post([&ran, &elsewhere, &loops, i, k]() noexcept {
            ran[i].push_back(k);
            elsewhere += std::this_thread::get_id() != loops;
          });
      });
  }
  CHECK(elsewhere == 0);
  for (const auto& each : ran) {
    REQUIRE(each.size() == 50);
    CHECK(std::ranges::is_sorted(each));
  }
}

TEST_CASE("a held clock lets commands pass, while no time passes for the hand") {
  ServoMailbox mailbox;
  SteppedClock clock;
  Running loop(mailbox, &clock);
  clock.goOnTo(0.01);
  int count = 0;
  for (int i = 0; i < 20; ++i) CHECK(mailbox.post([&count]() noexcept { ++count; }));
  CHECK(count == 20);
  CHECK(loop.end() <= 12);
}

TEST_CASE("without a loop, and after its end, a command is returned to its poster") {
  ServoMailbox mailbox;
  int count = 0;
  const auto post = [&] { return mailbox.post([&count]() noexcept { ++count; }); };
  CHECK_FALSE(post());
  {
    Running loop(mailbox);
    CHECK(post());
  }
  CHECK_FALSE(post());
  CHECK(count == 1);
  mailbox.open();
  std::jthread late([&] { CHECK_FALSE(post()); });  // waits, and the loop ends first
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  mailbox.close();
  late.join();
  CHECK(count == 1);
}

TEST_CASE("a loop that hangs gives its posters a timeout, and never runs a withdrawn command") {
  ServoMailbox mailbox(0.5);  // a busy machine runs the loop below within that time
  mailbox.open();
  std::atomic<int> ran = 0, timeouts = 0;
  {
    std::vector<std::jthread> posters;
    for (std::size_t i = 0; i < ServoMailbox::kSlots + 3; ++i)
      posters.emplace_back([&] {
        try {
          mailbox.post([&ran]() noexcept { ++ran; });
        } catch (const CommandTimeout&) {
          ++timeouts;
        }
      });
  }
  CHECK(timeouts == ServoMailbox::kSlots + 3);
  std::jthread([&] {
    for (int tick = 0; tick < 5; ++tick) mailbox.serve();
  }).join();
  CHECK(ran == 0);
  const std::jthread loop([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      mailbox.serve();
      std::this_thread::yield();
    }
  });
  for (int i = 0; i < 20; ++i) CHECK(mailbox.post([&ran]() noexcept { ++ran; }));
  CHECK(ran == 20);
}

TEST_CASE("a command on the loop's own thread is refused at once") {
  ServoMailbox mailbox;
  Running loop(mailbox);
  bool isRefused = false;
  CHECK(mailbox.post([&mailbox, &isRefused]() noexcept {
    try {
      mailbox.post([]() noexcept {});
    } catch (const CommandTimeout&) {
    } catch (const Error&) {
      isRefused = true;
    }
  }));
  CHECK(isRefused);
}

TEST_CASE("a tick runs a few commands at most, and serving them allocates nothing") {
  ServoMailbox mailbox;
  mailbox.open();
  std::atomic<int> ran = 0;
  std::vector<std::jthread> posters;
  for (int i = 0; i < 8; ++i) posters.emplace_back([&] { mailbox.post([&ran]() noexcept { ++ran; }); });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // all are posted
  countedThread = std::this_thread::get_id();
  allocations = 0;
  counting = true;
  int most = 0;
  for (int before = 0; ran < 8; before = ran) {
    mailbox.serve();
    most = std::max(most, ran - before);
  }
  counting = false;
  countedThread = std::thread::id();
  CHECK(allocations == 0);
  CHECK(most <= static_cast<int>(ServoMailbox::kMaxPerTick));
}

TEST_CASE("each command runs once or is returned, however loops begin and end") {
  ServoMailbox mailbox;
  std::atomic<int> ran = 0, posted = 0;
  std::atomic<bool> isOver = false;
  std::vector<std::jthread> posters;
  for (int i = 0; i < 3; ++i)
    posters.emplace_back([&] {
      while (!isOver) posted += mailbox.post([&ran]() noexcept { ++ran; });
    });
  std::mt19937 random(3);
  for (int loop = 0; loop < 40; ++loop) {
    mailbox.open();
    std::jthread thread([&mailbox, ticks = random() % 20] {
      for (std::size_t tick = 0; tick < ticks; ++tick) {
        mailbox.serve();
        std::this_thread::sleep_for(std::chrono::microseconds(50));
      }
      mailbox.close();
    });
  }
  isOver = true;
  posters.clear();
  CHECK(ran == posted);
  CHECK(ran > 0);
}

TEST_CASE("a loop sleeps while a guided stylus rests, and wakes within a few ticks of an aim, a command and its end") {
  ServoMailbox mailbox;
  mailbox.open();
  GuidedTouch stylus({}, {0, 0, 90}, {.countsTicks = true});
  SphereContact sphere(10);
  std::atomic<bool> stop = false;
  struct Count final : TickRecorder {
    void ticked(const TraceRow&, const DeviceState&) noexcept override { ++number; }
    std::atomic<std::uint64_t> number = 0;
  } count;
  const std::atomic<std::uint64_t>& ticks = count.number;
  std::uint64_t missed = 1;
  std::jthread thread([&] {
    ServoLoop loop(stylus, sphere, ForceLaw({}, {}),
                   {.endless = true, .realtime = true, .stop = &stop, .recorder = &count, .mailbox = &mailbox});
    missed = loop.run().trace().missedTicks;
    mailbox.close();
  });
  const auto comesTo = [](const auto& sign) {
    for (const Stopwatch since; since.elapsed_s() < 10 && !sign();)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return sign();
  };
  const auto isAsleep = [&] {
    const std::uint64_t before = ticks;
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    return before > 0 && ticks == before;
  };
  CHECK(comesTo(isAsleep));
  std::uint64_t before = ticks;
  CHECK(stylus.aim({0, 0, 40}, false));
  CHECK_FALSE(stylus.aim({0, 0, 40}, false));
  mailbox.wake();
  CHECK(comesTo([&] { return ticks > before + 100; }));  // until the hand is there
  CHECK(comesTo(isAsleep));
  before = ticks;
  CHECK(mailbox.post([]() noexcept {}));
  CHECK(comesTo([&] { return ticks > before; }));
  CHECK(comesTo(isAsleep));
  stop = true;
  mailbox.wake();
  thread.join();
  CHECK(missed < ticks / 10);  // the ticks that were slept through are not missed
}

}  // namespace palpate::servo_mailbox_test
