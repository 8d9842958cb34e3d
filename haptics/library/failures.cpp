#include "haptics/library/failures.hpp"

#include <algorithm>
#include <array>
#include <new>
#include <string_view>

#include "engine/core/job_stop.hpp"
#include "haptics/servo_mailbox.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate::library {

namespace {

/// A text that stays where it is, so that a pointer to it never leads to freed memory.
template <std::size_t kSize>
class FixedText {
 public:
  /// Cuts the text off between two characters of UTF-8 if it does not fit.
  void set(std::string_view text) noexcept {
    std::size_t size = std::min(text.size(), kSize - 1);
    if (size < text.size())
      while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xc0) == 0x80) --size;
    text.copy(bytes_.data(), size);
    bytes_[size] = '\0';
  }
  const char* c_str() const noexcept { return bytes_.data(); }

 private:
  std::array<char, kSize> bytes_{};
};

struct Failure {
  pp_status status = PP_OK;
  FixedText<8192> text;
  FixedText<4352> file;  // the longest path, and more
  std::uint64_t line = 0;
};

thread_local Failure last;

pp_status note(pp_status status, const char* text, const FileError* about = nullptr) {
  last.status = status;
  last.text.set(text);
  last.file.set(about ? about->file().string() : std::string());
  last.line = about ? about->line() : 0;
  return status;
}

// Stores the exception being handled; throws std::bad_alloc if its file cannot be named.
pp_status noteHandled() {
  try {
    throw;
  } catch (const HandleError& error) {
    return note(PP_ERROR_HANDLE, error.what());
  } catch (const ThreadError& error) {
    return note(PP_ERROR_THREAD, error.what());
  } catch (const StateError& error) {
    return note(PP_ERROR_STATE, error.what());
  } catch (const DeviceError& error) {
    return note(PP_ERROR_DEVICE, error.what());
  } catch (const SimulationError& error) {
    return note(PP_ERROR_SIMULATION, error.what());
  } catch (const CommandTimeout& error) {
    return note(PP_ERROR_TIMEOUT, error.what());
  } catch (const Stopped& error) {
    return note(PP_ERROR_STOPPED, error.what());
  } catch (const UnsupportedError& error) {
    return note(PP_ERROR_UNSUPPORTED, error.what());
  } catch (const NotBuilt& error) {
    return note(PP_ERROR_UNSUPPORTED, error.what());
  } catch (const BugFound& error) {
    return note(PP_ERROR_BUG, error.what());
  } catch (const UsageError& error) {
    return note(PP_ERROR_ARGUMENT, error.what());
  } catch (const FileError& error) {
    return note(PP_ERROR_FILE, error.what(), &error);
  } catch (const NetworkError& error) {
    return note(canShare() ? PP_ERROR_NETWORK : PP_ERROR_UNSUPPORTED, error.what());
  } catch (const GpuError& error) {
    return note(PP_ERROR_GPU, error.what());
  } catch (const std::exception& error) {
    return note(PP_ERROR_FAILED, error.what());
  } catch (...) {
    return note(PP_ERROR_FAILED, "an exception of an unknown type was thrown");
  }
}

}  // namespace

pp_status noteFailure() noexcept {
  try {
    try {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (...) {
      return noteHandled();
    }
  } catch (...) {
    last.file.set({});
    last.line = 0;
    last.text.set("out of memory");
    return last.status = PP_ERROR_MEMORY;
  }
}

}  // namespace palpate::library

using palpate::library::last;

pp_status pp_last_status(void) { return last.status; }
const char* pp_last_error(void) { return last.text.c_str(); }
const char* pp_last_error_file(void) { return last.file.c_str(); }
uint64_t pp_last_error_line(void) { return last.line; }
const char* pp_version(void) { return PALPATE_VERSION; }

const char* pp_status_name(int status) {
  switch (status) {
    case PP_OK:
      return "ok";
    case PP_ERROR_ARGUMENT:
      return "argument";
    case PP_ERROR_HANDLE:
      return "handle";
    case PP_ERROR_THREAD:
      return "thread";
    case PP_ERROR_STATE:
      return "state";
    case PP_ERROR_FILE:
      return "file";
    case PP_ERROR_GPU:
      return "gpu";
    case PP_ERROR_MEMORY:
      return "memory";
    case PP_ERROR_DEVICE:
      return "device";
    case PP_ERROR_UNSUPPORTED:
      return "unsupported";
    case PP_ERROR_FAILED:
      return "failed";
    case PP_ERROR_BUG:
      return "bug";
    case PP_ERROR_SIMULATION:
      return "simulation";
    case PP_ERROR_NETWORK:
      return "network";
    case PP_ERROR_STOPPED:
      return "stopped";
    case PP_ERROR_TIMEOUT:
      return "timeout";
  }
  return "unknown";
}
