#include "engine/matter/gpu_soft_world.hpp"

#include <algorithm>
#include <bit>
#include <iterator>

#include "engine/core/check.hpp"
#include "engine/core/error.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/matter/gpu_tools.hpp"
#include "engine/matter/soft_model.hpp"
#include "engine/matter/soft_scene.hpp"

namespace palpate {

namespace {

constexpr const char *kStep = "step", *kFrame = "frame";

template <class T>
std::vector<T> copyOf(std::span<const T> values) {
  return {values.begin(), values.end()};
}

SoftLayout layoutOf(const MatterScene& scene, const SoftSolid& solid) {
  if (scene.preset != SoftPreset::elastic) throw Error("preset: shapes are matched on the CPU alone; take cpu");
  const SoftMaterial material = materialOf(scene);
  const std::vector<float> masses =
      nodeMasses(solid.lattice, material.density_kg_m3 * solid.lattice.volume_m3());
  return {solid.lattice,
          skinOf(solid.lattice, masses, solid.surface, touchFrequency(material, solid.lattice.spacing_m()))};
}

SoftSizes sizesOf(const SoftLayout& layout, std::span<const char> pinned, std::size_t points, std::size_t tools,
                  const MatterPlan& plan) {
  return {.nodes = static_cast<std::uint32_t>(pinned.size()),
          .skinCount = layout.skinCount,
          .firstInner = layout.firstInner,
          .slots = layout.slots,
          .stride = layout.stride,
          .skinNodes = layout.skinNodes,
          .skin = static_cast<std::uint32_t>(layout.skin.size() / shared::kSkinVec4s),
          .points = static_cast<std::uint32_t>(points),
          .tools = static_cast<std::uint32_t>(tools),
          .substeps = plan.substeps,
          .hasPins = std::ranges::count(pinned, 0) != std::ssize(pinned)};
}

shared::SoftSetting settingOf(const MatterScene& scene, const MatterPlan& plan, float beyond) {
  const SoftMaterial material = materialOf(scene);
  return {.rules = softRules(material, plan.spacing_m),
          .spring = springOnGpu(scene, plan),
          .box = scene.box_mm * 1e-3,
          .ball = static_cast<float>(scene.tool.radius_mm * 1e-3),
          .fall = scene.gravity_m_s2 * plan.substep_s,
          .step = static_cast<float>(plan.substep_s),
          .spacing = static_cast<float>(plan.spacing_m),
          .beyond = beyond,
          .damping = static_cast<float>(kTouchDamping / touchFrequency(material, plan.spacing_m)),
          .friction = static_cast<float>(scene.friction)};
}

}  // namespace

GpuSoftWorld::Frames::Frames(GpuSoftWorld& world)
    : positions(Buffer::of<Vec4>(world.device_, world.sizes_.points, Memory::device, "soft positions")),
      normals(Buffer::of<Vec4>(world.device_, world.sizes_.points, Memory::device, "soft normals")),
      velocities(Buffer::of<Vec4>(world.device_, world.sizes_.points, Memory::device, "soft velocities")),
      list(world.device_, world.queue_, "soft frame", world.timing()) {
  list.begin();
  {
    const auto section = list.section(kFrame);
    world.recordFrame(list, points());
  }
  list.end();
}

CarriedPoints GpuSoftWorld::Frames::points() const {
  return {.positions = positions.address(), .normals = normals.address(), .velocities = velocities.address()};
}

GpuSoftWorld::GpuSoftWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options)
    : GpuSoftWorld(device, queue, scene, options, *softModelFor(scene, options)) {}

GpuSoftWorld::GpuSoftWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options,
                           const SoftModel& model)
    : GpuSoftWorld(device, queue, scene, options, model.solid, model.points) {}

GpuSoftWorld::GpuSoftWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options,
                           const SoftSolid& solid, std::span<const SurfacePlace> points)
    : GpuSoftWorld(device, queue, scene, options, solid,
                   points.empty() ? std::span<const SurfacePlace>(solid.surface) : points, layoutOf(scene, solid)) {}

GpuSoftWorld::GpuSoftWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options,
                           const SoftSolid& solid, std::span<const SurfacePlace> points, const SoftLayout& layout)
    : MatterSimulation(scene, options, copyOf(solid.lattice.rest())),
      device_(device),
      queue_(queue),
      rest_(copyOf(solid.lattice.rest())),
      masses_(nodeMasses(solid.lattice, scene.density_kg_m3 * solid.lattice.volume_m3())),
      pinned_(nodesWithin(solid.lattice, pinsOf(scene))),
      mass_kg_(scene.density_kg_m3 * solid.lattice.volume_m3()),
      touchFrequency_rad_s_(touchFrequency(materialOf(scene), plan().spacing_m)),
      sizes_(sizesOf(layout, pinned_, points.size(), tools(), plan())),
      memory_(device, sizes_),
      passes_(device),
      press_(device, memory_, sizes_),
      timesPasses_(options.timesPasses),
      step_(device, queue, "soft", timing()) {
  PALPATE_CHECK(scene.matter == Matter::soft);
  memory_.setting.mapped<shared::SoftSetting>()[0].beyond = layout.beyond;
  uploadBody(layout);
  uploadPoints(solid.lattice, points, layout);
  takeParameters();
  reset();
}

void GpuSoftWorld::takeParameters() {
  shared::SoftSetting& setting = memory_.setting.mapped<shared::SoftSetting>()[0];
  setting = settingOf(scene(), plan(), setting.beyond);
  const double frequency_rad_s = touchFrequency(materialOf(scene()), plan().spacing_m);
  if (const double times = frequency_rad_s / touchFrequency_rad_s_; times != 1) stiffenSkin(times * times);
  touchFrequency_rad_s_ = frequency_rad_s;
  gravityOfSubstep_ = DVec3(0);
  for (std::size_t i = 0; i < masses_.size(); ++i)
    if (pinned_[i] == 0) gravityOfSubstep_ += static_cast<double>(masses_[i]) * DVec3(setting.fall);
  sizes_.substeps = plan().substeps;
  record(step_, nullptr);
  pressedStep_.reset();
}

void GpuSoftWorld::stiffenSkin(double times) {
  auto skin = download<Vec4>(device_, queue_, memory_.skin, std::size_t{shared::kSkinVec4s} * sizes_.skin);
  for (std::size_t i = 0; i < skin.size(); i += shared::kSkinVec4s) skin[i].w *= static_cast<float>(times);
  upload(device_, queue_, memory_.skin, skin);
}

void GpuSoftWorld::uploadBody(const SoftLayout& layout) {
  upload(device_, queue_, memory_.corners, layout.corners);
  upload(device_, queue_, memory_.volumes, layout.volumes);
  upload(device_, queue_, memory_.incident, layout.incident);
  upload(device_, queue_, memory_.skinCells, layout.skinCells);
  upload(device_, queue_, memory_.skin, layout.skin);
  upload(device_, queue_, memory_.skinNormals, layout.skinNormals);
}

void GpuSoftWorld::uploadPoints(const SoftLattice& lattice, std::span<const SurfacePlace> points,
                                const SoftLayout& layout) {
  std::vector<Vec4> rests, shares;
  std::vector<glm::uvec2> normals;
  for (const SurfacePlace& point : points) {
    const EmbeddedPlace place = lattice.embed(DVec3(point.rest));
    rests.emplace_back(point.rest, std::bit_cast<float>(layout.slotOf[place.cell]));
    shares.emplace_back(place.share, point.normal.x);
    normals.emplace_back(std::bit_cast<std::uint32_t>(point.normal.y), std::bit_cast<std::uint32_t>(point.normal.z));
  }
  upload(device_, queue_, memory_.points.rests, rests);
  upload(device_, queue_, memory_.points.shares, shares);
  upload(device_, queue_, memory_.points.normalRests, normals);
}

void GpuSoftWorld::record(CommandList& list, const GpuSoftPress* press) {
  list.begin();
  {
    const auto section = list.section(kStep);
    passes_.recordStep(list, memory_, sizes_, press);
    list.copy(memory_.state, memory_.stateRead, memory_.state.bytes());
  }
  list.end();
}

// With the presses of the step that begins.
const CommandList& GpuSoftWorld::listOfStep() {
  const bool isStale = press_.begin(presses_, kMatterStep_s);
  presses_.clear();
  if (press_.reports().empty()) return step_;
  if (isStale || !pressedStep_) {
    pressedStep_ = std::make_unique<CommandList>(device_, queue_, "soft pressed", timing());
    record(*pressedStep_, &press_);
  }
  return *pressedStep_;
}

void GpuSoftWorld::begin() {
  std::vector<Vec4> nodes;
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    nodes.emplace_back(0, 0, 0, masses_[i]);
    nodes.emplace_back(0, 0, 0, pinned_[i] != 0 ? 0 : 1);
  }
  upload(device_, queue_, memory_.nodes, nodes);
  // The planes of what is no cell stay so.
  CommandList clear(device_, queue_, "soft begin");
  clear.begin();
  for (const Buffer* buffer : {&memory_.state, &memory_.forces, &memory_.gradients})
    clear.fill(*buffer, 0, buffer->bytes());
  clear.end();
  queue_.run(clear);
  presses_.clear();
  press_.forget();
}

MatterSimulation::StepReport GpuSoftWorld::run(std::span<const HandPose> from, std::span<const HandPose> to) {
  const std::size_t hands = std::size_t{sizes_.substeps} * sizes_.tools;
  writeHandSteps(from, to, plan().substep_s, memory_.hands.mapped<shared::HandStep>().first(hands));
  ran_ = &listOfStep();
  queue_.wait(queue_.submit(*ran_), device_.defaultWait());
  press_.end();
  const std::span<const std::byte> state = memory_.stateRead.mapped<const std::byte>();
  const auto& sums = *reinterpret_cast<const shared::MatterSums*>(state.subspan(SoftMemory::kSums).data());
  const auto* balls = reinterpret_cast<const shared::ToolState*>(state.subspan(SoftMemory::kTools).data());
  const auto kinetic_J = static_cast<double>(sums.kinetic);
  StepReport report{
      .state = kinetic_J <= mostSoftKinetic_J(scene(), plan(), mass_kg_) ? MatterState::running : MatterState::diverged,
      .gravity = static_cast<double>(sizes_.substeps) * gravityOfSubstep_,
      .onWalls = DVec3(sums.onWalls) + press_.onPins(),
      .totals = {.kinetic_J = kinetic_J,
                 .momentum = sums.momentum,
                 .maxCompression = static_cast<double>(sums.mostCompression)}};
  for (const PressReport& pressed : press_.reports()) report.onPresses += pressed.impulse;
  for (std::size_t tool = 0; tool < tools(); ++tool) report.tools.push_back(reportOf(balls[tool], to[tool]));
  return report;
}

std::optional<double> GpuSoftWorld::gpuTime_us() const {
  const double time_us = ran_->sectionTime_us(kStep);
  return time_us > 0 ? std::optional(time_us) : std::nullopt;
}

std::optional<double> GpuSoftWorld::frameTime_us() const {
  const double time_us = frames_ ? frames_->list.sectionTime_us(kFrame) : 0;
  return time_us > 0 ? std::optional(time_us) : std::nullopt;
}

std::vector<PassRecord> GpuSoftWorld::passes() const {
  std::vector<PassRecord> all = ran_->passes();
  if (frames_) std::ranges::copy(frames_->list.passes(), std::back_inserter(all));
  return all;
}

std::uint64_t GpuSoftWorld::bytes() const {
  return memory_.bytes() + press_.bytes() +
         (frames_ ? frames_->positions.bytes() + frames_->normals.bytes() + frames_->velocities.bytes() : 0);
}

std::vector<Vec3> GpuSoftWorld::ofNodes(std::size_t vec4) const {
  const auto nodes = download<Vec4>(device_, queue_, memory_.nodes, shared::kNodeVec4s * rest_.size());
  std::vector<Vec3> values;
  for (std::size_t i = 0; i < rest_.size(); ++i) values.emplace_back(nodes[shared::kNodeVec4s * i + vec4]);
  return values;
}

void GpuSoftWorld::setNodes(std::size_t vec4, std::span<const Vec3> byId) {
  PALPATE_CHECK_EQ(byId.size(), rest_.size());
  auto nodes = download<Vec4>(device_, queue_, memory_.nodes, shared::kNodeVec4s * rest_.size());
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    Vec4& node = nodes[shared::kNodeVec4s * i + vec4];
    node = Vec4(pinned_[i] != 0 ? Vec3(0) : byId[i], node.w);
  }
  upload(device_, queue_, memory_.nodes, nodes);
}

std::vector<Vec3> GpuSoftWorld::positionsById() const {
  std::vector<Vec3> places = displacements();
  for (std::size_t i = 0; i < places.size(); ++i) places[i] += rest_[i];
  return places;
}

std::vector<Vec3> GpuSoftWorld::velocitiesById() const { return ofNodes(1); }
void GpuSoftWorld::setVelocities(std::span<const Vec3> byId) { setNodes(1, byId); }
void GpuSoftWorld::setDisplacements(std::span<const Vec3> byId) { setNodes(0, byId); }

MatterObservation GpuSoftWorld::observe() const {
  MatterObservation seen{totals()};
  seen.time_s = time_s();
  seeNodes(seen, scene(), rest_, displacements(), masses_);
  return seen;
}

GpuSoftWorld::Frames& GpuSoftWorld::frames() {
  if (!frames_) frames_ = std::make_unique<Frames>(*this);
  return *frames_;
}

CarriedPoints GpuSoftWorld::carry() {
  queue_.run(frames().list);
  return frames().points();
}

void GpuSoftWorld::makeFrame(CloudFrame& frame) {
  carry();
  const auto fetch = [&](const Buffer& from, std::vector<Vec3>& to) {
    const auto values = download<Vec4>(device_, queue_, from, sizes_.points);
    to.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) to[i] = Vec3(values[i]);
  };
  fetch(frames().positions, frame.positions);
  fetch(frames().normals, frame.normals);
  fetch(frames().velocities, frame.velocities);
  frame.time_s = time_s();
}

}  // namespace palpate
