#pragma once

#include <atomic>
#include <future>
#include <mutex>

#include "apps/view/session.hpp"
#include "engine/io/memory_need.hpp"

namespace palpate {

/// Opens models one at a time on another thread, so that the window stays responsive: reads the file, then builds the
/// session on the GPUs. The build uses the queues of touch and sight: from build() until take() returns the result,
/// the thread that shows pictures must not use them.
class Loader final : private LogListener {
 public:
  Loader(Context& context, Device& sight) : context_(context), sight_(sight) {}
  ~Loader() override;
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  /// Cancels the present load and begins with another file.
  void open(WindowOptions options, const BrushSettings& brush, const FeelSettings& feel);
  /// The same with a given model, which is not read from the file.
  void open(WindowOptions options, const BrushSettings& brush, const FeelSettings& feel, Model model);
  bool isLoading() const { return result_.valid(); }
  /// Ends the present load soon: take() then returns an empty result.
  void stop();
  bool isStopped() const { return cancelled_; }
  /// The same, and waits for its thread.
  void cancel();
  std::string file() const { return options_.config.model.file; }
  double progress() const { return progress_; }
  std::string stage() const;
  /// Remarks since the last call.
  std::vector<std::string> takeRemarks();

  /// Whether the file has been read and is valid: build() may be called once the present session is parked.
  bool isRead() const { return isRead_; }
  /// Lets the thread build the session.
  void build();
  /// The session, or the failure.
  struct Result {
    std::unique_ptr<WindowSession> session;
    std::string failure;
    bool lacksMemory = false;        ///< the load may succeed once the present model is closed
    std::optional<MemoryNeed> need;  ///< it was not read: it needs more memory than is free
  };
  std::optional<Result> take();

 private:
  void said(std::string_view line) override;
  void progressed(std::string_view what, double fraction) override;
  void begin(WindowOptions options, const BrushSettings& brush, const FeelSettings& feel, const std::string& what);
  Result load();
  void enter(std::string stage, double progress);

  Context& context_;
  Device& sight_;
  WindowOptions options_;
  BrushSettings brush_;
  FeelSettings feel_;
  std::optional<Model> given_;  // replaces the contents of the file
  std::atomic<bool> cancelled_ = false, isRead_ = false;
  std::atomic<double> progress_ = 0;
  std::promise<void> mayBuild_;
  bool isLet_ = false;  // build() was called
  mutable std::mutex lock_;
  std::string stage_;
  std::vector<std::string> remarks_;
  std::future<Result> result_;
};

}  // namespace palpate
