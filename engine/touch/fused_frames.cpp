#include "engine/touch/fused_frames.hpp"

#include <algorithm>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

constexpr double kHandOver_s = 0.003;  // latency from a frame to the points that are felt

const FusedStream& checked(const FusedStream& frames, const LiveCloud& cloud) {
  PALPATE_CHECK(frames.stream && frames.stream->player && frames.begin);
  PALPATE_CHECK_EQ(frames.begin->size(), std::size_t{cloud.count()});
  return frames;
}

}  // namespace

FusedFrames::FusedFrames(Device& device, const FusedStream& frames, const LiveCloud& cloud)
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

void FusedFrames::startOver(const LiveCloud::Half& incoming) {
  pass_.reset(*queue_, begun());
  cloud_.upload(*queue_, begun(), incoming);
  intake_.beginAt(begunFrom_);
  frames_.stream->seenFrom = begunFrom_;
  from_s_ = comes_s_ = 0;
}

bool FusedFrames::puts(const DepthCamera& camera, const DepthFrame& frame) {
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

MadeFrame FusedFrames::make(double time_s, const LiveCloud::Half& incoming) {
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

void FusedFrames::record(CommandList& list, const Front& front, const LiveCloud::Half& incoming,
                         const Buffer& velocities) const {
  pass_.record(list, front.points, incoming, {.from = front.velocities.address(), .to = velocities.address()});
}

}  // namespace palpate
