#pragma once

#include <atomic>
#include <future>
#include <mutex>

#include "apps/view/session.hpp"

namespace palpate {

/// Opens models one at a time, on a thread of its own, so that a window stays alive meanwhile: reads the file, and
/// builds the session on the GPUs. That uses the queues of touch and sight: the thread that shows pictures keeps off
/// them from mayBuild() on until the session is there.
class Loader final : private LogListener {
 public:
  Loader(Context& context, Device& sight) : context_(context), sight_(sight) {}
  ~Loader() override;
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  /// Ends what is being loaded, and begins with another file.
  void open(WindowOptions options, const BrushSettings& brush, const FeelSettings& feel);
  /// The same with a model that is there, and is not read.
  void open(WindowOptions options, const BrushSettings& brush, const FeelSettings& feel, Model model);
  bool isLoading() const { return result_.valid(); }
  /// Nothing is loaded any more.
  void cancel();
  std::string file() const { return options_.config.model.file; }
  double progress() const { return progress_; }
  std::string stage() const;
  /// What was said since the last call.
  std::vector<std::string> takeRemarks();

  /// The file has been read, and is good: once the last session is gone, build() may be called.
  bool isRead() const { return isRead_; }
  /// The thread goes on to build the session.
  void build();
  /// The session, or why there is none, once either is known.
  struct Result {
    std::unique_ptr<WindowSession> session;
    std::string failure;
    bool lacksMemory = false;  ///< which there would be, perhaps, if no other model were open
  };
  std::optional<Result> take();

 private:
  struct Cancelled {};
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
  std::optional<Model> given_;  // in place of what the file has
  std::atomic<bool> cancelled_ = false, isRead_ = false;
  std::atomic<double> progress_ = 0;
  std::promise<void> mayBuild_;
  bool isLet_ = false;  // that it may build
  mutable std::mutex lock_;
  std::string stage_;
  std::vector<std::string> remarks_;
  std::future<Result> result_;
};

}  // namespace palpate
