#include "haptics/devices/hid_node.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace palpate {

HidNode::HidNode(const std::string& path) noexcept : file_(::open(path.c_str(), O_WRONLY | O_CLOEXEC)) {}

HidNode::~HidNode() {
  if (file_ >= 0) ::close(static_cast<int>(file_));
}

void HidNode::write(std::span<const std::uint8_t> report) noexcept {
  const int before = errno;
  [[maybe_unused]] const auto written = file_ >= 0 ? ::write(static_cast<int>(file_), report.data(), report.size()) : 0;
  errno = before;
}

bool HidNode::isDenied(const std::string& path) noexcept {
  return ::faccessat(AT_FDCWD, path.c_str(), R_OK | W_OK, AT_EACCESS) != 0 && errno == EACCES;
}

// If its group may open the node, the rule was applied: then the user has no seat on this machine.
std::string hidPermissionMend(const std::string& path, bool inRule) {
  if (!inRule) return fmt::format("run: sudo chown $USER {} (until it is plugged in again)", path);
  struct stat node {};
  const bool hasGroup = ::stat(path.c_str(), &node) == 0 && node.st_gid != 0 && (node.st_mode & 0060) == 0060;
  const group* owners = hasGroup ? ::getgrgid(node.st_gid) : nullptr;
  if (!owners) return "run: third_party/install.sh --udev";
  return fmt::format("run: sudo usermod -aG {} $USER, then log in again", owners->gr_name);
}

}  // namespace palpate
