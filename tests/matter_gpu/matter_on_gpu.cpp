#include "tests/matter/on_matter.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate {

const bool kOnGpu = true;

OnMatter::~OnMatter() { const CoreGpuFixture ends; }  // its end fails the case if there are messages
MatterMaker OnMatter::maker(unsigned) { return onGpu(coreValidatedDevice()); }

OnSoft::~OnSoft() { const CoreGpuFixture ends; }
SoftMaker OnSoft::maker(unsigned) { return softOnGpu(coreValidatedDevice()); }
SoftBend OnSoft::bender() { return bendOnGpu(); }

}  // namespace palpate
