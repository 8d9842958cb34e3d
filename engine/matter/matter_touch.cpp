#include "engine/matter/matter_touch.hpp"

#include <algorithm>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/core/error.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/core/processor.hpp"
#include "engine/core/start_thread.hpp"

namespace palpate {

namespace {

constexpr std::array<std::uint8_t, 4> kWaterColor{86, 140, 196, 255}, kSandColor{198, 168, 118, 255},
    kModelColor{206, 202, 194, 255};
// Against the clock: steps missed beyond this number are dropped, as catching up would only delay the answers.
constexpr std::uint32_t kMaxAtOnce = 2;
// Minimum force that counts as touching; a ball beside the matter gets no force.
constexpr double kMinForce_N = 1e-6;

Vec3 upOf(const MatterScene& scene) {
  const double gravity = glm::length(scene.gravity_m_s2);
  return gravity > 0 ? Vec3(-scene.gravity_m_s2 / gravity) : Vec3(0, 1, 0);
}

MatterBox boxOf(const MatterScene& scene) { return {.size = scene.box_mm * kMatterUnit_m, .periodic = scene.periodic}; }

void append(std::vector<Vec3>& to, std::span<const Vec3> more) { to.insert(to.end(), more.begin(), more.end()); }

std::vector<Vec3> inUnits(std::span<const Vec3> values_m) {
  std::vector<Vec3> values(values_m.size());
  std::ranges::transform(values_m, values.begin(),
                         [](const Vec3& value) { return value * static_cast<float>(1 / kMatterUnit_m); });
  return values;
}

}  // namespace

MatterThread::MatterThread(MatterSteps& steps)
    : steps_(steps), spins_(coresToUse() >= kCoresToSpin), thread_(startThread([this] { serve(); })) {}

MatterThread::~MatterThread() {
  stop_.store(true);
  wake_.post();
}

void MatterThread::serve() {
  std::optional<MatterQuestion> question;
  for (wake_.take(); !stop_.load(); wake_.take()) {
    const auto newest = asked_.load();
    if (!newest || (question && newest->time_s == question->time_s)) continue;  // answered after an earlier wake-up
    question = newest;
    answered_.store(steps_.answerTo(*question));
    done_.post();
  }
}

std::optional<MatterAnswer> MatterThread::ask(const MatterQuestion& question, double budget_us) noexcept {
  const Stopwatch watch;
  askedAt_s_ = question.time_s;
  asked_.store(question);
  wake_.post();
  for (;;) {
    if (const auto newest = answered_.load()) last_ = newest;
    if (last_ && last_->question.time_s == question.time_s) return last_;
    if (budget_us <= 0) {
      done_.take();
      continue;
    }
    const double left_us = budget_us - watch.elapsed_us();
    if (left_us <= 0 || (!spins_ && !done_.takeWithin(left_us))) return last_;  // the next sleep takes a late post
  }
}

void MatterThread::finish() {
  while (askedAt_s_) {
    if (const auto newest = answered_.load()) last_ = newest;
    if (last_ && last_->question.time_s == *askedAt_s_) return;
    wake_.post();
    done_.take();
  }
}

void addModel(const MatterModel& model, std::vector<Vec3>& positions, std::vector<Vec3>& normals) {
  for (const SurfacePlace& point : model.points()) {
    positions.push_back(point.rest * static_cast<float>(1 / kMatterUnit_m));
    normals.push_back(point.normal);
  }
}

void colorMatter(CloudFrame& frame, Matter matter, std::size_t standing) {
  const auto opaque = [](const std::array<std::uint8_t, 4>& color) { return std::array{color[0], color[1], color[2]}; };
  frame.colors.assign(frame.size() - standing, opaque(matter == Matter::sand ? kSandColor : kWaterColor));
  frame.colors.resize(frame.size(), opaque(kModelColor));
}

MatterTouch::MatterTouch(std::unique_ptr<MatterSimulation> simulation, const MatterTouchOptions& options)
    : up_(upOf(simulation->scene())),
      machine_(options.machine),
      steps_(std::move(simulation), options.hands, kMaxAtOnce),
      answers_(options.hands),
      surface_(boxOf(steps_.world().scene()), steps_.world().plan().spacing_m, options.threads) {
  if (const MatterModel* const model = steps_.world().model()) addModel(*model, still_.positions, still_.normals);
  PALPATE_CHECK(steps_.world().scene().tool.radius_mm > 0);
  setRealtime(options.realtime);
}

void MatterTouch::setRealtime(bool realtime) {
  const std::lock_guard lock(paceGuard_);  // a picture's thread may be reading the particles
  if (realtime == thread_.has_value()) return steps_.setLeavesOut(realtime);
  thread_.reset();
  steps_.setLeavesOut(realtime);
  if (realtime) thread_.emplace(steps_);
}

std::span<const Contact> MatterTouch::ask(std::span<const Pose> poses, double budget_us) noexcept {
  PALPATE_CHECK_EQ(poses.size(), answers_.size());
  MatterQuestion question{.time_s = poses.front().time_s, .hands = {}, .putDown = putDown_};
  bool finite = true;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    question.hands[i] = {
        .place_m = poses[i].hip * kMatterUnit_m, .orientation = poses[i].turn, .felt = poses[i].felt.share()};
    finite &= isFinite(poses[i].hip);
  }
  std::optional<MatterAnswer> answer;
  if (finite) answer = thread_ ? thread_->ask(question, budget_us) : steps_.answerTo(question);
  for (std::size_t i = 0; i < poses.size(); ++i)
    answers_[i] = answer ? contactOf(*answer, i, poses[i]) : Contact{.proxy = poses[i].hip, .valid = finite};
  if (steps_.isFaulty())
    for (std::size_t i = 0; i < poses.size(); ++i) answers_[i] = {.proxy = poses[i].hip, .valid = false, .lost = true};
  return answers_;
}

Contact MatterTouch::contactOf(const MatterAnswer& answer, std::size_t hand, const Pose& pose) const noexcept {
  const ToolAnswer& tool = answer.hands[hand];
  const double age_s = pose.time_s - answer.question.time_s;
  const double left = shareLeft(age_s, kStale_s, kStalest_s);
  Contact contact{.proxy = pose.hip,
                  .fresh = age_s <= 0,
                  .valid = answer.state == MatterState::running,
                  .dataTime_s = answer.question.time_s};
  const bool isPlaced = answer.question.putDown[hand] == putDown_[hand];  // else the answer is for its old position
  if (!contact.valid || !answer.moves || !isPlaced || left <= 0 ||
      !(glm::length(tool.reaction_N) + glm::length(tool.byModel_N) > kMinForce_N))
    return contact;
  // The ball is extrapolated with its velocity, and its spring is stretched by the hand's displacement since then, less
  // the ball's.
  const DVec3 went_m = age_s * tool.velocity_m_s;
  const DVec3 moved_m = pose.hip * kMatterUnit_m - answer.question.hands[hand].place_m;
  const DVec3 force_N = left * (tool.force_N - tool.coupling_N_m * (moved_m - went_m));
  const double size_N = glm::length(force_N);
  contact.force_N = force_N;
  contact.torque_mNm = left * 1e3 * tool.torque_Nm;
  contact.touching = size_N > kMinForce_N;
  if (!contact.touching) return contact;
  contact.normal = force_N / size_N;
  contact.proxy = (tool.place_m + went_m) / kMatterUnit_m;
  contact.velocity = tool.velocity_m_s / kMatterUnit_m;
  return contact;
}

void MatterTouch::finish() {
  if (thread_) thread_->finish();
  steps_.throwFault();
  if (const std::string failure = steps_.failure(); !failure.empty())
    throw Error("the simulation {}; restart it with more substeps or a slower hand", failure);
}

std::size_t MatterTouch::readBack(PointCloud& cloud) const {
  const std::vector<Vec3> places = steps_.world().positionsById();
  PALPATE_CHECK_EQ(cloud.size(), places.size() + still_.positions.size());
  surface_.normalsOf(places, up_, cloud.normals);
  append(cloud.normals, still_.normals);
  std::vector<Vec3> positions = inUnits(places);
  append(positions, still_.positions);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) moved += positions[i] != cloud.positions[i] ? 1 : 0;
  cloud.positions = positions;
  return moved;
}

bool MatterTouch::take(CloudFrame& frame) {
  {
    const std::lock_guard lock(paceGuard_);
    if (!thread_) steps_.showPresent();
  }
  if (!steps_.take(view_)) return false;
  frame.time_s = view_.time_s;
  frame.positions = inUnits(view_.positions);
  frame.velocities = inUnits(view_.velocities);
  surface_.normalsOf(view_.positions, up_, frame.normals);
  append(frame.positions, still_.positions);
  append(frame.normals, still_.normals);
  frame.velocities.resize(frame.positions.size(), Vec3(0));
  frame.colors.clear();
  frame.ids.clear();
  return true;
}

void MatterTouch::setBrush(const std::optional<BrushOptions>& brush) {
  if (brush) throw UsageError("matter that moves by itself cannot be sculpted");
}

PointCloud cloudOf(const MatterScene& scene, const MatterModel* model, unsigned threads) {
  std::vector<Vec3> places = placesAtRest(scene);
  if (model != nullptr) leaveOut(places, *model);
  PointCloud cloud;
  cloud.positions = inUnits(places);
  MatterSurface(boxOf(scene), particleSpacing_mm(scene) * kMatterUnit_m, threads)
      .normalsOf(places, upOf(scene), cloud.normals);
  cloud.colors.assign(places.size(), scene.matter == Matter::sand ? kSandColor : kWaterColor);
  if (model != nullptr) addModel(*model, cloud.positions, cloud.normals);
  cloud.colors.resize(cloud.size(), kModelColor);
  cloud.storedAs.comments = {"comment units: mm"};
  if (const auto up = upOfCameras(DVec3(upOf(scene))))
    cloud.storedAs.comments.push_back(fmt::format("comment up: {}", nameOf(*up)));
  return cloud;
}

}  // namespace palpate
