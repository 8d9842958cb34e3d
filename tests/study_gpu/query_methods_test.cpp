// Every query method of the thesis (section 4.3) against the reference, and against the fused step.
#include <algorithm>

#include "engine/contact/contact_reference.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/scenes.hpp"

namespace palpate::query_methods_test {

namespace {

// The fused step in its two forms: one workgroup, and several that share the gather.
struct Way {
  std::string_view name;
  QueryMethod method;
  std::optional<bool> split;
};
constexpr std::array<Way, 5> kOtherWays{{{"fused, split", QueryMethod::fused, true},
                                         {"indirect", QueryMethod::indirect, {}},
                                         {"naive", QueryMethod::naive, {}},
                                         {"two-step", QueryMethod::twoStep, {}},
                                         {"brute", QueryMethod::brute, {}}}};

struct Played {
  std::vector<Contact> contacts;
  TouchShortfalls shortfalls;
  PointCloud cloud;
};

// Wanders in and out at three positions, `stride` path steps per tick.
std::vector<DVec3> leapingPath(const Scene& scene, std::size_t stride, double depth) {
  std::vector<DVec3> path;
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const auto wandering = wanderingPath(scene, 110, depth, seed);
    for (std::size_t i = 0; i < wandering.size(); i += stride) path.push_back(wandering[i]);
    if (seed == 2)
      path.push_back(1000.0 * path.back());  // releases contact; after the first path the HIP jumps through the shape
  }
  return path;
}

class MethodsFixture : public GpuFixture {
 public:
  using GpuFixture::GpuFixture;

 protected:
  Device* player = &device;

  Played play(const PointCloud& cloud, const std::vector<DVec3>& path, TouchOptions options) {
    TouchSide touch(*player, cloud, options);
    Played played{.contacts = {}, .shortfalls = {}, .cloud = cloud};
    for (const DVec3& hip : path) played.contacts.push_back(touch.query({.hip = hip}, 0));
    touch.finish();
    played.shortfalls = touch.report().shortfalls;
    touch.readBack(played.cloud);
    return played;
  }

  // Replays the path with every method, checks each against the fused one and returns the result of the fused one.
  Played checkAllMethods(const PointCloud& cloud, const std::vector<DVec3>& path, TouchOptions options) {
    options.split = false;
    Played fused = play(cloud, path, options);
    for (const Contact& contact : fused.contacts) REQUIRE(contact.valid);
    for (const Way& way : kOtherWays) {
      CAPTURE(way.name);
      options.method = way.method;
      options.split = way.split;
      const Played other = play(cloud, path, options);
      if (way.method == QueryMethod::brute)
        checkClose(other, fused, options.radius);
      else
        checkSame(other, fused);
    }
    return fused;
  }

  static void checkSame(const Played& a, const Played& b) {
    std::size_t differ = 0;
    for (std::size_t i = 0; i < b.contacts.size(); ++i) {
      const Contact &x = a.contacts[i], &y = b.contacts[i];
      differ += x.proxy != y.proxy || x.normal != y.normal || x.touching != y.touching || x.valid != y.valid ||
                x.neighbours != y.neighbours;
    }
    CHECK(differ == 0);
    CHECK(a.shortfalls.thinnedTicks == b.shortfalls.thinnedTicks);
    CHECK(a.shortfalls.truncatedTicks == b.shortfalls.truncatedTicks);
    CHECK(a.cloud.positions == b.cloud.positions);
    CHECK(a.cloud.normals == b.cloud.normals);
  }

  static void checkClose(const Played& a, const Played& b, double radius) {
    double worst = 0;
    std::size_t touchingDiffers = 0, neighboursDiffer = 0;
    for (std::size_t i = 0; i < b.contacts.size(); ++i) {
      const Contact &x = a.contacts[i], &y = b.contacts[i];
      CHECK(x.valid);
      touchingDiffers += x.touching != y.touching;
      neighboursDiffer += x.neighbours != y.neighbours;
      if (x.touching && y.touching) worst = std::max(worst, glm::distance(x.proxy, y.proxy) / radius);
    }
    CHECK(touchingDiffers == 0);
    CHECK(neighboursDiffer <= b.contacts.size() / 50);  // points within rounding of the support radius
    CHECK(worst < 1e-5);
  }

  static void checkAgainstReference(const Scene& scene, const std::vector<DVec3>& path, const Played& played) {
    ContactReference reference(scene.cloud, scene.radius);
    double worst = 0;
    std::size_t touched = 0, differ = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Contact truth = reference.query({.hip = path[i]}, 0);
      const Contact& contact = played.contacts[i];
      touched += truth.touching;
      differ += contact.touching != truth.touching;
      if (contact.touching && truth.touching)
        worst = std::max(worst, glm::distance(contact.proxy, truth.proxy) / scene.radius);
    }
    CHECK(touched > path.size() / 8);
    CHECK(touched < path.size());
    CHECK(differ == 0);
    CHECK(worst < 1e-4);
  }
};

PointCloud cloudOf(std::size_t count, const Vec3& at) {
  PointCloud cloud;
  cloud.positions.assign(count, at);
  cloud.normals.assign(count, Vec3(0, 0, 1));
  return cloud;
}

}  // namespace

TEST_CASE_FIXTURE(CoreValidated<MethodsFixture>,
                  "all query methods agree with each other and with the reference on every shape" * kMoreInFull) {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(name);
    const Scene scene = makeScene(name, 4'000);
    const auto path = leapingPath(scene, byTier<std::size_t>(30, 6), 0.5 * scene.radius);
    checkAgainstReference(scene, path, checkAllMethods(scene.cloud, path, {.radius = scene.radius}));
  }
}

TEST_CASE_FIXTURE(CoreValidated<MethodsFixture>,
                  "all query methods agree where the support radius spans 1, 3 and 7 buckets a side" * kMoreInFull) {
  const Scene scene = makeScene("bumpy-sphere", 5'000);
  const auto path = leapingPath(scene, byTier<std::size_t>(28, 14), 0.5 * scene.radius);
  for (const double cell : {2.5 * scene.radius, scene.radius, scene.radius / 3}) {
    CAPTURE(cell);
    checkAgainstReference(scene, path, checkAllMethods(scene.cloud, path, {.radius = scene.radius, .cell = cell}));
  }
}

TEST_CASE_FIXTURE(CoreValidated<MethodsFixture>, "all query methods agree far from the origin") {
  const Scene scene = makeScene("torus", 4'000, DVec3(1e6, -2e6, 3e6));
  const auto path = leapingPath(scene, 8, 0.5 * scene.radius);
  checkAgainstReference(scene, path, checkAllMethods(scene.cloud, path, {.radius = scene.radius}));
}

TEST_CASE_FIXTURE(MethodsFixture,
                  "no query method writes past its buffers where positions are rounded by whole cells") {
  PointCloud cloud = makeScene("sphere", 3'000).cloud;
  for (Vec3& position : cloud.positions) position = 0.02f * position + Vec3(1e8f, 1e8f, 1e8f);
  cloud.positions.emplace_back(0, 0, 0);
  cloud.normals.emplace_back(0, 0, 1);
  std::vector<DVec3> path;
  for (int i = 0; i < 12; ++i) path.emplace_back(1e8, 1e8, 1e8 + 24 - 4 * i);
  for (const double cell : {0.0, 0.4}) {
    TouchOptions options{.radius = 1, .cell = cell, .split = false};
    const Played fused = play(cloud, path, options);
    for (const Way& way : kOtherWays) {
      CAPTURE(way.name);
      options.method = way.method;
      options.split = way.split;
      const Played other = play(cloud, path, options);
      if (way.method != QueryMethod::brute) checkSame(other, fused);
    }
  }
}

TEST_CASE_FIXTURE(MethodsFixture, "all query methods agree where the cells of a gather share a few buckets") {
  const Scene scene = makeScene("sphere", 900);  // 256 buckets; a gather visits each several times
  const TouchOptions options{.radius = scene.radius, .cell = 0.5 * scene.radius};
  const auto path = leapingPath(scene, 20, 0.5 * scene.radius);
  checkAgainstReference(scene, path, checkAllMethods(scene.cloud, path, options));
}

TEST_CASE_FIXTURE(CoreValidated<MethodsFixture>,
                  "all query methods agree where thousands of points overflow shared memory") {
  Scene scene = makeScene("sphere", 20'000);
  scene.radius = 16 * scene.spacing;
  const auto path = leapingPath(scene, 8, 0.2 * scene.radius);
  const Played fused = checkAllMethods(scene.cloud, path, {.radius = scene.radius});
  checkAgainstReference(scene, path, fused);
  CHECK(std::ranges::max(fused.contacts, {}, &Contact::neighbours).neighbours > shared::kMaxSharedPatch / 2);
}

TEST_CASE_FIXTURE(CoreValidated<MethodsFixture>, "all bucket-based query methods subsample a dense cloud identically") {
  Scene scene = makeScene("sphere", 70'000);
  scene.radius = 30;
  std::vector<DVec3> path;
  for (int i = 0; i < 4; ++i) path.emplace_back(0, 0, 60.0 - 4 * i);
  for (const double cell : {0.0, scene.radius / 3}) {
    TouchOptions options{.radius = scene.radius, .cell = cell, .split = false};
    const Played fused = play(scene.cloud, path, options);
    CHECK(fused.shortfalls.thinnedTicks > 0);
    for (const Way& way : kOtherWays) {
      CAPTURE(way.name);
      options.method = way.method;
      options.split = way.split;
      const Played other = play(scene.cloud, path, options);
      if (way.method != QueryMethod::brute) checkSame(other, fused);
      for (const Contact& contact : other.contacts) CHECK(contact.valid);
    }
  }
}

TEST_CASE_FIXTURE(CoreValidated<MethodsFixture>,
                  "every query method handles clouds of no, one, two and a hundred thousand coincident points") {
  const std::vector<DVec3> path{{1, 2, 5}, {1, 2, 3.5}, {1, 2, 3.1}, {1, 2, 2.8}, {1, 2, 2.5}, {9, 9, 9}};
  for (const std::size_t count : {0, 1, 2, 100'000}) {
    CAPTURE(count);
    const Played fused = checkAllMethods(cloudOf(count, Vec3(1, 2, 3)), path, {.radius = 1});
    const bool touched = std::ranges::any_of(fused.contacts, &Contact::touching);
    CHECK(touched == (count > 2));
  }
}

TEST_CASE_FIXTURE(MethodsFixture, "sculpting gives the same result with every query method") {
  player = &plainDevice();  // tests/edit_gpu validates the passes of an edit
  const Scene scene = makeScene("sphere", 3'000);
  std::vector<DVec3> path;
  for (int i = 0; i <= 20; ++i) path.emplace_back(0.15 * i, 0, 51 - 4 * std::min(1.0, i / 10.0));
  TouchOptions options{.radius = scene.radius, .brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8}};
  const Played fused = play(scene.cloud, path, options);
  CHECK(fused.cloud.positions != scene.cloud.positions);
  for (const Way& way : kOtherWays) {
    CAPTURE(way.name);
    options.method = way.method;
    options.split = way.split;
    const Played other = play(scene.cloud, path, options);
    if (way.method != QueryMethod::brute) {
      checkSame(other, fused);
      continue;
    }
    double worst = 0;
    for (std::size_t i = 0; i < scene.cloud.size(); ++i)
      worst = std::max(worst, double{glm::distance(other.cloud.positions[i], fused.cloud.positions[i])});
    CHECK(worst < 1e-3 * scene.radius);
  }
}

TEST_CASE_FIXTURE(MethodsFixture, "each query method runs its own passes and number of submissions") {
  const Scene scene = makeScene("sphere", 5'000);
  struct Seen {
    std::vector<std::string> names;
    std::vector<bool> waits;
    std::uint64_t threads = 0;  // of the last pass
    Queue::Ticket submissions = 0;
    double gpu_us = 0;
  };
  CommandList nothing(device, device.latencyQueue(), "nothing");
  nothing.begin();
  nothing.end();
  const auto see = [&](TouchOptions options) {
    options.radius = scene.radius;
    TouchSide touch(device, scene.cloud, options);
    touch.query({.hip = {0, 0, 51}}, 0);
    const auto ticketNow = [&] {
      const Queue::Ticket ticket = device.latencyQueue().submit(nothing);
      device.latencyQueue().wait(ticket);
      return ticket;
    };
    const Queue::Ticket before = ticketNow();
    Seen seen{.gpu_us = touch.query({.hip = {0, 0, 49.5}}, 0).gpu_us};
    seen.submissions = ticketNow() - before - 1;
    for (const PassRecord& pass : touch.passes()) {
      seen.names.push_back(pass.name);
      seen.waits.push_back(pass.waits);
      seen.threads = pass.threads;
      CHECK(pass.section.starts_with("contact"));
    }
    CHECK(seen.gpu_us > 0);
    return seen;
  };
  const std::string plan = "contact_gather_plan", buckets = "contact_gather_buckets", step = "contact_contact_step";
  const std::string brute = "contact_gather_brute", sum = "contact_gather_brute_sum";

  const Seen fused = see({}), split = see({.split = true});
  CHECK(fused.names == std::vector{step});
  CHECK(fused.threads == shared::kContactWorkgroup);
  CHECK(split.names == std::vector{step});
  CHECK(split.threads == shared::kSplitWorkgroups * shared::kContactWorkgroup);
  const Seen indirect = see({.method = QueryMethod::indirect});
  CHECK(indirect.names == std::vector{plan, buckets, step});
  CHECK(indirect.waits == std::vector(3, true));
  CHECK(indirect.submissions == 1);
  const Seen twoStep = see({.method = QueryMethod::twoStep});
  CHECK(twoStep.names == std::vector{plan, buckets, step});
  CHECK(twoStep.waits == std::vector(3, true));
  CHECK(twoStep.submissions == 2);
  const Seen all = see({.method = QueryMethod::brute});
  CHECK(all.names == std::vector{brute, sum, brute, step});
  CHECK(all.waits == std::vector(4, true));

  // One dispatch for every cell that a gather may visit; they wait for the plan, not for each other.
  const Seen naive = see({.method = QueryMethod::naive});
  const std::size_t cells = cellsPerGather(makeHashGrid(Vec3(0), scene.radius, 1), scene.radius);
  CHECK(cells == 5 * 5 * 5);
  std::vector<std::string> names(cells + 2, buckets);
  names.front() = plan;
  names.back() = step;
  std::vector<bool> waits(cells + 2, false);
  waits[0] = waits[1] = waits.back() = true;
  CHECK(naive.names == names);
  CHECK(naive.waits == waits);
  CHECK(naive.submissions == 1);
}

TEST_CASE_FIXTURE(MethodsFixture, "a fused gather is split after a large answer or over many cells") {
  const Scene scene = makeScene("sphere", 50'000);
  const auto workgroups = [](const TouchSide& touch) {
    return touch.passes().front().threads / shared::kContactWorkgroup;
  };
  TouchSide wide(device, scene.cloud, {.radius = 20 * scene.spacing});
  CHECK(wide.query({.hip = {0, 0, 50.5}}, 0).neighbours > shared::kSplitNeighbours);
  CHECK(workgroups(wide) == 1);
  wide.query({.hip = {0, 0, 50.4}}, 0);
  CHECK(workgroups(wide) == shared::kSplitWorkgroups);
  wide.query({.hip = {0, 0, 500}}, 0);
  wide.query({.hip = {0, 0, 500}}, 0);
  CHECK(workgroups(wide) == 1);
  TouchSide fine(device, scene.cloud, {.radius = scene.radius, .cell = scene.radius / 3});
  fine.query({.hip = {0, 0, 50.5}}, 0);
  CHECK(workgroups(fine) == shared::kSplitWorkgroups);
}

TEST_CASE("a late two-step query holds the last contact at either step and is answered in the end") {
  const Scene scene = makeScene("sphere", 20'000);
  // GPU-assisted validation waits at every submission, so that no answer is late.
  Device& device = plainDevice();
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .method = QueryMethod::twoStep, .wait = Wait::block});
  touch.query({.time_s = 0, .hip = {0, 0, 51}}, 0);
  const Contact fresh = touch.query({.time_s = 0.001, .hip = {0, 0, 49}}, 0);
  REQUIRE(fresh.touching);

  const Buffer busy(device, 64 << 20, Memory::device, "busy");
  CommandList work(device, device.latencyQueue(), "busy");
  work.begin();
  for (int i = 0; i < 200; ++i) work.fill(busy, 1, busy.bytes());
  work.end();
  constexpr double kNoTime_us = 1;
  const auto isLate = [&](double time_s) {
    const Contact contact = touch.query({.time_s = time_s, .hip = {0, 0, 49}}, kNoTime_us);
    return contact.valid && contact.touching && !contact.fresh;
  };
  const auto lateAtBoth = [&] {
    device.waitIdle();
    device.latencyQueue().submit(work);
    if (!isLate(0.002)) return false;  // before the count is available
    device.waitIdle();
    device.latencyQueue().submit(work);
    return isLate(0.003) && isLate(0.004);  // the count is available, the launch is queued behind other work
  };
  // A busy machine may stop this thread until the answer is available after all.
  bool wasLate = false;
  for (int attempt = 0; attempt < 5 && !wasLate; ++attempt) wasLate = lateAtBoth();
  CHECK(wasLate);
  const Contact after = touch.query({.time_s = 0.005, .hip = {0, 0, 49}}, 0);
  CHECK(after.fresh);
  CHECK(after.proxy == fresh.proxy);
  touch.finish();
}

}  // namespace palpate::query_methods_test
