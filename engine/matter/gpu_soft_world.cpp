#include "engine/matter/gpu_soft_world.hpp"

#include <algorithm>
#include <bit>
#include <iterator>

#include "engine/core/check.hpp"
#include "engine/core/error.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/matter/gpu_tools.hpp"
#include "engine/matter/soft_scene.hpp"

namespace palpate {

namespace {

constexpr const char *kSoftStep = "step", *kFrame = "frame";

SoftLayout layoutOf(const MatterScene& scene, const SoftSolid& solid) {
  const SoftMaterial material = materialOf(scene);
  const std::vector<float> masses = nodeMasses(solid.lattice, material.density_kg_m3 * solid.lattice.volume_m3());
  return {solid.lattice,
          skinOf(solid.lattice, masses, solid.surface, touchFrequency(material, solid.lattice.spacing_m()))};
}

std::vector<Vec3> restOf(const SoftModel& model) {
  return {model.solid.lattice.rest().begin(), model.solid.lattice.rest().end()};
}

bool hasPins(const SoftBody& body) {
  for (std::size_t i = 0; i < body.size(); ++i)
    if (body.isPinned(i)) return true;
  return false;
}

SoftSizes sizesOf(const SoftLayout& layout, const SoftBody& body, std::size_t points, std::size_t tools,
                  const MatterPlan& plan) {
  return {.nodes = static_cast<std::uint32_t>(body.size()),
          .skinCount = layout.skinCount,
          .firstInner = layout.firstInner,
          .slots = layout.slots,
          .stride = layout.stride,
          .skinNodes = layout.skinNodes,
          .skin = static_cast<std::uint32_t>(layout.skin.size() / shared::kSkinVec4s),
          .points = static_cast<std::uint32_t>(points),
          .tools = static_cast<std::uint32_t>(tools),
          .substeps = plan.substeps,
          .hasPins = hasPins(body)};
}

shared::SoftSetting settingOf(const MatterScene& scene, const MatterPlan& plan, double substep_s, float beyond) {
  const SoftMaterial material = materialOf(scene);
  return {.rules = softRules(material, plan.spacing_m),
          .spring = springOnGpu(scene, plan),
          .box = scene.box_mm * 1e-3,
          .ball = static_cast<float>(scene.tool.radius_mm * 1e-3),
          .fall = scene.gravity_m_s2 * substep_s,
          .step = static_cast<float>(substep_s),
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
    : GpuSoftWorld(device, queue, scene, options, softModelFor(scene, onMachine(options, device.ownMemory()))) {}

GpuSoftWorld::GpuSoftWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options,
                           const SoftSolid& solid, std::span<const SurfacePlace> points)
    : GpuSoftWorld(device, queue, scene, options, softModelOf(solid, points)) {}

GpuSoftWorld::GpuSoftWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options,
                           const std::shared_ptr<const SoftModel>& model)
    : GpuSoftWorld(device, &queue, scene, options, model, layoutOf(scene, model->solid), nullptr) {}

GpuSoftWorld::GpuSoftWorld(Device& device, std::unique_ptr<Queue> queue, const MatterScene& scene,
                           const MatterOptions& options)
    : GpuSoftWorld(device, std::move(queue), scene, options,
                   softModelFor(scene, onMachine(options, device.ownMemory()))) {}

GpuSoftWorld::GpuSoftWorld(Device& device, std::unique_ptr<Queue> queue, const MatterScene& scene,
                           const MatterOptions& options, const std::shared_ptr<const SoftModel>& model)
    : GpuSoftWorld(device, nullptr, scene, options, model, layoutOf(scene, model->solid), std::move(queue)) {}

GpuSoftWorld::GpuSoftWorld(Device& device, Queue* queue, const MatterScene& scene, const MatterOptions& options,
                           std::shared_ptr<const SoftModel> model, const SoftLayout& layout, std::unique_ptr<Queue> own)
    : MatterSimulation(scene, onMachine(options, device.ownMemory()), restOf(*model)),
      device_(device),
      own_(std::move(own)),
      queue_(own_ ? *own_ : *queue),
      model_(std::move(model)),
      body_(model_->solid.lattice, materialOf(scene), pinsOf(scene)),
      surface_(model_->solid.lattice, model_->solid.surface),
      sculpture_(body_, surface_),
      shape_(body_.size(), Vec3(0)),
      slotOf_(layout.slotOf),
      touchFrequency_rad_s_(touchFrequency(materialOf(scene), plan().spacing_m)),
      sizes_(sizesOf(layout, body_, model_->points.size(), tools(), plan())),
      memory_(device, sizes_),
      passes_(device),
      press_(device, memory_, sizes_),
      timesPasses_(options.timesPasses),
      step_(device, queue_, "soft", timing()) {
  PALPATE_CHECK(scene.matter == Matter::soft);
  memory_.setting.mapped<shared::SoftSetting>()[0].beyond = layout.beyond;
  uploadBody(layout);
  uploadPoints(layout);
  takeParameters();
  reset();
}

void GpuSoftWorld::takeParameters() {
  body_.setMaterial(materialOf(scene()));
  const double frequency_rad_s = touchFrequency(materialOf(scene()), plan().spacing_m);
  if (const double times = frequency_rad_s / touchFrequency_rad_s_; times != 1) stiffenSkin(times * times);
  touchFrequency_rad_s_ = frequency_rad_s;
  recordSteps();
}

// Records the step with the number of substeps that the body needs in its present shape.
void GpuSoftWorld::recordSteps() {
  sizes_.substeps = substepsOf(scene(), plan(), body_.rest().stiffest());
  shared::SoftSetting& setting = memory_.setting.mapped<shared::SoftSetting>()[0];
  setting = settingOf(scene(), plan(), kMatterStep_s / sizes_.substeps, setting.beyond);
  setting.carriedSpeed = carriesVelocities_ ? 1 : 0;
  gravityOfSubstep_ = DVec3(0);
  for (std::size_t i = 0; i < body_.size(); ++i)
    if (!body_.isPinned(i)) gravityOfSubstep_ += static_cast<double>(body_.masses()[i]) * DVec3(setting.fall);
  record(step_, nullptr);
  pressedStep_.reset();
  compliance_.reset();
  ran_ = &step_;
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

void GpuSoftWorld::uploadPoints(const SoftLayout& layout) {
  std::vector<Vec4> rests, shares;
  std::vector<glm::uvec2> normals;
  for (const SurfacePlace& point : model_->points) {
    const EmbeddedPlace place = model_->solid.lattice.embed(DVec3(point.rest));
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
    const auto section = list.section(kSoftStep);
    passes_.recordStep(list, memory_, sizes_, press);
    list.copy(memory_.state, memory_.stateRead, memory_.state.bytes());
  }
  list.end();
}

// List of the step that begins, with its presses.
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

void GpuSoftWorld::uploadNodes(std::span<const Vec3> displacements, std::span<const Vec3> velocities) {
  std::vector<Vec4> nodes;
  nodes.reserve(shared::kNodeVec4s * body_.size());
  for (std::size_t i = 0; i < body_.size(); ++i) {
    nodes.emplace_back(displacements[i], body_.masses()[i]);
    nodes.emplace_back(velocities[i], body_.isPinned(i) ? 0 : 1);
  }
  upload(device_, queue_, memory_.nodes, nodes);
}

void GpuSoftWorld::beginSculpting() {
  const auto nodes = download<Vec4>(device_, queue_, memory_.nodes, shared::kNodeVec4s * body_.size());
  for (std::size_t i = 0; i < body_.size(); ++i) {
    body_.displacements()[i] = Vec3(nodes[shared::kNodeVec4s * i]);
    body_.velocities()[i] = Vec3(nodes[shared::kNodeVec4s * i + 1]);
  }
}

void GpuSoftWorld::endSculpting() {
  std::vector<std::uint32_t> changed;
  for (std::uint32_t i = 0; i < shape_.size(); ++i)
    if (body_.rest().displacements()[i] != shape_[i]) changed.push_back(i);
  if (changed.empty()) return;
  uploadNodes(body_.displacements(), body_.velocities());
  const bool wasSculpted = std::exchange(sizes_.isSculpted, true);
  memory_.holdShapes(device_, sizes_);
  passes_.holdShapes(device_);
  uploadShapes(changed);
  if (!wasSculpted || substepsOf(scene(), plan(), body_.rest().stiffest()) != sizes_.substeps) recordSteps();
}

// Uploads the rest shapes of the cells around these nodes; directly into GPU memory, if the host can access it.
void GpuSoftWorld::uploadShapes(std::span<const std::uint32_t> nodes) {
  const std::span<shared::CellRest> rests = memory_.rests->mapped<shared::CellRest>();
  for (const std::uint32_t node : nodes) {
    shape_[node] = body_.rest().displacements()[node];
    for (const std::uint32_t corner : body_.incident()[node]) {
      const std::size_t cell = corner / 8;
      if (cell == model_->solid.lattice.cells()) continue;
      const shared::CellRest* const rest = body_.rest().ofCell(cell);
      rests[slotOf_[cell]] = rest ? *rest : shared::CellRest{};
    }
  }
}

void GpuSoftWorld::begin() {
  sculpture_.endStroke();
  body_.reset();
  uploadNodes(body_.displacements(), body_.velocities());
  // The planes of slots without a cell stay 0.
  CommandList clear(device_, queue_, "soft begin");
  clear.begin();
  for (const Buffer* buffer : {&memory_.state, &memory_.forces, &memory_.gradients})
    clear.fill(*buffer, 0, buffer->bytes());
  clear.end();
  queue_.run(clear);
  presses_.clear();
  press_.forget();
}

void GpuSoftWorld::placeToolAt(std::size_t tool, const HandPose&) {
  putToHand(device_, queue_, memory_.state, SoftMemory::kTools, tool);
}

MatterSimulation::StepReport GpuSoftWorld::run(std::span<const HandPose> from, std::span<const HandPose> to) {
  const std::size_t hands = std::size_t{sizes_.substeps} * sizes_.tools;
  writeHandSteps(from, to, kMatterStep_s / sizes_.substeps, memory_.hands.mapped<shared::HandStep>().first(hands));
  ran_ = &listOfStep();
  queue_.wait(queue_.submit(*ran_), device_.defaultWait());
  press_.end();
  const std::span<const std::byte> state = memory_.stateRead.mapped<const std::byte>();
  const auto& sums = *reinterpret_cast<const shared::MatterSums*>(state.subspan(SoftMemory::kSums).data());
  const auto* balls = reinterpret_cast<const shared::ToolState*>(state.subspan(SoftMemory::kTools).data());
  const auto kinetic_J = static_cast<double>(sums.kinetic);
  StepReport report{.state = kinetic_J <= mostSoftKinetic_J(scene(), plan(), body_.mass_kg()) ? MatterState::running
                                                                                              : MatterState::diverged,
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
  const double time_us = ran_->sectionTime_us(kSoftStep);
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
  return memory_.bytes() + press_.bytes() + (compliance_ ? compliance_->bytes() : 0) +
         (frames_ ? frames_->positions.bytes() + frames_->normals.bytes() + frames_->velocities.bytes() : 0);
}

std::vector<Vec3> GpuSoftWorld::ofNodes(std::size_t vec4) const {
  const auto nodes = download<Vec4>(device_, queue_, memory_.nodes, shared::kNodeVec4s * body_.size());
  std::vector<Vec3> values;
  for (std::size_t i = 0; i < body_.size(); ++i) values.emplace_back(nodes[shared::kNodeVec4s * i + vec4]);
  return values;
}

void GpuSoftWorld::setNodes(std::size_t vec4, std::span<const Vec3> byId) {
  PALPATE_CHECK_EQ(byId.size(), body_.size());
  auto nodes = download<Vec4>(device_, queue_, memory_.nodes, shared::kNodeVec4s * body_.size());
  for (std::size_t i = 0; i < body_.size(); ++i) {
    Vec4& node = nodes[shared::kNodeVec4s * i + vec4];
    node = Vec4(body_.isPinned(i) ? Vec3(0) : byId[i], node.w);
  }
  upload(device_, queue_, memory_.nodes, nodes);
}

std::vector<Vec3> GpuSoftWorld::positionsById() const {
  std::vector<Vec3> places = displacements();
  for (std::size_t i = 0; i < places.size(); ++i) places[i] += body_.lattice().rest()[i];
  return places;
}

std::vector<Vec3> GpuSoftWorld::velocitiesById() const { return ofNodes(1); }
void GpuSoftWorld::setVelocities(std::span<const Vec3> byId) { setNodes(1, byId); }
void GpuSoftWorld::setDisplacements(std::span<const Vec3> byId) { setNodes(0, byId); }

MatterObservation GpuSoftWorld::observe() const {
  MatterObservation seen{totals()};
  seen.time_s = time_s();
  seeNodes(seen, scene(), body_.lattice().rest(), displacements(), body_.masses());
  return seen;
}

double GpuSoftWorld::localCompliance_m_N(const DVec3& place_m, double radius_m, const DVec3& direction) {
  beginSculpting();
  std::vector<Vec4> load;
  for (const DVec3& force : surface_.spread(body_, place_m, radius_m, direction)) load.emplace_back(force, 0);
  for (std::size_t i = 0; i < load.size(); ++i)
    if (body_.isPinned(i)) load[i] = Vec4(0);
  if (!compliance_) compliance_.emplace(device_, queue_, memory_, sizes_, kHold_1_s2);
  return compliance_->give(load);
}

void GpuSoftWorld::carryVelocities(bool carries) {
  carriesVelocities_ = carries;
  memory_.setting.mapped<shared::SoftSetting>()[0].carriedSpeed = carries ? 1 : 0;
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
