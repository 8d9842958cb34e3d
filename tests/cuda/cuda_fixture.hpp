// Shared code of the tests of the CUDA back end. Without a GPU for CUDA each test reports a skip and returns.
#pragma once

#include <doctest/doctest.h>

#include "engine/contact/contact_step.hpp"
#include "engine/cuda/cuda_error.hpp"
#include "engine/cuda/cuda_touch.hpp"
#include "tests/scenes.hpp"

#define NEEDS_CUDA_DEVICE()               \
  do {                                    \
    if (!cudaDevicePresent()) {           \
      MESSAGE("skipped: no CUDA device"); \
      return;                             \
    }                                     \
  } while (false)

namespace palpate {

inline std::vector<CudaMethod> allCudaMethods() {
  std::vector<CudaMethod> methods;
  for (std::size_t i = 0; i < cudaMethodNames().size(); ++i) methods.push_back(static_cast<CudaMethod>(i));
  return methods;
}

/// Options for a cloud; `cell` 0: the support radius.
inline CudaTouchOptions cudaOptions(const PointCloud& cloud, double radius, CudaMethod method, double cell = 0) {
  return {.radius = radius,
          .grid = makeHashGrid(Vec3(boundsOf(cloud).min), cell > 0 ? cell : radius, cloud.size()),
          .method = method};
}

/// Answers of a back end at every position of a path. An invalid answer fails the test, with the reason.
inline std::vector<Contact> answersTo(TouchBackend& touch, const std::vector<DVec3>& path) {
  std::vector<Contact> answers;
  for (const DVec3& hip : path) {
    answers.push_back(touch.query({.time_s = 1e-3 * static_cast<double>(answers.size()), .hip = hip}, 0));
    if (!answers.back().valid) touch.finish();
    REQUIRE(answers.back().valid);
  }
  touch.finish();
  return answers;
}

/// Number of answers that differ in any bit of proxy, normal, touching or neighbours.
inline std::size_t differences(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  REQUIRE(a.size() == b.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    different += a[i].proxy != b[i].proxy || a[i].normal != b[i].normal || a[i].touching != b[i].touching ||
                 a[i].neighbours != b[i].neighbours;
  return different;
}

inline PointCloud pointsInOnePlace(std::size_t count, const Vec3& at) {
  PointCloud cloud;
  cloud.positions.assign(count, at);
  cloud.normals.assign(count, Vec3(0, 0, 1));
  return cloud;
}

}  // namespace palpate
