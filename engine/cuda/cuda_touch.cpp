#include "engine/cuda/cuda_touch.hpp"

#include <array>

#include "engine/cuda/cuda_state.hpp"

namespace palpate {

namespace {
constexpr std::array<std::string_view, 7> kMethodNames{"brute", "two-step", "naive-dp",  "array-dp",
                                                       "fused", "graph",    "persistent"};
}

std::span<const std::string_view> cudaMethodNames() { return kMethodNames; }
std::string_view nameOf(CudaMethod method) { return kMethodNames[static_cast<std::size_t>(method)]; }

CudaTouch::CudaTouch(const PointCloud& cloud, const CudaTouchOptions& options)
    : state_(std::make_unique<State>(cloud, options)) {}
CudaTouch::~CudaTouch() = default;

std::span<const Contact> CudaTouch::ask(std::span<const Pose> poses, double budget_us) noexcept {
  PALPATE_CHECK_EQ(poses.size(), 1u);
  answer_ = state_->query(poses.front(), budget_us);
  return {&answer_, 1};
}
void CudaTouch::finish() { state_->finish(); }
std::size_t CudaTouch::readBack(PointCloud& cloud) const { return state_->readBack(cloud); }

BackendReport CudaTouch::report() const {
  return {.machine = state_->machine,
          .cell = state_->cell,
          .build_us = state_->buildTime_us,
          .editTimes_us = state_->editTimes_us,
          .firstEdit_s = state_->firstEditTime_s,
          .shortfalls = state_->shortfalls,
          .index = {.built = state_->editTimes_us.size()}};
}

}  // namespace palpate
