#include "engine/cuda/cuda_touch.hpp"

#include <array>

#include "engine/cuda/cuda_side.hpp"

namespace palpate {

namespace {
constexpr std::array<std::string_view, 7> kMethodNames{"brute", "two-step", "naive-dp",  "array-dp",
                                                       "fused", "graph",    "persistent"};
}

std::span<const std::string_view> cudaMethodNames() { return kMethodNames; }
std::string_view nameOf(CudaMethod method) { return kMethodNames[static_cast<std::size_t>(method)]; }

CudaTouch::CudaTouch(const PointCloud& cloud, const CudaTouchOptions& options)
    : side_(std::make_unique<Side>(cloud, options)) {}
CudaTouch::~CudaTouch() = default;

Contact CudaTouch::query(const Pose& pose, double budget_us) noexcept { return side_->query(pose, budget_us); }
void CudaTouch::finish() { side_->finish(); }
std::size_t CudaTouch::readBack(PointCloud& cloud) const { return side_->readBack(cloud); }

std::string CudaTouch::machine() const { return side_->machine; }
double CudaTouch::buildTime_us() const { return side_->buildTime_us; }
const std::vector<double>& CudaTouch::editTimes_us() const { return side_->editTimes_us; }
std::optional<double> CudaTouch::firstEditTime_s() const { return side_->firstEditTime_s; }
const TouchShortfalls& CudaTouch::shortfalls() const { return side_->shortfalls; }
double CudaTouch::cell() const { return side_->cell; }

}  // namespace palpate
