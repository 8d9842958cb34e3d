// How a session exchanges its edits with others who sculpt the model.
#include <chrono>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/core/job_stop.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

namespace {

constexpr double kOthersBusy_s = 1;  // maximum wait for others who still edit, once this hand's edits are accepted

}  // namespace

// Points around the hands alone: waits until the server has accepted their edits.
bool Session::settleFar(double timeout_s) {
  backend_->finish();  // the edit in progress
  const Stopwatch since;
  while (!model().far()->counts().delivered && !isStopWanted() && since.elapsed_s() < timeout_s) {
    model().far()->check();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return model().far()->counts().delivered;
}

bool Session::settleShared(double timeout_s, Settling until) {
  if (model().far()) return settleFar(timeout_s);
  if (!shared_) return true;
  const Stopwatch since;
  relay_.catchUp();
  // The last message may be older than this call: another hand's strokes may be with the server and not yet here.
  if (until == Settling::all) shared_->askServer();
  SharedCounts counts = shared_->counts();
  const auto isSettled = [&] { return counts.idle && counts.same; };
  const std::uint64_t inEffectBefore = counts.inEffect;
  const auto goesOnWithoutUs = [&] {
    return until == Settling::known && counts.delivered && counts.inEffect > inEffectBefore &&
           since.elapsed_s() > kOthersBusy_s;
  };
  const auto isOver = [&] { return isSettled() || !counts.fault.empty() || goesOnWithoutUs(); };
  const std::vector<ProxyTracker::State> contacts = backend_->contacts();
  std::vector<Pose> far(backend_->hands());
  // Hands that touch nothing: the changes of others are applied between their answers.
  const Bounds box = boundsOf(model().cloud);
  constexpr double kFar = 1e3;  // longest sides
  const DVec3 nowhere = model().cloud.origin + box.center() + DVec3(0, 0, kFar * std::max(box.longestSide(), 1.0));
  for (Pose& pose : far) pose = {.time_s = last_s_, .hip = nowhere, .sculpts = false};
  bool hasAsked = false;
  const auto goesOn = [&] { return !isOver() && !isStopWanted() && since.elapsed_s() < timeout_s; };
  do {
    for (; goesOn(); counts = shared_->counts()) {
      backend_->query(far, 0);
      hasAsked = true;
      relay_.catchUp();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    backend_->finish();
    relay_.catchUp();
    counts = shared_->counts();  // with the changes that took effect meanwhile
  } while (goesOn());
  if (hasAsked)
    for (std::size_t hand = 0; hand < far.size(); ++hand) backend_->resetHand(hand);
  if (hasAsked && pulled_) backend_->restoreContacts(contacts);
  return isSettled();
}

std::optional<ServerSave> Session::saveAtServer(double timeout_s) const {
  FarCloud* const near = model().far();
  ServerFile* const file = near && near->isSculptable() ? near->file() : shared_ ? shared_->file() : nullptr;
  if (!file) return std::nullopt;
  const auto isDelivered = [&] { return near ? near->counts().delivered : shared_->counts().delivered; };
  const auto isHeard = [&] { return known()->share() > 0; };
  bool isAsked = false;
  std::optional<ServerSave> answer;
  for (const Stopwatch since; !answer && !isStopWanted() && isHeard() && since.elapsed_s() < timeout_s;) {
    if (!isAsked && isDelivered()) {
      file->requestWrite();
      isAsked = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (isAsked) answer = file->answer();
  }
  if (answer) return answer;
  if (!isHeard()) return ServerSave{.words = "it is silent"};
  return ServerSave{.words = fmt::format("it has not {} within {:.3g} s",
                                         isAsked ? "answered" : "received all edits made here", timeout_s)};
}

std::string inWords(const ServerSave& save) {
  return save.written ? fmt::format("the server has saved all {} points in {}", save.points, save.words)
                      : fmt::format("the server has not saved its points: {}", save.words);
}

bool Session::deliver(double timeout_s, double unheard_s) {
  if (!shared_ && !model().far()) return true;
  backend_->finish();
  relay_.catchUp();
  const auto isDelivered = [&] { return shared_ ? shared_->counts().delivered : model().far()->counts().delivered; };
  const auto isHeard = [&] { return known()->isTrue() && known()->share() > 0; };
  for (const Stopwatch since; !isDelivered();) {
    if (isStopWanted() || since.elapsed_s() >= timeout_s || (since.elapsed_s() >= unheard_s && !isHeard())) {
      if (log_)
        log_->warn("'{}': the server has not confirmed all strokes of this hand, which may be lost",
                   config_.model.file);
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace palpate
