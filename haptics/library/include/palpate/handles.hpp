/// @file
/// Errors and lifetimes of the C interface in C++17, which palpate.hpp includes.
#ifndef PALPATE_HANDLES_HPP
#define PALPATE_HANDLES_HPP

#include <palpate/palpate.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

namespace pp {

/// A failed call: its status, a description, and the file and line that it is about.
class Error : public std::runtime_error {
 public:
  /// The text is what what() returns; null is not allowed.
  Error(pp_status status, const char* text, const char* file, std::uint64_t line)
      : std::runtime_error(text), status_(status), file_(file), line_(line) {}

  pp_status status() const { return status_; }       ///< kind of the failure; never PP_OK
  const std::string& file() const { return file_; }  ///< empty if it is about no file
  std::uint64_t line() const { return line_; }       ///< from 1; 0 if unknown

 private:
  pp_status status_;
  std::string file_;
  std::uint64_t line_;
};

/// Throws Error with the last failure of this thread, unless `status` is PP_OK.
inline void check(pp_status status) {
  if (status != PP_OK) throw Error(status, pp_last_error(), pp_last_error_file(), pp_last_error_line());
}

/// Version of the library at run time, such as "0.1.0".
inline std::string version() { return pp_version(); }

/// Contiguous rows of three numbers, one for each point. The numbers are not copied.
inline pp_rows rows(const float* data) { return {data, PP_FLOAT32, 0, 0}; }
/// The same for double.
inline pp_rows rows(const double* data) { return {data, PP_FLOAT64, 0, 0}; }
/// The same for colours of 0 to 255.
inline pp_rows rows(const std::uint8_t* data) { return {data, PP_UINT8, 0, 0}; }
/// The same for colours of 0 to 65535.
inline pp_rows rows(const std::uint16_t* data) { return {data, PP_UINT16, 0, 0}; }

/// A path of `count` positions x y z, model units: one for each tick. The numbers are not copied.
inline pp_path path(const double* positions, std::uint64_t count) {
  pp_path path = pp_default_path();
  path.data = positions;
  path.rows = count;
  return path;
}
/// A path of `count` rows t x y z, seconds first.
inline pp_path timedPath(const double* rows, std::uint64_t count) {
  pp_path timed = path(rows, count);
  timed.columns = 4;
  return timed;
}

/// What the classes below have in common.
namespace detail {

/// What a call of the C interface writes to its last argument.
template <class Written, class... Parameters, class... Given>
Written written(pp_status (*call)(Parameters...), Given... given) {
  Written value{};
  check(call(given..., &value));
  return value;
}

/// A handle that is closed on destruction. Move-only.
template <class Handle, pp_status (*kClose)(Handle)>
class Owned {
 public:
  Owned() = default;  ///< closed
  /// Owns a handle of the C interface.
  explicit Owned(Handle handle) : handle_(handle) {}
  /// Leaves the other one closed.
  Owned(Owned&& other) noexcept : handle_(std::exchange(other.handle_, Handle{})) {}
  /// Exchanges the handles.
  Owned& operator=(Owned&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Owned() { close(); }  ///< Closes the handle.
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;

  /// For calls of the C interface.
  Handle handle() const { return handle_; }
  /// False after close(), and of an object that was moved from.
  bool isOpen() const { return handle_.id != 0; }
  /// Closes the handle early; has no effect if it is already closed.
  void close() {
    if (isOpen()) kClose(std::exchange(handle_, Handle{}));
  }

 private:
  Handle handle_{};
};

}  // namespace detail

}  // namespace pp

#endif  // PALPATE_HANDLES_HPP
