// Sessions whose points move: their frames, and control of the simulation.
#include <chrono>
#include <thread>
#include <utility>

#include "haptics/library/failures.hpp"
#include "haptics/library/open_session.hpp"
#include "haptics/library/options.hpp"

namespace palpate::library {

std::size_t OpenSession::standing() const { return model_->standing(); }

bool OpenSession::takeFrame() {
  CloudFrame taken;
  FrameStream* const frames = session_->backend().frames();
  if (!frames || !frames->take(taken)) return false;
  auto frame = std::make_shared<FrameObject>();
  frame->cloud.origin = model_->cloud.origin;
  frame->cloud.positions = std::move(taken.positions);
  frame->cloud.normals = std::move(taken.normals);
  frame->velocities = std::move(taken.velocities);
  frame->velocities.resize(frame->cloud.size(), Vec3(0));
  frame->moving = frame->cloud.size() - standing();
  frame->time_s = taken.time_s;
  frame_ = std::move(frame);
  return true;
}

std::shared_ptr<const FrameObject> OpenSession::frame() {
  if (!moves()) throw StateError("the points of this session do not move; request the cloud instead of a frame");
  if (!frame_) {
    auto first = std::make_shared<FrameObject>();
    first->cloud.origin = model_->cloud.origin;
    first->cloud.positions = model_->cloud.positions;
    first->cloud.normals = model_->cloud.normals;
    first->velocities.assign(model_->cloud.size(), Vec3(0));
    first->moving = first->cloud.size() - standing();
    frame_ = std::move(first);
  }
  takeFrame();
  if (!isLive()) return frame_;
  // The frame that was ready may be as old as the last request.
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
  while (!takeFrame() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return frame_;
}

void OpenSession::pushFrame(PointCloud cloud, std::vector<Vec3> velocities, double time_s) {
  if (!frames_) throw StateError("this session was not opened for points that move frame by frame");
  CloudFrame frame;
  frame.time_s = time_s;
  frame.positions = std::move(cloud.positions);
  frame.normals = std::move(cloud.normals);
  frame.velocities = std::move(velocities);
  const DVec3 away = cloud.origin - model_->cloud.origin;
  for (Vec3& position : frame.positions) position = Vec3(DVec3(position) + away);
  frames_->push(std::move(frame));
}

SimulationControl& OpenSession::simulation() const {
  if (SimulationControl* const control = session_->simulation()) return *control;
  throw StateError("the points of this session do not move by themselves; a scene of matter (water, sand, jelly) does");
}

void OpenSession::reset() {
  simulation().reset();
  reset_ = true;
}

void OpenSession::setParameter(std::string_view name, double value) {
  simulation();
  try {
    session_->setParameter(name, value);
  } catch (const UsageError&) {
    throw;
  } catch (const Error& error) {
    throw UsageError("{}", error.what());
  }
}

pp_motion OpenSession::motion() const {
  const SimulationControl& control = simulation();
  pp_motion motion = usual<pp_motion>();
  motion.paused = control.isPaused();
  const std::string failure = control.failure();
  motion.failed = !failure.empty();
  motion.hands = static_cast<std::uint32_t>(hands());
  putText(failure, motion.failure);
  motion.dropped_s = control.dropped_s();
  const std::vector<PortEnergy> energies = control.portEnergies();
  for (std::size_t i = 0; i < energies.size() && i < PP_MAX_HANDS; ++i) {
    motion.energy_J[i] = energies[i].now_J;
    motion.min_energy_J[i] = energies[i].min_J;
  }
  return motion;
}

}  // namespace palpate::library
