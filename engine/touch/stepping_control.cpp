#include "engine/touch/stepping_control.hpp"

#include "engine/matter/matter_parameters.hpp"

namespace palpate {

SteppingControl::SteppingControl(const MatterSimulation& world, std::size_t hands)
    : hands_(hands), memory_bytes_(world.memory_bytes()), scene_(world.scene()) {}

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

std::vector<PortEnergy> SteppingControl::portEnergies() const {
  std::vector<PortEnergy> energies;
  for (std::size_t k = 0; k < hands_; ++k)
    energies.push_back({.now_J = meters_[k].now_J.load(), .least_J = meters_[k].least_J.load()});
  return energies;
}

void SteppingControl::tellEnergy(std::size_t hand, double energy_J) noexcept {
  Meter& meter = meters_[hand];
  meter.now_J.store(energy_J, std::memory_order_relaxed);
  if (energy_J < meter.least_J.load(std::memory_order_relaxed)) meter.least_J.store(energy_J, std::memory_order_relaxed);
}

void SteppingControl::forgetEnergies() noexcept {
  for (Meter& meter : meters_) {
    meter.now_J.store(0);
    meter.least_J.store(0);
  }
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
