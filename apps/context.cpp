#include "apps/context.hpp"

#include <charconv>

#include "engine/core/atomic_file.hpp"
#include "engine/gpu/device_lookup.hpp"

namespace palpate {

void Context::addOptions(CLI::App& app) {
  app.add_option("--gpu", gpu_, "GPU by number or part of its name (else PALPATE_GPU, else the best there is)");
  app.add_flag(
      "--validate", validate_,
      "watch every GPU call (core, synchronisation and GPU-assisted validation); any message ends in exit code 1");
  app.add_option("--json", json_, "write a machine-readable result to this file, or to stdout with -")
      ->type_name("FILE|-")
      ->check([](const std::string& text) { return text.empty() ? std::string("needs a file name or -") : ""; });
  app.add_option("--threads", threads_,
                 "CPU threads for loading and making clouds, and for --backend cpu (0: one per core)")
      ->check(wholeBetween(0, bounds::kMostThreads));
  app.add_flag("--quiet", quiet_, "no remarks and no progress; results are still printed");
}

Log& Context::log() {
  if (!log_) log_ = std::make_unique<Log>(quiet_);
  return *log_;
}

Device& Context::device() {
  if (!device_)
    device_ = std::make_unique<Device>(
        DeviceOptions{.gpu = gpu_,
                      .validate = validate_,
                      .queues = queues_,
                      .shows = shows_,
                      .windowExtensions = windowExtensions_});
  return *device_;
}

bool Context::hasRealGpu() const {
  if (device_) return !device_->isCpu();
  try {
    return gpuFor({.gpu = gpu_}).type != VK_PHYSICAL_DEVICE_TYPE_CPU;
  } catch (const GpuError&) {
    if (!gpu_.empty()) throw;
    return false;
  }
}

Device& Context::sightDevice(const std::string& gpu) {
  if (!sightDevice_)
    sightDevice_ = std::make_unique<Device>(
        DeviceOptions{.gpu = gpu, .validate = validate_, .shows = shows_, .windowExtensions = windowExtensions_});
  return *sightDevice_;
}

void Context::arrange(QueueArrangement queues) {
  if (queues != queues_) close(device_);
  queues_ = queues;
}

void Context::writeJson(const Json& result) const {
  if (json_.empty()) return;
  const std::string text = result.dump(2) + "\n";
  if (json_ == "-") {
    std::fwrite(text.data(), 1, text.size(), stdout);
    return;
  }
  AtomicFile file(json_);
  file.write(text);
  file.commit();
}

void Context::checkWritable(const std::string& file) {
  if (!file.empty()) AtomicFile probe(file);
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

namespace {

// The number that all of the text is; nothing where it is none, or none that can be counted with.
std::optional<double> finiteNumber(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || last != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

CLI::Validator check(std::string wanted, std::function<bool(const std::string&)> fits) {
  return CLI::Validator(
      [wanted = std::move(wanted), fits = std::move(fits)](std::string& text) {
        return fits(text) ? std::string() : fmt::format("{} is not {}", text, wanted);
      },
      std::string(), "number");
}

bool isBetween(const std::string& text, double least, double most) {
  const auto value = finiteNumber(text);
  return value && *value >= least && *value <= most;
}

}  // namespace

CLI::Validator between(double least, double most) {
  return check(fmt::format("a number from {} to {}", least, most),
               [least, most](const std::string& text) { return isBetween(text, least, most); });
}

CLI::Validator wholeBetween(double least, double most) {
  return check(fmt::format("a whole number from {:.0f} to {:.0f}", least, most),
               [least, most](const std::string& text) {
                 return isBetween(text, least, most) && text.find_first_not_of("+-0123456789") == text.npos;
               });
}

CLI::Validator lengthOrAuto() {
  return check(fmt::format("auto or a length from {} to {} mm", bounds::kShortest_mm, bounds::kLongest_mm),
               [](const std::string& text) {
                 return text == "auto" || isBetween(text, bounds::kShortest_mm, bounds::kLongest_mm);
               });
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
