#include "engine/core/atomic_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

std::string becauseOf(int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return fmt::format("cannot be written: {}{}", std::strerror(error), full ? "; free some space" : "");
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  if (target_.empty()) throw Error("an output file has an empty name; give it one");
  std::error_code ignored;
  const auto status = std::filesystem::status(target_, ignored);
  if (std::filesystem::is_directory(status)) throw FileError(target_, "is a folder; name a file in it");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    file_ = std::fopen(target_.c_str(), "wb");
  } else {
    if (std::filesystem::exists(status)) target_ = std::filesystem::canonical(target_);
    temporary_ = target_;
    temporary_ += fmt::format(".{}.tmp", ::getpid());
    file_ = std::fopen(temporary_.c_str(), "wb");
    if (file_ && std::filesystem::exists(status))
      std::filesystem::permissions(temporary_, status.permissions(), ignored);
  }
  if (!file_) throw FileError(target_, becauseOf(errno));
}

AtomicFile::~AtomicFile() {
  if (!file_) return;
  std::fclose(file_);
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) throw FileError(target_, becauseOf(errno));
}

void AtomicFile::commit() {
  bool written = std::fflush(file_) == 0 && (temporary_.empty() || ::fsync(::fileno(file_)) == 0);
  int error = errno;
  if (std::fclose(file_) != 0 && written) {
    written = false;
    error = errno;
  }
  file_ = nullptr;
  std::error_code renameError;
  if (written && !temporary_.empty()) std::filesystem::rename(temporary_, target_, renameError);
  if (written && !renameError) return;
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
  throw FileError(target_, becauseOf(renameError ? renameError.value() : error));
}

}  // namespace palpate
