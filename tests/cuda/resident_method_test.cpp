#include <chrono>
#include <thread>

#include "tests/cuda/cuda_fixture.hpp"

namespace palpate::resident_method_test {

namespace {

using std::chrono::milliseconds;

std::unique_ptr<CudaTouch> residentTouch(const Scene& scene) {
  return std::make_unique<CudaTouch>(scene.cloud, cudaOptions(scene.cloud, scene.radius, CudaMethod::persistent));
}

}  // namespace

TEST_CASE("the persistent kernel answers ten thousand ticks") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 20'000);
  const auto path = wanderingPath(scene, 500, 0.5 * scene.radius, 1);
  const auto touch = residentTouch(scene);
  std::size_t valid = 0, touched = 0;
  for (std::size_t tick = 0; tick < 10'000; ++tick) {
    const Contact contact = touch->query({.hip = path[tick % path.size()]}, 0);
    valid += contact.valid;
    touched += contact.touching;
  }
  touch->finish();
  CHECK(valid == 10'000);
  CHECK(touched > 1000);
}

TEST_CASE("the persistent kernel starts and stops many times, with and without queries") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 2'000);
  for (int cycle = 0; cycle < 50; ++cycle) {
    const auto touch = residentTouch(scene);
    for (int tick = 0; tick < cycle % 3; ++tick) CHECK(touch->query({.hip = {0, 0, 60}}, 0).valid);
    if (cycle % 2) touch->finish();
  }
}

TEST_CASE("the persistent kernel restarts with its contact state after idling and after finish") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 20'000);
  const auto touch = residentTouch(scene);
  CHECK_FALSE(touch->query({.hip = {0, 0, 52}}, 0).touching);
  CHECK(touch->query({.hip = {0, 0, 49}}, 0).touching);
  for (int rest = 0; rest < 3; ++rest) {
    std::this_thread::sleep_for(milliseconds(120));  // longer than the idle timeout of the kernel
    CHECK(touch->query({.hip = {0, 0, 49}}, 0).touching);
    touch->finish();
    CHECK(touch->query({.hip = {0, 0, 49}}, 0).touching);
  }
}

TEST_CASE("two persistent kernels run side by side, with other work on the GPU") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 20'000);
  const auto one = residentTouch(scene);
  CHECK(one->query({.hip = {0, 0, 52}}, 0).valid);
  const auto other = residentTouch(scene);  // allocates and frees memory while the first one runs
  CudaTouch fused(scene.cloud, cudaOptions(scene.cloud, scene.radius, CudaMethod::fused));
  for (int tick = 0; tick < 200; ++tick) {
    const Pose pose{.hip = {0, 0, 52 - 0.015 * tick}};
    const Contact a = one->query(pose, 0), b = other->query(pose, 0), c = fused.query(pose, 0);
    REQUIRE(a.valid);
    REQUIRE(b.valid);
    CHECK(a.proxy == c.proxy);
    CHECK(b.proxy == c.proxy);
  }
}

TEST_CASE("CUDA keeps a budget too short for any answer, and uses late answers") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 20'000);
  for (const CudaMethod method : allCudaMethods()) {
    CAPTURE(nameOf(method));
    CudaTouch touch(scene.cloud, cudaOptions(scene.cloud, scene.radius, method));
    CHECK(touch.query({.time_s = 0, .hip = {0, 0, 52}}, 0).valid);
    std::size_t fresh = 0;
    for (int tick = 1; tick <= 300; ++tick) {
      const Contact contact = touch.query({.time_s = 1e-3 * tick, .hip = {0, 0, 52 - 0.01 * tick}}, 1);
      REQUIRE(contact.valid);
      fresh += contact.fresh;
      if (tick % 3 == 0) std::this_thread::sleep_for(milliseconds(1));
    }
    touch.finish();
    CHECK(fresh < 300);
    CHECK(touch.query({.time_s = 0.301, .hip = {0, 0, 49}}, 1e6).touching);
  }
}

}  // namespace palpate::resident_method_test
