// Replaces gpu_half.cpp in builds without Vulkan.
#include "haptics/library/failures.hpp"
#include "haptics/library/gpu_half.hpp"

namespace palpate::library {

namespace {

[[noreturn]] void refuse(const char* what) {
  throw UnsupportedError("{}: this palpate was built without Vulkan (PALPATE_VULKAN=OFF)", what);
}

}  // namespace

std::vector<std::string> gpuNames() { return {}; }
bool hasRealGpu() { return false; }
void writePicture(const std::string&, const Image&) { refuse("a picture"); }

struct GpuHalf::State {};

GpuHalf::GpuHalf(const GpuChoice& choice) {
  if (choice.lent) refuse("a device of the program's own");
}
GpuHalf::~GpuHalf() = default;
std::unique_ptr<BackendKind> GpuHalf::backend() { refuse("a session on a GPU"); }
void GpuHalf::follow(const EditBatch&) noexcept {}
void GpuHalf::forgetPicture() {}
Image GpuHalf::draw(const Layer&, const History*, const PictureRequest&) { refuse("a picture"); }
Mesh GpuHalf::mesh(const PointCloud&, const MeshPlan&) { refuse("a mesh"); }

}  // namespace palpate::library
