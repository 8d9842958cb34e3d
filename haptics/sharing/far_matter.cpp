// Water and sand that another program simulates: it sends the force on the ball of each hand, and the particles.
#include <cmath>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>

#include "engine/core/start_thread.hpp"
#include "engine/matter/matter_rules.hpp"
#include "engine/matter/matter_touch.hpp"
#include "haptics/session/session_setup.hpp"
#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/brick_touch.hpp"
#include "haptics/sharing/late_force.hpp"
#include "haptics/simulation/matter_choice.hpp"
#include "haptics/simulation/scene_model.hpp"

namespace palpate {

namespace {

constexpr double kPoll_s = 0.004;
constexpr double kFollow_s = 0.02;    // time constant with which a force follows the received ones, 60 a second
constexpr double kPlaced_s = 0.05;    // until a hand's new position is sent, and the server's ball is at it
constexpr double kMinForce_N = 1e-6;  // that counts as touching

/// Gives each hand the force that was received for it, and shows the received particles.
class FarMatter final : public TouchBackend, private FrameStream {
 public:
  /// `source` and `known` must outlive it.
  FarMatter(BrickSource& source, const InformationAge& known, const MatterScene& scene, const MatterModel* standing,
            std::size_t hands)
      : source_(source), known_(known), matter_(scene.matter), hands_(hands), answers_(hands) {
    if (standing) addModel(*standing, positions_, normals_);
    thread_ = startThread([this](const std::stop_token& stop) { run(stop); });
  }

  std::size_t hands() const noexcept override { return hands_.size(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override {
    if (budget_us <= 0) renew();
    forces_ = source_.forces().value_or(forces_);
    const double share = shareAt(steadyNow_s() - forces_.true_s, known_.limits());
    const double dt_s = poses.front().time_s - std::exchange(last_s_, poses.front().time_s);
    const double follows = dt_s > 0 ? 1 - std::exp(-dt_s / kFollow_s) : 0;
    for (std::size_t i = 0; i < hands_.size(); ++i) answers_[i] = answerTo(i, poses[i], share, follows);
    return answers_;
  }
  void resetHand(std::size_t hand) noexcept override {
    hands_[hand].late.lift();
    hands_[hand].force_N = DVec3(0);
    hands_[hand].placed_s = steadyNow_s();
  }
  void finish() override {
    const std::scoped_lock hold(lock_);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }
  std::size_t readBack(PointCloud& cloud) const override {
    CloudFrame frame;
    if (!show(frame)) return 0;
    cloud.positions = frame.positions;
    cloud.normals = frame.normals;
    cloud.colors.clear();
    for (const auto& [r, g, b] : frame.colors) cloud.colors.push_back({r, g, b, 255});
    return cloud.size();
  }
  FrameStream* frames() noexcept override { return this; }
  BackendReport report() const override {
    constexpr std::uint32_t kMaxVarying = 1 << 18;
    return {.machine = machine_, .scope = {.edits = false, .paints = false, .newPoints = kMaxVarying}};
  }

 private:
  struct Hand {
    LateForce late;
    DVec3 force_N{0};
    double placed_s = 0;  // time of its last reset
  };

  Contact answerTo(std::size_t i, const Pose& pose, double share, double follows) noexcept {
    Hand& hand = hands_[i];
    Contact contact{.proxy = pose.hip, .fresh = true, .valid = isFinite(pose.hip)};
    if (!contact.valid) return contact;
    // Forces from before the server's ball is there are those of another position. The round trip is that measured by
    // now: that of a new link is known only after the hand has begun.
    if (forces_.true_s >= hand.placed_s + known_.roundTrip_s() + kPlaced_s)
      hand.force_N = glm::mix(hand.force_N, DVec3(forces_.force_N[i]), follows);
    const DVec3 force_N = hand.late.at(pose.hip, pose.felt.share(), share * hand.force_N);  // a unit is a millimetre
    const double size_N = glm::length(force_N);
    contact.force_N = force_N;
    contact.touching = size_N > kMinForce_N;
    if (contact.touching) contact.normal = force_N / size_N;
    return contact;
  }

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      renew();
      std::this_thread::sleep_for(std::chrono::duration<double>(kPoll_s));
    }
  }
  // Makes a frame of the particles, if there are others than before.
  void renew() noexcept {
    const std::scoped_lock hold(lock_);
    const auto asked = source_.asked();
    if (failure_ || !asked || !source_.hasNewer(asked->time_s, frame_.time_s)) return;
    try {
      source_.makeFrame(asked->time_s, frame_);
      made_s_.store(frame_.time_s);
      isNew_ = true;
    } catch (...) {
      failure_ = std::current_exception();
    }
  }

  // While no particles are known, the last known ones remain visible.
  bool take(CloudFrame& frame) override {
    {
      const std::scoped_lock hold(lock_);
      if (!std::exchange(isNew_, false)) return false;
    }
    return show(frame);
  }
  bool show(CloudFrame& frame) const {
    {
      const std::scoped_lock hold(lock_);
      if (frame_.positions.empty()) return false;
      frame = frame_;
    }
    frame.positions.insert(frame.positions.end(), positions_.begin(), positions_.end());
    frame.normals.insert(frame.normals.end(), normals_.begin(), normals_.end());
    frame.velocities.resize(frame.size(), Vec3(0));
    colorMatter(frame, matter_, positions_.size());
    return true;
  }
  std::optional<PointsTime> time() const noexcept override {
    const double made_s = made_s_.load();
    if (std::isnan(made_s)) return std::nullopt;
    return PointsTime{.true_s = made_s};
  }

  BrickSource& source_;
  const InformationAge& known_;
  Matter matter_;
  std::string machine_ = cpuBackend()->machine(1);
  std::vector<Vec3> positions_, normals_;  // of the body that stands in it
  std::vector<Hand> hands_;
  std::vector<Contact> answers_;
  HandForces forces_;
  double last_s_ = 0;
  std::atomic<double> made_s_ = std::numeric_limits<double>::quiet_NaN();
  mutable std::mutex lock_;  // of all below
  CloudFrame frame_;
  bool isNew_ = false;
  std::exception_ptr failure_;
  std::jthread thread_;  // destroyed first
};

}  // namespace

std::unique_ptr<FarTouch> feelMatter(BrickSource& source, const InformationAge& known, const BackendSetup& setup) {
  const SessionConfig& config = setup.config;
  const Model& model = setup.model;
  if (config.tool.kind != ToolKind::point) throw ConfigError("tool.kind", "in matter a hand holds the scene's ball");
  const MatterScene& scene = matterOf(model.as<FarPoints>()->scene);
  constexpr std::uint64_t kMemory_bytes = std::uint64_t{1} << 32;  // limit for a scene from another program
  planOf(scene, kMemory_bytes);
  auto felt = std::make_unique<FarMatter>(source, known, scene, standingOf(model).get(),
                                          std::max<std::size_t>(1, config.hands.size()));
  // Reach of the weights.
  const double support = kSupport_spacings * particleSpacing_mm(scene);
  return std::make_unique<BrickTouch>(source, std::move(felt),
                                      BrickTouchOptions{.radius = support,
                                                        .tool = scene.tool.radius_mm,
                                                        .origin = model.cloud.origin,
                                                        .brush = brushOf(config.brush, model),
                                                        .fixed = fixedBecause(config, model)});
}

}  // namespace palpate
