#include "apps/cli/context.hpp"

#include "haptics/session/vulkan_backend.hpp"
#include "haptics/study/cuda_backend.hpp"

#include <charconv>
#include <iostream>

#include "apps/cli/doctor_prove.hpp"
#include "apps/cli/output.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/core/console.hpp"
#include "engine/core/error.hpp"
#include "engine/core/shown_names.hpp"
#include "engine/core/system_file.hpp"
#include "engine/gpu/device_lookup.hpp"
#include "engine/io/memory_need.hpp"

namespace palpate {

Context::Context() {
  std::vector<std::unique_ptr<BackendKind>> kinds;
  kinds.push_back(vulkanBackend([this]() -> Device& { return device(); },
                                [this](Device& gpu) {
                                  const auto damaged = [this](std::string_view what) { log().say("{}", what); };
                                  return wrongOn(gpu, GpuProofs(), damaged, [&] {
                                    log().say("proving {}, once for this driver", gpu.name());
                                    return proveInOwnProcess(gpu_);
                                  });
                                }));
  kinds.push_back(cudaBackend());
  kinds.push_back(cpuBackend());
  backends_ = std::make_unique<Backends>(std::move(kinds));
}

Context::~Context() = default;

Validation Context::validation() const {
  return validate_.empty() ? Validation::off : validate_ == "core" ? Validation::core : Validation::full;
}

void Context::addOptions(Options& app) {
  app.add("--gpu", gpu_, "GPU, by number or part of its name (default: PALPATE_GPU, else the best one)");
  app.addFlag("--validate", validate_, std::vector<std::string>{"full", "core"},
              "enable validation layers (core, synchronisation, GPU-assisted; --validate=core without the "
              "slow GPU-assisted part); any message makes the exit code 1");
  app.add("--json", json_, "write machine-readable results, or the error, to this file, or to stdout with -")
      .typeName("FILE|-")
      .writes(Writes::replacing)
      .check({[](const std::string& text) { return text.empty() ? std::string("needs a file name or -") : ""; }});
  app.add("--threads", threads_, "CPU threads for loading, making clouds and --backend cpu; 0: one per core")
      .check(wholeBetween(0, bounds::kMaxThreads));
  app.addFlag("--force", forced_,
              "read a model that needs more memory than is free; convert: replace an existing OUT, which is kept as "
              "OUT.bak; render --turntable: replace existing pictures");
  app.addFlag("--quiet", quiet_, "no messages and no progress; results are still printed");
}

void Context::setCommandLine(const std::vector<std::string>& words) {
  commandLine_ = "palpate";
  for (const std::string& word : words)
    commandLine_ +=
        word.empty() || word.find_first_of(" \"'$&;|<>*?(){}\\") != word.npos ? fmt::format(" '{}'", word) : " " + word;
}

std::function<void(const MemoryNeed&)> Context::exceedsMemory() const {
  if (forced_) return {};
  return [](const MemoryNeed& need) {
    if (isErrorConsole() && isTerminal(stdin)) {
      fmt::print(stderr, "{} {}. Read it nevertheless? [y/N] ", need.file.string(), need.sentence());
      if (std::string answer; std::getline(std::cin, answer) && (answer == "y" || answer == "Y")) return;
    }
    throw FileError(need.file, need.sentence() + "; --force reads it nevertheless");
  };
}

Log& Context::log() {
  if (!log_) log_ = std::make_unique<Log>(quiet_);
  return *log_;
}

Device& Context::device() {
  if (!device_)
    device_ = openProven({.gpu = gpu_,
                          .validation = validation(),
                          .queues = queues_,
                          .shows = shows_,
                          .windowExtensions = windowExtensions_});
  return *device_;
}

std::unique_ptr<Device> Context::deviceApart() const { return openProven({.gpu = gpu_, .validation = validation()}); }

Json Context::proof(std::FILE* out) const { return gpuProof(out, gpu_, validation()); }

bool Context::hasRealGpu() const {
  if (device_) return !device_->isCpu();
  return palpate::hasRealGpu({.gpu = gpu_});
}

Device& Context::sightDevice(const std::string& gpu) {
  if (!sightDevice_)
    sightDevice_ = std::make_unique<Device>(
        DeviceOptions{.gpu = gpu, .validation = validation(), .shows = shows_, .windowExtensions = windowExtensions_});
  return *sightDevice_;
}

void Context::arrange(QueueArrangement queues) {
  if (queues != queues_) close(device_);
  queues_ = queues;
}

void Context::writeJson(const Json& result) const {
  if (json_.empty()) return;
  hasResult_ = true;
  const std::string text = withShownNames(result.dump(2) + "\n");
  if (json_ == "-") {
    std::fwrite(text.data(), 1, text.size(), stdout);
    return;
  }
  AtomicFile file(json_);
  file.write(text);
  file.commit();
}

void Context::writeFailure(std::string_view what, int code, const std::vector<std::string>& words) noexcept {
  try {
    constexpr std::string_view kJson = "--json";
    for (auto word = words.begin(); json_.empty() && word != words.end(); ++word) {
      if (word->starts_with(kJson) && word->substr(kJson.size()).starts_with('='))
        json_ = word->substr(kJson.size() + 1);
      if (*word == kJson && word + 1 != words.end()) json_ = *(word + 1);
    }
    std::error_code ignored;
    if (!isJsonChecked_ && json_ != "-" && std::filesystem::exists(json_, ignored)) return;
    if (!hasResult_) writeJson({{"error", what}, {"exit_code", code}});
  } catch (const std::exception&) {  // the failure itself may be that the file cannot be written
  }
}

void Context::reserveStdout() {
  if (json_ == "-") throw UsageError("--json: stdout is the cloud named -; name a file");
  isStdoutReserved_ = true;
}

void Context::checkJson() {
  if (json_ != "-") checkOutput(json_, Output::only);
  isJsonChecked_ = true;
}

void Context::close(std::unique_ptr<Device>& device) {
  if (!device) return;
  device->waitIdle();
  messages_ += device->instance().messages().count();
  device.reset();
}

std::size_t Context::closeDevices() {
  close(sightDevice_);
  close(device_);
  return messages_;
}

void checkStdout() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout)) throw Error("stdout: what was printed could not be written");
}

DVec3 parseVec3(const std::string& text, const std::string& option) {
  DVec3 value(0);
  const char* at = text.data();
  const char* end = at + text.size();
  for (int k = 0; k < 3; ++k) {
    const auto [next, error] = std::from_chars(at, end, value[k]);
    const bool separated = k == 2 ? next == end : next != end && *next == ',';
    if (error != std::errc() || !separated || !std::isfinite(value[k]))
      throw UsageError("{}: '{}' is not three numbers x,y,z", option, text);
    at = next + 1;
  }
  return value;
}

}  // namespace palpate
