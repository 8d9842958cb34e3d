// Replaces haptics/simulation/gpu_simulator.cpp if palpate is built without PALPATE_SIMULATION.
#include "haptics/session/vulkan_backend.hpp"

namespace palpate {

std::unique_ptr<Simulator> gpuSimulator(std::function<Device&()>) { return nullptr; }

}  // namespace palpate
