// A contact step that is submitted before its question.
#include <cmath>
#include <cstring>

#include "engine/contact/contact_step.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/scenes.hpp"

namespace palpate::waiting_step_test {

namespace {

// A step over a sphere, with the lists that it answers questions by.
class Asked {
 public:
  Asked(Device& device, const Scene& scene)
      : queue_(device.latencyQueue()),
        live_(device, scene.cloud),
        grid_(makeHashGrid(Vec3(-50), scene.radius, live_.count())),
        hash_(device, grid_, live_.count()),
        logHead_(Buffer::of<std::uint32_t>(device, 1, Memory::upload, "log head")),
        step_(device, {.radius = scene.radius, .friction = 0.2}, grid_, live_.count()) {
    logHead_.mapped<std::uint32_t>()[0] = 0;
    hash_.build(live_);
    for (std::uint32_t i = 0; i < step_.lists(); ++i) {
      lists_.push_back(std::make_unique<CommandList>(device, queue_, "query"));
      lists_.back()->begin();
      step_.record(*lists_.back(), i, hash_.view(live_.front(), live_.slots()), logHead_.address());
      lists_.back()->end();
    }
  }

  void run(std::uint32_t list) { queue_.run(*lists_[list]); }
  ContactStep& step() { return step_; }

 private:
  Queue& queue_;
  LiveCloud live_;
  HashGrid grid_;
  SpatialHash hash_;
  Buffer logHead_;
  ContactStep step_;
  std::vector<std::unique_ptr<CommandList>> lists_;
};

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "a step that waits answers as one that does not, and its time leaves the wait out") {
  const Scene scene = makeScene("sphere", 5'000);
  Asked plain(device, scene), waiting(device, scene);
  const std::uint32_t alone = waiting.step().firstList(), waits = waiting.step().waiting(alone);
  REQUIRE(waiting.step().canWait());
  std::uint32_t tick = 0;
  int touching = 0;
  for (int i = 0; i < 24; ++i) {
    CAPTURE(i);
    // Down to the surface, into it and along it; then away.
    const float height = i < 10 ? 51.0f - 0.3f * static_cast<float>(i) : i < 20 ? 48.0f : 55.0f;
    const float angle = 0.03f * static_cast<float>(i);
    const Vec3 hip = height * Vec3(std::sin(angle), 0, std::cos(angle));
    waiting.step().awaitAnother(true);
    ++tick;
    if (i % 5 == 4) {
      waiting.step().withdraw(tick);
      waiting.run(waits);
      CHECK_FALSE(waiting.step().hasAnswered(tick));
      CHECK(waiting.step().answeringTime_us(waits, 100) == 0);
      waiting.step().awaitAnother(true);
      ++tick;
    }
    for (ContactStep* step : {&plain.step(), &waiting.step()}) step->put({.pose = {.hip = hip, .tick = tick}});
    plain.run(alone);
    waiting.run(waits);
    REQUIRE(plain.step().hasAnswered(tick));
    REQUIRE(waiting.step().hasAnswered(tick));
    const shared::ContactSample expected = plain.step().sample(), answer = waiting.step().sample();
    CHECK(std::memcmp(&answer, &expected, sizeof(answer)) == 0);
    touching += answer.touching != shared::kFree;
    const double time_us = waiting.step().answeringTime_us(waits, 100);
    CHECK(time_us <= 100);
    CHECK((time_us > 0) == device.hasClock());
    CHECK(waiting.step().answeringTime_us(alone, 100) == 100);
  }
  CHECK(touching > 10);
}

TEST_CASE_FIXTURE(GpuFixture, "a step that waits ends without an answer if there is no newer question") {
  const Scene scene = makeScene("sphere", 1'000);
  Asked asked(device, scene);
  asked.step().put({.pose = {.hip = {0, 0, 49}, .tick = 7}});
  asked.step().awaitAnother(true);
  asked.run(asked.step().waiting(asked.step().firstList()));
  CHECK_FALSE(asked.step().hasAnswered(7));
}

}  // namespace palpate::waiting_step_test
