#include "apps/context.hpp"

#include <charconv>

#include "engine/core/atomic_file.hpp"

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
                 "CPU threads for loading and making clouds, and for --backend cpu (0: one per core)");
  app.add_flag("--quiet", quiet_, "no remarks and no progress; results are still printed");
}

Log& Context::log() {
  if (!log_) log_ = std::make_unique<Log>(quiet_);
  return *log_;
}

Device& Context::device() {
  if (!device_)
    device_ = std::make_unique<Device>(
        DeviceOptions{.gpu = gpu_, .validate = validate_, .queues = queues_, .shows = shows_, .windowExtensions = windowExtensions_});
  return *device_;
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

CLI::Validator numberCheck(std::string wanted, std::function<bool(double)> fits) {
  return CLI::Validator(
      [wanted, fits = std::move(fits)](std::string& text) {
        double value = 0;
        const char* end = text.data() + text.size();
        const auto [last, error] = std::from_chars(text.data(), end, value);
        const bool number = error == std::errc() && last == end && std::isfinite(value);
        return number && fits(value) ? std::string() : fmt::format("{} is not {}", text, wanted);
      },
      std::string(), "number");
}

}  // namespace

CLI::Validator positive() {
  return numberCheck("a number above 0", [](double value) { return value > 0; });
}

CLI::Validator notNegative() {
  return numberCheck("0 or a number above it", [](double value) { return value >= 0; });
}

CLI::Validator between(double least, double most) {
  return numberCheck(fmt::format("a number from {} to {}", least, most),
                     [least, most](double value) { return value >= least && value <= most; });
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
