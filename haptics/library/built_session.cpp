#include "haptics/library/built_session.hpp"

#include <utility>

#include "engine/core/job_stop.hpp"
#include "haptics/library/failures.hpp"

namespace palpate::library {

void BuiltSession::build(bool keepsPoints, bool editable) {
  if (!session_) return make(parts_.config, keepsPoints, editable);
  std::optional<Before> before({session_->config(), session_->pointHistory() != nullptr, editable_});
  try {
    make(before->config, keepsPoints, editable);
  } catch (const Stopped&) {
    before_ = std::move(before);  // building it now would take as long again
    throw;
  } catch (...) {
    before_ = std::move(before);  // moved: a copy would allocate, and memory may be what is missing
    ensure();
    throw;
  }
}

void BuiltSession::ensure() {
  if (!before_) return;
  make(before_->config, before_->keepsPoints, before_->editable);
  if (before_->config.brush) session_->setBrush(before_->config.brush);
  before_.reset();
}

void BuiltSession::make(SessionConfig config, bool keepsPoints, bool editable) {
  if (editable && !config.brush) config.brush = BrushConfig{};
  UndoConfig undo = config.undo;
  undo.undo = 1;  // any number above 0, so that memory for undo is allocated
  if (session_) pulled_ = session_->pulledState();
  session_.reset();
  parts_.forgets();
  const JobStopScope cuts(JobStopScope::cutting());
  session_ = std::make_unique<Session>(config, parts_.model,
                                       SessionParts{.backend = parts_.backend,
                                                    .threads = parts_.threads,
                                                    .keepsPoints = keepsPoints || parts_.model->far(),
                                                    .undo = {undoBytes(undo)},
                                                    .paintable = editable,
                                                    .sharedPatience_s = parts_.sharedPatience_s,
                                                    .log = &parts_.log,
                                                    .source = parts_.source,
                                                    .followers = {parts_.follower}});
  if (editable) session_->setBrush(std::nullopt);
  editable_ = editable || session_->shared() || session_->far();
  if (pulled_) session_->resumePulling(*std::exchange(pulled_, std::nullopt));
}

}  // namespace palpate::library
