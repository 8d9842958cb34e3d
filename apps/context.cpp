#include "apps/context.hpp"

#include <charconv>
#include <iostream>

#include "engine/core/atomic_file.hpp"

namespace palpate {

void Context::addOptions(CLI::App& app) {
  app.add_option("--gpu", gpu_, "GPU by number or part of its name (else PALPATE_GPU, else the best there is)");
  app.add_flag("--validate", validate_,
               "watch every GPU call (core, synchronisation and GPU-assisted validation); any message ends in exit code 1");
  app.add_option("--json", json_, "write a machine-readable result to this file, or to stdout with -")
      ->type_name("FILE|-");
  app.add_option("--threads", threads_, "CPU threads for loading and making clouds (0: one per core)");
  app.add_flag("--quiet", quiet_, "no remarks and no progress on stderr");
}

Log& Context::log() {
  if (!log_) log_ = std::make_unique<Log>(quiet_);
  return *log_;
}

Device& Context::device() {
  if (!device_) device_ = std::make_unique<Device>(DeviceOptions{.gpu = gpu_, .validate = validate_});
  return *device_;
}

void Context::writeJson(const Json& result) const {
  if (json_.empty()) return;
  const std::string text = result.dump(2) + "\n";
  if (json_ == "-") {
    std::cout << text << std::flush;
    return;
  }
  AtomicFile file(json_);
  file.write(text);
  file.commit();
}

std::size_t Context::closeDevice() {
  if (!device_) return 0;
  device_->waitIdle();
  const std::size_t messages = device_->instance().messages().count();
  device_.reset();
  return messages;
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
