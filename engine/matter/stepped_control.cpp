#include "engine/matter/stepped_control.hpp"

#include "engine/matter/matter_parameters.hpp"

namespace palpate {

SteppedControl::SteppedControl(const MatterSimulation& world, std::size_t hands, std::uint32_t mostAtOnce)
    : mostAtOnce_(mostAtOnce), hands_(hands), memory_bytes_(world.memory_bytes()), scene_(world.scene()) {}

std::string SteppedControl::failure() const {
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

std::vector<PortEnergy> SteppedControl::portEnergies() const {
  std::vector<PortEnergy> energies;
  for (std::size_t k = 0; k < hands_; ++k)
    energies.push_back({.now_J = meters_[k].now_J.load(), .min_J = meters_[k].min_J.load()});
  return energies;
}

std::vector<SimulationParameter> SteppedControl::parameters() const {
  const std::lock_guard lock(mutex_);
  return parametersOf(scene_);
}

void SteppedControl::set(std::string_view name, double value) {
  const std::lock_guard lock(mutex_);
  MatterScene next = scene_;
  setParameter(next, name, value);
  planOf(next, memory_bytes_);
  scene_ = next;
  changed_.store(true);
}

void SteppedControl::takeParameters(MatterSimulation& world) {
  if (!changed_.exchange(false)) return;
  const std::lock_guard lock(mutex_);
  world.change(scene_);
}

void SteppedControl::seeEnergy(std::size_t hand, double energy_J) noexcept {
  Meter& meter = meters_[hand];
  meter.now_J.store(energy_J, std::memory_order_relaxed);
  if (energy_J < meter.min_J.load(std::memory_order_relaxed)) meter.min_J.store(energy_J, std::memory_order_relaxed);
}

void SteppedControl::forget() noexcept {
  last_.reset();
  for (Meter& meter : meters_) {
    meter.now_J.store(0);
    meter.min_J.store(0);
  }
}

std::uint32_t SteppedControl::stepsTo(std::int64_t step, std::uint32_t atFirst) {
  const std::int64_t steps = last_ ? step - *last_ : atFirst;
  last_ = step;
  if (steps > 0) advances_.fetch_add(1, std::memory_order_relaxed);
  if (mostAtOnce_ == 0 || !leavesOut_.load() || steps <= mostAtOnce_) return static_cast<std::uint32_t>(steps);
  leftOut_.fetch_add(static_cast<std::uint64_t>(steps - mostAtOnce_), std::memory_order_relaxed);
  return mostAtOnce_;
}

}  // namespace palpate
