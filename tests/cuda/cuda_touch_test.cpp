#include "engine/cuda/cuda_touch.hpp"

#include <algorithm>

#include "engine/contact/contact_reference.hpp"
#include "tests/contact/sheet.hpp"
#include "tests/cuda/cuda_fixture.hpp"
#include "tests/near.hpp"

namespace palpate::cuda_touch_test {

namespace {

// Several paths over a shape; a jump that takes many sub-steps releases contact between them.
std::vector<DVec3> walksOver(const Scene& scene, std::size_t ticks) {
  std::vector<DVec3> path;
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    std::ranges::copy(wanderingPath(scene, ticks, 0.5 * scene.radius, seed), std::back_inserter(path));
    path.push_back(1000.0 * path.back());
  }
  return path;
}

std::vector<Contact> referenceAnswers(const Scene& scene, const std::vector<DVec3>& path) {
  ContactReference reference(scene.cloud, scene.radius);
  std::vector<Contact> answers;
  for (const DVec3& hip : path) answers.push_back(reference.query({.hip = hip}, 0));
  return answers;
}

// The contacts agree within the rounding of single precision.
void checkPlay(const std::vector<Contact>& gpu, const std::vector<Contact>& cpu, double radius) {
  std::size_t disagreed = 0, neighboursDiffer = 0;
  double worstProxy = 0, worstNormal_deg = 0;
  for (std::size_t i = 0; i < cpu.size(); ++i) {
    neighboursDiffer += gpu[i].neighbours != cpu[i].neighbours;
    if (gpu[i].touching != cpu[i].touching) {
      ++disagreed;
      continue;
    }
    worstProxy = std::max(worstProxy, glm::distance(gpu[i].proxy, cpu[i].proxy) / radius);
    if (glm::length(cpu[i].normal) > 0 && glm::length(gpu[i].normal) > 0)
      worstNormal_deg = std::max(worstNormal_deg, angleBetween_deg(gpu[i].normal, cpu[i].normal));
  }
  CHECK(disagreed == 0);
  CHECK(worstProxy < 1e-4);
  CHECK(worstNormal_deg < 0.1);
  CHECK(neighboursDiffer * 20 < cpu.size());  // points within rounding of the support radius
}

// Every method, at a path over a cloud; `cell` 0: the support radius.
void checkEveryMethod(const PointCloud& cloud, double radius, const std::vector<DVec3>& path,
                      const std::vector<Contact>& expected, double cell = 0, double friction = 0) {
  for (const CudaMethod method : allCudaMethods()) {
    CAPTURE(nameOf(method));
    CudaTouchOptions options = cudaOptions(cloud, radius, method, cell);
    options.friction = friction;
    CudaTouch touch(cloud, options);
    checkPlay(answersTo(touch, path), expected, radius);
  }
}

std::size_t touchedTicks(const std::vector<Contact>& answers) {
  return static_cast<std::size_t>(std::ranges::count_if(answers, &Contact::touching));
}

}  // namespace

TEST_CASE("every CUDA method agrees with the reference over random paths on every shape") {
  NEEDS_CUDA_DEVICE();
  for (const std::string_view name : shapeNames()) {
    CAPTURE(name);
    const Scene scene = makeScene(name, 20'000);
    const auto path = walksOver(scene, 150);
    const auto expected = referenceAnswers(scene, path);
    CHECK(touchedTicks(expected) > 90);
    CHECK(touchedTicks(expected) < expected.size());
    checkEveryMethod(scene.cloud, scene.radius, path, expected);
  }
}

TEST_CASE("CUDA feels both faces, the edges and the friction of sheets as double precision does") {
  NEEDS_CUDA_DEVICE();
  constexpr double kRadius = 2;
  for (const double thickness : {0.0, 0.4}) {
    CAPTURE(thickness);
    const PointCloud cloud = sheet(thickness);
    std::vector<DVec3> path;  // down and up through the plane, from the middle of the sheet to past its edge
    for (int i = 0; i < 700; ++i) path.emplace_back(0.033 * i, 0.1 + 0.01 * i, -0.2 + 3.5 * std::cos(0.06 * i));
    ContactReference reference(cloud, {.radius = kRadius}, 0.3);
    std::vector<Contact> expected;
    for (const DVec3& hip : path) expected.push_back(reference.query({.hip = hip}, 0));
    CHECK(touchedTicks(expected) > 200);
    checkEveryMethod(cloud, kRadius, path, expected, 0, 0.3);
  }
}

TEST_CASE("CUDA methods agree with the reference when the support radius spans one, three and seven cells a side") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("bumpy-sphere", 10'000);
  const auto path = walksOver(scene, 60);
  const auto expected = referenceAnswers(scene, path);
  for (const double cells : {1.0, 3.0, 7.0}) {
    CAPTURE(cells);
    const double cell = 2 * scene.radius / cells;
    REQUIRE(cell > smallestCell(scene.radius));
    checkEveryMethod(scene.cloud, scene.radius, path, expected, cell);
  }
}

TEST_CASE("CUDA methods agree with the reference far from the origin and when a patch overflows shared memory") {
  NEEDS_CUDA_DEVICE();
  const Scene far = makeScene("torus", 10'000, DVec3(1e6, -2e6, 3e6));
  Scene wide = makeScene("sphere", 20'000);
  wide.radius = 16 * wide.spacing;
  for (const Scene* scene : std::initializer_list<const Scene*>{&far, &wide}) {
    const auto path = wanderingPath(*scene, 80, 0.3 * scene->radius, 5);
    const auto expected = referenceAnswers(*scene, path);
    CHECK(touchedTicks(expected) > 10);
    checkEveryMethod(scene->cloud, scene->radius, path, expected);
  }
}

TEST_CASE("all CUDA methods except brute force give identical answers, and every method is deterministic") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sculpture", 50'000);
  const auto path = walksOver(scene, 100);
  for (const double cell : {scene.radius, smallestCell(scene.radius)}) {
    const auto answersOf = [&](CudaMethod method) {
      CudaTouch touch(scene.cloud, cudaOptions(scene.cloud, scene.radius, method, cell));
      return answersTo(touch, path);
    };
    const auto fused = answersOf(CudaMethod::fused);
    for (const CudaMethod method : allCudaMethods()) {
      CAPTURE(nameOf(method));
      const auto once = answersOf(method);
      CHECK(differences(once, answersOf(method)) == 0);
      if (method != CudaMethod::brute) CHECK(differences(once, fused) == 0);
    }
  }
}

TEST_CASE("clouds of at most two points are never touched with CUDA") {
  NEEDS_CUDA_DEVICE();
  for (const CudaMethod method : allCudaMethods()) {
    CAPTURE(nameOf(method));
    for (const std::size_t count : {0, 1, 2}) {
      CAPTURE(count);
      const PointCloud cloud = pointsInOnePlace(count, Vec3(1, 2, 3));
      CudaTouch touch(cloud, cudaOptions(cloud, 1, method));
      for (const Contact& contact : answersTo(touch, {{1, 2, 5}, {1, 2, 3.5}, {1, 2, 3.1}, {1, 2, 2.9}, {1, 2, 2}})) {
        CHECK_FALSE(contact.touching);
        CHECK(contact.neighbours <= count);
      }
    }
  }
}

TEST_CASE("a hundred thousand coincident points can be touched with CUDA") {
  NEEDS_CUDA_DEVICE();
  const PointCloud cloud = pointsInOnePlace(100'000, Vec3(1, 2, 3));
  for (const CudaMethod method : allCudaMethods()) {
    CAPTURE(nameOf(method));
    CudaTouch touch(cloud, cudaOptions(cloud, 1, method));
    const auto answers = answersTo(touch, {{1, 2, 3.5}, {1, 2, 2.8}});
    CHECK_FALSE(answers[0].touching);
    CHECK(answers[1].touching);
    CHECK(answers[1].proxy.z == near(3, 1e-5));
    CHECK((touch.report().shortfalls.thinnedTicks == 0) == (method == CudaMethod::brute));
  }
}

TEST_CASE("with CUDA a HIP that is not finite gives an invalid contact, and the next one is valid") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 5'000);
  for (const CudaMethod method : allCudaMethods()) {
    CAPTURE(nameOf(method));
    CudaTouch touch(scene.cloud, cudaOptions(scene.cloud, scene.radius, method));
    CHECK_FALSE(touch.query({.hip = {0, std::nan(""), 0}}, 0).valid);
    CHECK_FALSE(touch.query({.hip = {1e300, 0, 0}}, 0).valid);
    CHECK(touch.query({.hip = {0, 0, 60}}, 0).valid);
    CHECK(touch.query({.hip = {3e38, 3e38, 3e38}}, 0).valid);
    CHECK(touch.query({.hip = {0, 0, 60}}, 0).valid);
    CHECK(touch.query({.hip = {0, 0, 49}}, 0).valid);
    touch.finish();
  }
}

TEST_CASE("CUDA reports the name of the GPU and the times of build and ticks") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 20'000);
  const auto path = wanderingPath(scene, 300, 0.5 * scene.radius, 1);
  for (const CudaMethod method : allCudaMethods()) {
    CAPTURE(nameOf(method));
    CudaTouch touch(scene.cloud, cudaOptions(scene.cloud, scene.radius, method));
    CHECK(touch.report().machine.ends_with(", CUDA"));
    CHECK(touch.report().build_us > 0);
    CHECK(touch.report().cell == near(scene.radius, 1e-6));
    const auto answers = answersTo(touch, path);
    CHECK(answers.back().gpu_us > 0);
    CHECK(answers.back().gpu_us < 1e6);
  }
}

}  // namespace palpate::cuda_touch_test
