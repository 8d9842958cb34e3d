// A session that is built for feeling only, and built again to be recorded or sculpted.
#pragma once

#include <memory>
#include <optional>

#include "haptics/session/session.hpp"

namespace palpate::library {

class BuiltSession {
 public:
  struct Parts {
    SessionConfig config;  ///< as opened
    std::shared_ptr<const Model> model;
    const BackendKind& backend;
    unsigned threads = 0;
    double sharedPatience_s = kSharedPatience_s;
    Log& log;
    CloudSource* source = nullptr;
    FollowerMaker follower;         ///< receives all edits
    std::function<void()> forgets;  ///< called before another session replaces this one
  };
  /// The pointees must outlive this. Nothing is built yet.
  explicit BuiltSession(Parts parts) : parts_(std::move(parts)) {}

  /// With a history of the points if it is to be recorded, and for all kinds of brushes if it is to be edited. Restores
  /// the previous session if the new one cannot be built; a stopped call leaves that to ensure(). Throws Error,
  /// Stopped.
  void build(bool keepsPoints, bool editable);
  /// Builds the session that a stopped call has left to be restored.
  void ensure();

  /// False between a stopped call and ensure().
  explicit operator bool() const { return session_ != nullptr; }
  Session& operator*() const { return *session_; }
  Session* operator->() const { return session_.get(); }

  const SessionConfig& opened() const { return parts_.config; }
  const Model& model() const { return *parts_.model; }
  /// Takes a brush without being built again; else the session refuses one with a reason.
  bool isEditable() const { return editable_; }
  bool hasFailed() const { return session_->simulation() && !session_->simulation()->failure().empty(); }

 private:
  void make(SessionConfig config, bool keepsPoints, bool editable);

  Parts parts_;
  bool editable_ = false;
  struct Before {
    SessionConfig config;
    bool keepsPoints, editable;
  };
  std::optional<Before> before_;  // to be built by ensure(), if session_ is null
  std::unique_ptr<Session> session_;
  std::optional<PulledState> pulled_;  // of a session that is being replaced
};

}  // namespace palpate::library
