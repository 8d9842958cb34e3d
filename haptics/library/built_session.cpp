#include "haptics/library/built_session.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/job_stop.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/gpu_half.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/backend_choice.hpp"

namespace palpate::library {

namespace {

std::size_t handsFrom(const pp_session_options& options) {
  if (options.hands > PP_MAX_HANDS) throw UsageError("hands: {} exceed the maximum of {}", options.hands, PP_MAX_HANDS);
  return std::max(1u, options.hands);
}

}  // namespace

Path PathTime::later(const Path& path) const {
  std::vector<PathKey> keys(path.keys().begin(), path.keys().end());
  for (PathKey& key : keys) key.t_s += next_s_;
  return Path(std::move(keys));
}

bool PathTime::goesOn(std::size_t hand, const Path& path, const ModelScale& scale) const {
  constexpr double kSamePlace_mm = 1;
  return next_s_ > 0 && hand < hips_.size() && scale.toMm(glm::distance(path.at(0), hips_[hand])) <= kSamePlace_mm;
}

void PathTime::restart() {
  next_s_ = 0;
  hips_.clear();
}

void PathTime::ended(const ServoResult& result, double tick_s) {
  if (!result.trace().rows.empty()) next_s_ = result.trace().rows.back().time_s + tick_s;
  hips_.clear();
  for (const HandResult& hand : result.hands)
    if (!hand.trace.rows.empty()) hips_.push_back(hand.trace.rows.back().hip);
}

void PathTime::ticked(double next_s) {
  reset_.store(false, std::memory_order_relaxed);
  hips_.clear();
  next_s_ = next_s;
}

SessionConfig configFrom(const Subject& subject, const pp_session_options& options) {
  const pp_contact_options contact = optionsFrom(options.contact, "contact");
  SessionConfig config{.model = subject.model, .surface = surfaceFrom(contact), .force = forceFrom(contact)};
  config.model.mm_per_unit = options.mm_per_unit;
  if (options.estimate_normals) config.model.normals = NormalSource::estimate;
  if (options.tool) config.tool = toolFrom(optionsFrom(options.tool, "tool"));
  config.hands.resize(handsFrom(options));
  config.rate_Hz = options.rate_Hz;
  config.undo.memory_MiB = options.undo_memory_MiB;
  config.backend.name = backendOf(options.backend, {options.gpu, options.vulkan}, hasRealGpu);
  validate(config);
  return config;
}

Model modelFrom(const Subject& subject, const SessionConfig& config, const ModelLoading& loading) {
  if (!subject.hasArrays()) return loadModel(config.model, loading);
  ModelConfig model = config.model;
  PointCloud cloud;
  if (subject.clouds.empty()) {
    cloud = *subject.cloud;
  } else {
    cloud = mergedCloud(subject.clouds, model.normals, loading);
    model.normals = NormalSource::keep;
  }
  if (cloud.empty()) throw UsageError("the cloud contains no points");
  return modelOf(std::move(cloud), model, loading);
}

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
