#include "engine/core/atomic_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/system_file.hpp"

namespace palpate {

namespace {

using Name = std::filesystem::path::value_type;
// Names of the temporary files in use, at most 16; a signal leaves any further ones behind.
std::array<std::atomic<const Name*>, 16> temporaries{};
static_assert(std::atomic<const Name*>::is_always_lock_free);

void exchangeOnce(const Name* from, const Name* to) {
  for (std::atomic<const Name*>& temporary : temporaries)
    if (const Name* expected = from; temporary.compare_exchange_strong(expected, to)) return;
}

// A name of the greatest length leaves no room for an ending.
std::filesystem::path temporaryFor(const std::filesystem::path& target) {
  constexpr std::size_t kLongest = 255;
  const std::string ending = fmt::format(".{}.tmp", processNumber());
  std::filesystem::path::string_type name = target.filename().native();
  if (name.size() + ending.size() > kLongest) name.resize(kLongest - ending.size());
  std::filesystem::path temporary = target;
  temporary.replace_filename(name);
  temporary += ending;
  return temporary;
}

}  // namespace

TemporaryFile::TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {
  exchangeOnce(nullptr, path_.c_str());
}

TemporaryFile::~TemporaryFile() {
  removeNow(path_.c_str());
  exchangeOnce(path_.c_str(), nullptr);
}

void removeTemporaryFiles() noexcept {
  for (const std::atomic<const Name*>& temporary : temporaries)
    if (const Name* const name = temporary) removeNow(name);
}

bool isDeviceOrPipe(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  if (target_.empty()) throw Error("an output file has an empty name; give it one");
  std::error_code ignored;
  const auto status = std::filesystem::status(target_, ignored);
  if (std::filesystem::is_directory(status)) throw FileError(target_, "is a folder; name a file in it");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    file_ = openFile(target_, "wb");
  } else {
    if (std::filesystem::exists(status)) target_ = std::filesystem::canonical(target_);
    temporary_ = temporaryFor(target_);
    exchangeOnce(nullptr, temporary_.c_str());
    file_ = openFile(temporary_, "wb");
    if (!file_) forgetTemporary();
    if (file_ && std::filesystem::exists(status))
      std::filesystem::permissions(temporary_, status.permissions(), ignored);
  }
  if (!file_) throw FileError(target_, whyNotWritten(errno));
}

AtomicFile::~AtomicFile() {
  if (!file_) return;
  std::fclose(file_);
  removeTemporary();
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;  // std::fwrite requires a valid pointer even for no bytes
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) throw FileError(target_, whyNotWritten(errno));
}

void AtomicFile::flush() {
  if (std::fflush(file_) != 0) throw FileError(target_, whyNotWritten(errno));
}

void AtomicFile::commit() {
  close();
  rename();
}

std::filesystem::path AtomicFile::commitAndKeep() {
  close();
  const std::filesystem::path kept = keep();
  rename();
  return kept;
}

void AtomicFile::close() {
  bool written = std::fflush(file_) == 0 && (temporary_.empty() || bringToDisk(file_));
  int error = errno;
  if (std::fclose(std::exchange(file_, nullptr)) != 0 && written) {
    written = false;
    error = errno;
  }
  if (written) return;
  removeTemporary();
  throw FileError(target_, whyNotWritten(error));
}

void AtomicFile::rename() {
  if (temporary_.empty()) return;
  const std::error_code error = replaceFile(temporary_, target_);
  if (!error) return forgetTemporary();
  removeTemporary();
  throw FileError(target_, whyNotWritten(error.value()));
}

std::filesystem::path AtomicFile::nameToKeep(const std::filesystem::path& target) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(target, ignored)) return {};
  const std::filesystem::path real = std::filesystem::canonical(target, ignored);
  for (int number = 1;; ++number) {
    std::filesystem::path name = real;
    name += number == 1 ? ".bak" : fmt::format(".bak{}", number);
    if (!std::filesystem::exists(std::filesystem::symlink_status(name, ignored))) return name;
  }
}

// The older file gets a second name (a hard link), so that a file of the first name exists at any moment. Copies the
// file where the system does not support hard links.
std::filesystem::path AtomicFile::keep() const {
  for (;;) {
    const std::filesystem::path name = nameToKeep(target_);
    if (name.empty()) return name;
    std::error_code error;
    std::filesystem::create_hard_link(target_, name, error);
    if (!error) return name;
    if (error == std::errc::file_exists) continue;  // created since nameToKeep()
    std::filesystem::copy_file(target_, name, error);
    if (!error) return name;
    if (error == std::errc::file_exists) continue;
    std::error_code ignored;
    std::filesystem::remove(name, ignored);
    removeTemporary();
    throw FileError(target_,
                    fmt::format("cannot be kept as {}: {}; save under another name", name.string(), error.message()));
  }
}

void AtomicFile::removeTemporary() const {
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
  forgetTemporary();
}

void AtomicFile::forgetTemporary() const { exchangeOnce(temporary_.c_str(), nullptr); }

}  // namespace palpate
