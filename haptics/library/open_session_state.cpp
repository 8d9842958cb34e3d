// What an OpenSession answers about itself: its state, pictures, meshes, rows, frames and motion.
#include "haptics/library/defaults.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/open_session.hpp"
#include "haptics/library/options.hpp"

namespace palpate::library {

pp_session_info OpenSession::info() const {
  pp_session_info info = usual<pp_session_info>();
  const ModelScale& scale = model_->scale;
  info.live = isLive();
  info.points = model_->cloud.size();
  info.mm_per_unit = scale.mm_per_unit;
  info.spacing_mm = scale.toMm(model_->spacing);
  info.radius_mm = scale.toMm(session_->surface().radius);
  info.rate_Hz = session_->config().rate_Hz;
  const StrokeCounts strokes = session_->strokes();
  const History* const history = session_->history();
  info.undo_count = strokes.undoCount + (history && history->isKeepingStroke() ? 1 : 0);
  info.redo_count = strokes.redoCount;
  info.edits = views_.edits();
  const BlockedMoves blocked = session_->blocked();
  info.blocked_moves = blocked.moves;
  info.blocked_edits = blocked.edits;
  const BridgedTicks bridged = session_->bridged();
  info.bridged_ticks = bridged.ticks;
  info.thinned_ticks = bridged.thinned;
  putText(session_.opened().backend.name, info.backend);
  putText(session_->machine(), info.machine);
  return info;
}

Image OpenSession::draw(const PictureRequest& request) {
  takeIn();
  return views_.draw(*session_, frameIfMoving().get(), request);
}

const SurfaceIndex& OpenSession::surfaceIndex() {
  takeIn();
  return views_.surface(*session_, frameIfMoving());
}

std::vector<pp_row> OpenSession::rows() {
  if (moves()) throw StateError("the points of this session move, and have no rows of a cloud; read them as a frame");
  takeIn();
  return views_.rows(*session_);
}

Mesh OpenSession::mesh(const pp_mesh_options& options) {
  takeIn();
  return views_.mesh(*session_, frameIfMoving().get(), options);
}

std::shared_ptr<const FrameObject> OpenSession::frame() {
  if (!moves()) throw StateError("the points of this session do not move; request the cloud instead of a frame");
  return frames_.newest(*session_, isLive());
}

SimulationControl& OpenSession::simulation() const {
  if (SimulationControl* const control = session_->simulation()) return *control;
  throw StateError("the points of this session do not move by themselves; a scene of matter (water, sand, jelly) does");
}

void OpenSession::reset() {
  simulation().reset();
  time_.askReset();
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
