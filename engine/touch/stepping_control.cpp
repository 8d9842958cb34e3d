#include "engine/touch/stepping_control.hpp"

#include "engine/matter/matter_parameters.hpp"

namespace palpate {

SteppingControl::SteppingControl(const MatterSimulation& world)
    : memory_bytes_(world.memory_bytes()), scene_(world.scene()) {}

std::string SteppingControl::failure() const {
  switch (state_.load()) {
    case MatterState::diverged:
      return "has diverged";
    case MatterState::crowded:
      return "has too many particles in one place";
    case MatterState::running:
      break;
  }
  return {};
}

std::vector<SimulationParameter> SteppingControl::parameters() const {
  const std::lock_guard lock(mutex_);
  return parametersOf(scene_);
}

void SteppingControl::set(std::string_view name, double value) {
  const std::lock_guard lock(mutex_);
  MatterScene next = scene_;
  setParameter(next, name, value);
  planOf(next, memory_bytes_);
  scene_ = next;
  changed_.store(true);
}

std::uint32_t SteppingControl::runOf(std::int64_t due, std::uint32_t mostAtOnce) noexcept {
  if (mostAtOnce == 0 || due <= mostAtOnce) return static_cast<std::uint32_t>(due);
  leftOut_.fetch_add(static_cast<std::uint64_t>(due - mostAtOnce), std::memory_order_relaxed);
  return mostAtOnce;
}

void SteppingControl::takeParameters(MatterSimulation& world) {
  if (!changed_.exchange(false)) return;
  const std::lock_guard lock(mutex_);
  world.change(scene_);
}

}  // namespace palpate
