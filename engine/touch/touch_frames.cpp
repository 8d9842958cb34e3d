#include "engine/touch/touch_frames.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/frame_carrier.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/motion/frame_intake.hpp"
#include "engine/motion/fused_stream.hpp"
#include "engine/motion/pose_search_pass.hpp"
#include "engine/touch/frame_pipeline.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

namespace {

constexpr double kHandOver_s = 0.003;  // latency from a frame to the points that are felt

const FusedStream& checked(const FusedStream& frames, const LiveCloud& cloud) {
  PALPATE_CHECK(frames.stream && frames.stream->player && frames.begin);
  PALPATE_CHECK_EQ(frames.begin->size(), std::size_t{cloud.count()});
  return frames;
}

/// The map into which depth frames are fused on the GPU, as points of the live cloud; edits of those since the last
/// frame are kept. A frame without a camera pose is registered against the front half on a queue of its own, which
/// yields to questions; that half is not written before the frame is made. The effect of a frame on a point is spread
/// over the time until the next frame is due, as in FusedSource. If the stream is taken away, the map is unchanged.
class FusedFrames final : public FrameWriter {
 public:
  /// `frames.begin` is the initial live cloud; its points have the first ids. Throws as FusionPass.
  FusedFrames(Device& device, const FusedStream& frames, const LiveCloud& cloud)
      : frames_(checked(frames, cloud)),
        begunFrom_(frames.stream->seenFrom),
        cloud_(cloud),
        queue_(device.backgroundQueue().another()),
        pass_(device, frames.stream->player->camera(), frames.options, cloud.slots()),
        search_(device, *queue_, pass_, cloud),
        intake_(frames.options, frames.icp, frames.log),
        isExact_(frames.stream->player->isExact()),
        colored_(begun().hasColors()) {
    pass_.reset(*queue_, begun());
    intake_.beginAt(begunFrom_);
  }

  std::size_t size() const override { return cloud_.slots(); }
  /// Takes the next frame from the stream's player; a frame that cannot be registered or fused is reported, counted as
  /// lost, and skipped. If the time has gone back, restores the initial map first.
  MadeFrame make(double time_s, const LiveCloud::Half& incoming) override {
    if (!frames_.stream->player) return MadeFrame::none;
    DepthPlayer& player = *frames_.stream->player;
    if (player.rewindFor(time_s)) {
      startOver(incoming);
      return MadeFrame::incoming;
    }
    MadeFrame made = MadeFrame::none;
    while (const auto played = player.nextDue(time_s)) {
      // Points whose motion began before they can be felt would jump by the latency.
      const double from_s = isExact_ ? played->time_s : std::max(played->time_s, time_s + kHandOver_s);
      pass_.setWay(std::clamp(from_s_ + comes_s_ - from_s, 0.0, comes_s_), played->lasts_s);
      if (puts(player.camera(), played->frame)) {
        from_s_ = from_s;
        comes_s_ = played->lasts_s;
        made = MadeFrame::recorded;
        break;
      }
      player.leaveOut(intake_.why());
    }
    intake_.sayWhereFull(pass_.counts().refused);
    const DepthPlayer::Losses losses = player.takeLosses();
    intake_.countLost(losses.why, losses.frames);
    return made;
  }

  void record(CommandList& list, const Front& front, const LiveCloud::Half& incoming,
              const Buffer& velocities) const override {
    pass_.record(list, front.points, incoming, {.from = front.velocities.address(), .to = velocities.address()});
  }

  bool turnsNormals() const override { return true; }
  double time_s() const override { return from_s_; }
  double extrapolationLimit_s() const override { return 0; }
  double comes_s() const override { return comes_s_; }
  bool isColored() const override { return colored_; }
  bool looksAtPoints() const override { return true; }
  std::uint64_t points() const override { return pass_.counts().points; }

 private:
  const PointCloud& begun() const { return *frames_.begin; }
  void startOver(const LiveCloud::Half& incoming) {
    pass_.reset(*queue_, begun());
    cloud_.upload(*queue_, begun(), incoming);
    intake_.beginAt(begunFrom_);
    frames_.stream->seenFrom = begunFrom_;
    from_s_ = comes_s_ = 0;
  }

  // False if the frame is skipped; the intake has the reason.
  bool puts(const DepthCamera& camera, const DepthFrame& frame) {
    if (!intake_.read(camera, frame)) return false;
    pass_.put(intake_.images(), frame.pose.value_or(CameraPose{}), begun().origin);
    const std::optional<CameraPose> pose =
        intake_.place(frame, [&](const CameraPose& expected, const IcpOptions& options) {
          return search_.find(intake_.images(), expected, begun().origin, options);
        });
    if (!pose) return false;
    pass_.setPose(intake_.images(), *pose, begun().origin);
    // The count of points without room is that of the previous frame, whose list has run.
    intake_.fused(*pose, pass_.counts().refused);
    frames_.stream->seenFrom = pose;
    colored_ |= !intake_.images().colors.empty();
    return true;
  }

  FusedStream frames_;
  std::optional<CameraPose> begunFrom_;  // camera pose of the last frame in the initial map
  const LiveCloud& cloud_;
  std::unique_ptr<Queue> queue_;  // used by make()
  FusionPass pass_;
  PoseSearchPass search_;
  FrameIntake intake_;
  bool isExact_;
  double from_s_ = 0, comes_s_ = 0;  // start and duration of its points' motion to their positions
  bool colored_;
};

/// Frames that a source makes on the host, copied to the GPU as a whole.
class HostFrames final : public FrameWriter {
 public:
  /// `source` must outlive it.
  HostFrames(Device& device, CloudSource& source)
      : source_(source),
        positions_(Buffer::of<Vec4>(device, source.size(), Memory::upload, "staged positions")),
        normals_(Buffer::of<Vec4>(device, source.size(), Memory::upload, "staged normals")),
        velocities_(Buffer::of<Vec4>(device, (source.turnsNormals() ? 2 : 1) * source.size(), Memory::upload,
                                     "staged velocities")) {}

  std::size_t size() const override { return source_.size(); }
  MadeFrame make(double time_s, const LiveCloud::Half& /*incoming*/) override {
    if (made_s_ && (*made_s_ == time_s || !source_.hasNewer(time_s, frame_.time_s))) return MadeFrame::none;
    made_s_ = time_s;
    source_.makeFrame(time_s, frame_);
    requireWhole(frame_, source_.size());
    stage();
    return MadeFrame::recorded;
  }

  void record(CommandList& list, const Front& /*front*/, const LiveCloud::Half& incoming,
              const Buffer& velocities) const override {
    const auto overlap = list.independent();
    list.copy(positions_, incoming.positions, positions_.bytes());
    list.copy(normals_, incoming.normals, normals_.bytes());
    list.copy(velocities_, velocities, velocities_.bytes());
  }

  double time_s() const override { return frame_.time_s; }
  bool turnsNormals() const override { return source_.turnsNormals(); }
  double extrapolationLimit_s() const override { return frame_.extrapolationLimit_s; }
  double comes_s() const override { return frame_.comes_s; }
  bool isColored() const override { return !frame_.colors.empty(); }
  std::uint64_t points() const override { return frame_.size(); }

 private:
  void stage() {
    const std::span<Vec4> positions = positions_.mapped<Vec4>(), normals = normals_.mapped<Vec4>();
    const std::span<Vec4> velocities = velocities_.mapped<Vec4>();
    for (std::size_t i = 0; i < frame_.size(); ++i) {
      const std::uint32_t id = frame_.idOf(i);
      const auto [red, green, blue] = frame_.colors.empty() ? std::array<std::uint8_t, 3>{} : frame_.colors[i];
      positions[i] = Vec4(frame_.positions[i], std::bit_cast<float>(id));
      normals[i] = Vec4(frame_.normals[i], std::bit_cast<float>(bitsOfColor(red, green, blue)));
      velocities[id] = frame_.velocities.empty() ? Vec4(0) : Vec4(frame_.velocities[i], frame_.slides ? 0.0f : 1.0f);
      if (turnsNormals()) velocities[size() + id] = frame_.turns.empty() ? Vec4(0) : Vec4(frame_.turns[i], 0.0f);
    }
    std::ranges::fill(positions.subspan(frame_.size()), Vec4(0, 0, 0, std::bit_cast<float>(shared::kEmptySlot)));
  }

  CloudSource& source_;
  CloudFrame frame_;
  std::optional<double> made_s_;             // last requested time
  Buffer positions_, normals_, velocities_;  // staging buffers
};

const FrameCarrier& carrierOf(CloudSource& source) {
  PALPATE_CHECK(source.carrier() != nullptr);
  return *source.carrier();
}

/// Frames of a source that moves its points on the GPU (CloudSource::carrier()): they never reach the host.
class CarriedFrames final : public FrameWriter {
 public:
  /// `source` must outlive it; its carrier must be on the device whose lists record() gets. `origin`: of the live
  /// cloud.
  CarriedFrames(CloudSource& source, const DVec3& origin)
      : source_(source), carrier_(carrierOf(source)), origin_(origin) {}

  std::size_t size() const override { return source_.size(); }
  MadeFrame make(double time_s, const LiveCloud::Half& /*incoming*/) override {
    if (isMade_ && !source_.hasNewer(time_s, time_s_)) return MadeFrame::none;
    isMade_ = true;
    const std::optional<double> trueFor_s = source_.goTo(time_s);
    if (!trueFor_s) return MadeFrame::none;
    time_s_ = *trueFor_s;
    return MadeFrame::recorded;
  }

  void record(CommandList& list, const Front& /*front*/, const LiveCloud::Half& incoming,
              const Buffer& velocities) const override {
    carrier_.recordFrame(list, {.positions = incoming.positions.address(),
                                .normals = incoming.normals.address(),
                                .velocities = velocities.address(),
                                .unitsPerMetre = 1 / kCarriedUnit_m,
                                .origin = origin_});
  }

  double time_s() const override { return time_s_; }
  bool isColored() const override { return false; }

 private:
  CloudSource& source_;
  const FrameCarrier& carrier_;
  DVec3 origin_;
  double time_s_ = 0;
  bool isMade_ = false;  // a frame has been made
};

// A cloud whose index is always rebuilt needs spare slots only for new points.
constexpr std::uint32_t kFewerSpare = 4;

std::unique_ptr<FrameWriter> writerOf(Device& device, const TouchOptions& options, const LiveCloud& cloud,
                                      const DVec3& origin) {
  PALPATE_CHECK(!(options.source && options.fusion));
  if (options.fusion) return std::make_unique<FusedFrames>(device, *options.fusion, cloud);
  if (options.source && options.source->carrier()) return std::make_unique<CarriedFrames>(*options.source, origin);
  if (options.source) return std::make_unique<HostFrames>(device, *options.source);
  return nullptr;
}

}  // namespace

std::uint32_t spareSlots(const PointCloud& cloud, const TouchOptions& options) {
  if (moves(options)) {
    const std::size_t slots = options.fusion ? options.fusion->options.capacity : options.source->size();
    PALPATE_CHECK_LE(cloud.size(), slots);
    return static_cast<std::uint32_t>(slots - cloud.size());
  }
  if (!options.brush) return 0;
  const std::uint32_t spare = HashUpdate::spareSlots(cloud.size());
  return options.index == IndexFollow::rebuild ? spare / kFewerSpare : options.spareSlots.value_or(spare);
}

TouchFrames::TouchFrames(Device& device, const TouchOptions& options, LiveIndex& index, const DVec3& origin)
    : index_(index), writer_(writerOf(device, options, index.cloud(), origin)) {
  if (writer_) frames_.emplace(device, *writer_, index_);
}

PointsMotion TouchFrames::motionSince(double last_s, double now_s) const {
  return frames_ ? pointsMotion(now_s, pointsTime(), last_s) : PointsMotion{};
}

std::size_t TouchFrames::readBack(PointCloud& cloud) const { return placeAt(frames_->front(), cloud); }

}  // namespace palpate
