// State shared by all subcommands: the common options, the log, the GPU, and the machine-readable result.
#pragma once

#include <functional>
#include <memory>

#include "apps/cli/json.hpp"
#include "apps/cli/options.hpp"
#include "engine/core/log.hpp"
#include "engine/core/vec.hpp"
#include "engine/gpu/device.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate {

class Backends;
struct MemoryNeed;

class Context {
 public:
  Context();
  ~Context();

  /// Adds the common options; every subcommand accepts them.
  void addOptions(Options& app);

  Log& log();
  /// The GPU named by --gpu or PALPATE_GPU, opened at first use.
  Device& device();
  /// gpuProof() of the GPU of device().
  Json proof(std::FILE* out) const;
  /// Whether device() opens a real GPU, not a software driver. Opens nothing. False if there is no usable one; throws
  /// GpuError if one is requested by name.
  bool hasRealGpu() const;
  /// The same GPU for a thread of its own, which can use it beside all others.
  std::unique_ptr<Device> deviceApart() const;
  /// Another GPU, only for display, named by `gpu` (DeviceOptions), opened at its first use. The same one each time.
  Device& sightDevice(const std::string& gpu);
  /// Lets GPUs opened from now on show pictures in windows of a system that requires these instance extensions.
  void showInWindows(std::vector<std::string> extensions) {
    shows_ = true;
    windowExtensions_ = std::move(extensions);
  }
  /// Sets how the queues of device() are shared: an open GPU is closed. Requires that all objects made from it are
  /// destroyed.
  void arrange(QueueArrangement queues);
  unsigned threads() const { return threads_; }
  /// --force: do what was asked for although a file exists, or more memory is needed than is free.
  bool isForced() const { return forced_; }
  /// What a command does before it reads a file that needs more memory than is free (MemoryLimit::exceeded): asks in a
  /// terminal, refuses elsewhere; empty with --force.
  std::function<void(const MemoryNeed&)> exceedsMemory() const;
  /// The words of the command line, as a shell reads them, for results that say how they were made.
  void setCommandLine(const std::vector<std::string>& words);
  const std::string& commandLine() const { return commandLine_; }
  /// This program's back ends.
  const Backends& backends() const { return *backends_; }

  /// Whether --gpu or --validate is given.
  bool asksForGpu() const { return !gpu_.empty() || !validate_.empty(); }
  /// Throws UsageError or FileError if --json names a file that cannot be written (checkOutput()).
  void checkJson();
  /// Writes the result to the target of --json, if it is given.
  void writeJson(const Json& result) const;
  /// Writes a failure there in place of a result, unless there is one. A file that exists is replaced only after
  /// checkJson(): it may be the model. `words`: of the command line, which may not have been understood. Throws
  /// nothing.
  void writeFailure(std::string_view what, int code, const std::vector<std::string>& words) noexcept;
  /// Tables go to stderr from now on, as they do with --json -: stdout is reserved for a cloud. Throws UsageError with
  /// both.
  void reserveStdout();
  std::FILE* tables() const { return json_ == "-" || isStdoutReserved_ ? stderr : stdout; }

  /// Closes the GPUs; returns the number of validation messages.
  std::size_t closeDevices();

 private:
  Validation validation() const;

  std::string gpu_, json_, validate_, commandLine_;
  bool quiet_ = false, forced_ = false;
  mutable bool hasResult_ = false;
  bool isJsonChecked_ = false, isStdoutReserved_ = false;
  unsigned threads_ = 0;
  std::unique_ptr<Log> log_;
  void close(std::unique_ptr<Device>& device);

  bool shows_ = false;
  std::vector<std::string> windowExtensions_;
  QueueArrangement queues_ = QueueArrangement::separate;
  std::size_t messages_ = 0;  // of the closed GPUs
  std::unique_ptr<Device> device_, sightDevice_;
  std::unique_ptr<Backends> backends_;
};

/// The function that main() runs after the command line has been read.
using Command = std::function<void()>;

/// Each file of apps/cli adds its subcommand: options, help, and function.
void addInfo(Options& app, Context& context, Command& command);
void addMake(Options& app, Context& context, Command& command);
void addSimulate(Options& app, Context& context, Command& command);
void addTouch(Options& app, Context& context, Command& command);
void addReplay(Options& app, Context& context, Command& command);
void addReference(Options& app, Context& context, Command& command);
void addRender(Options& app, Context& context, Command& command);
void addView(Options& app, Context& context, Command& command);
void addConvert(Options& app, Context& context, Command& command);
void addServe(Options& app, Context& context, Command& command);
void addKeys(Options& app, Context& context, Command& command);
void addMesh(Options& app, Context& context, Command& command);
void addBench(Options& app, Context& context, Command& command);
void addDoctor(Options& app, Context& context, Command& command);

/// Throws Error if output could not be written to stdout.
void checkStdout();

/// Parses "x,y,z". Throws UsageError that names `option`.
DVec3 parseVec3(const std::string& text, const std::string& option);

}  // namespace palpate
