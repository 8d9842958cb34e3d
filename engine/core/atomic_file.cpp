#include "engine/core/atomic_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "engine/core/error.hpp"

namespace palpate {

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  temporary_ = target_;
  temporary_ += fmt::format(".{}.tmp", ::getpid());
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (!file_) throw FileError(target_, fmt::format("cannot be written: {}", std::strerror(errno)));
}

AtomicFile::~AtomicFile() {
  if (file_) {
    std::fclose(file_);
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
  }
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size())
    throw FileError(target_, fmt::format("cannot be written: {}; is the disk full?", std::strerror(errno)));
}

void AtomicFile::commit() {
  const bool written = std::fflush(file_) == 0 && ::fsync(::fileno(file_)) == 0;
  const int error = errno;
  std::fclose(file_);
  file_ = nullptr;
  std::error_code renameError;
  if (written) std::filesystem::rename(temporary_, target_, renameError);
  if (!written || renameError) {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
    throw FileError(target_, fmt::format("cannot be written: {}; is the disk full?",
                                         written ? renameError.message() : std::strerror(error)));
  }
}

}  // namespace palpate
