// What every subcommand shares: the common options, the log, the GPU, and the machine-readable result.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/bounds.hpp"
#include "engine/core/log.hpp"
#include "engine/core/vec.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

using Json = nlohmann::ordered_json;

class Context {
 public:
  /// Adds the common options; every subcommand accepts them.
  void addOptions(CLI::App& app);

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

  /// By --gpu or --validate.
  bool asksForGpu() const { return !gpu_.empty() || validate_; }
  /// Sends the result where --json says; nothing without it.
  void writeJson(const Json& result) const;
  /// With --json - stdout belongs to the result, and tables go to stderr.
  std::FILE* tables() const { return json_ == "-" ? stderr : stdout; }

  /// Throws FileError now, rather than after an hour's work, when `file` could not be written.
  static void checkWritable(const std::string& file);

  /// Closes the GPUs; says how many validation messages there were.
  std::size_t closeDevices();

 private:
  std::string gpu_, json_;
  bool validate_ = false, quiet_ = false;
  unsigned threads_ = 0;
  std::unique_ptr<Log> log_;
  void close(std::unique_ptr<Device>& device);

  bool shows_ = false;
  std::vector<std::string> windowExtensions_;
  QueueArrangement queues_ = QueueArrangement::separate;
  std::size_t messages_ = 0;  // of the GPUs that are closed
  std::unique_ptr<Device> device_, sightDevice_;
};

/// Checks of numbers on the command line, with messages that say the bounds. Not-a-number and infinity never pass.
CLI::Validator between(double least, double most);
/// The same of a number without a fraction.
CLI::Validator wholeBetween(double least, double most);
/// A length in mm, or the word auto.
CLI::Validator lengthOrAuto();

/// What main() runs after the command line has been read.
using Command = std::function<void()>;

/// Each file of apps/ adds its subcommand: options, help, and what to do.
void addInfo(CLI::App& app, Context& context, Command& command);
void addMake(CLI::App& app, Context& context, Command& command);
void addTouch(CLI::App& app, Context& context, Command& command);
void addReplay(CLI::App& app, Context& context, Command& command);
void addRender(CLI::App& app, Context& context, Command& command);
void addView(CLI::App& app, Context& context, Command& command);
void addConvert(CLI::App& app, Context& context, Command& command);
void addMesh(CLI::App& app, Context& context, Command& command);
void addBench(CLI::App& app, Context& context, Command& command);
void addDoctor(CLI::App& app, Context& context, Command& command);

/// Throws Error when what was printed did not reach stdout.
void checkStdout();

/// Reads "x,y,z". Throws UsageError that names `option`.
DVec3 parseVec3(const std::string& text, const std::string& option);

}  // namespace palpate
