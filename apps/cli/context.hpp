// What every subcommand shares: the common options, the log, the GPU, and the machine-readable result.
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

class Context {
 public:
  Context();
  ~Context();

  /// Adds the common options; every subcommand accepts them.
  void addOptions(Options& app);

  Log& log();
  /// The GPU that --gpu or PALPATE_GPU names, opened at first use.
  Device& device();
  /// Whether the GPU that device() opens is one, and not a software driver. Opens nothing. False where there is none
  /// that palpate could use; throws GpuError where one is asked for by name.
  bool hasRealGpu() const;
  /// Another GPU, for sight alone, that `gpu` names (DeviceOptions), opened at its first use. The same one each time.
  Device& sightDevice(const std::string& gpu);
  /// GPUs that are opened from now on can show pictures in windows of a system that needs these instance extensions.
  void showInWindows(std::vector<std::string> extensions) {
    shows_ = true;
    windowExtensions_ = std::move(extensions);
  }
  /// How the queues of device() are shared from now on: an open GPU is closed, once all that was made from it is gone.
  void arrange(QueueArrangement queues);
  unsigned threads() const { return threads_; }
  /// The back ends that this program has.
  const Backends& backends() const { return *backends_; }

  /// By --gpu or --validate.
  bool asksForGpu() const { return !gpu_.empty() || !validate_.empty(); }
  /// Throws UsageError or FileError where --json names a file that is not written (checkOutput()).
  void checkJson() const;
  /// Sends the result where --json says; nothing without it.
  void writeJson(const Json& result) const;
  /// With --json - stdout belongs to the result, and tables go to stderr.
  std::FILE* tables() const { return json_ == "-" ? stderr : stdout; }

  /// Closes the GPUs; says how many validation messages there were.
  std::size_t closeDevices();

 private:
  Validation validation() const;

  std::string gpu_, json_, validate_;
  bool quiet_ = false;
  unsigned threads_ = 0;
  std::unique_ptr<Log> log_;
  void close(std::unique_ptr<Device>& device);

  bool shows_ = false;
  std::vector<std::string> windowExtensions_;
  QueueArrangement queues_ = QueueArrangement::separate;
  std::size_t messages_ = 0;  // of the GPUs that are closed
  std::unique_ptr<Device> device_, sightDevice_;
  std::unique_ptr<Backends> backends_;
};

/// What main() runs after the command line has been read.
using Command = std::function<void()>;

/// Each file of apps/cli adds its subcommand: options, help, and what to do.
void addInfo(Options& app, Context& context, Command& command);
void addMake(Options& app, Context& context, Command& command);
void addSimulate(Options& app, Context& context, Command& command);
void addTouch(Options& app, Context& context, Command& command);
void addReplay(Options& app, Context& context, Command& command);
void addRender(Options& app, Context& context, Command& command);
void addView(Options& app, Context& context, Command& command);
void addConvert(Options& app, Context& context, Command& command);
void addServe(Options& app, Context& context, Command& command);
void addKeys(Options& app, Context& context, Command& command);
void addMesh(Options& app, Context& context, Command& command);
void addBench(Options& app, Context& context, Command& command);
void addDoctor(Options& app, Context& context, Command& command);

/// Throws Error when what was printed did not reach stdout.
void checkStdout();

/// Reads "x,y,z". Throws UsageError that names `option`.
DVec3 parseVec3(const std::string& text, const std::string& option);

}  // namespace palpate
