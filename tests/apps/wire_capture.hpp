// Captures the loopback traffic of one DDS domain during its lifetime.
#pragma once

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <thread>

namespace palpate {

class WireCapture {
 public:
  explicit WireCapture(unsigned domain)
      : firstPort_(7400 + 250 * domain), socket_(::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, htons(ETH_P_ALL))) {
    if (socket_ < 0) return;
    const int room = 64 << 20;
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &room, sizeof room);
    const timeval look{.tv_sec = 0, .tv_usec = 50'000};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &look, sizeof look);
    thread_ = std::jthread([this](const std::stop_token& stop) { listen(stop); });
  }
  ~WireCapture() {
    end();
    if (socket_ >= 0) ::close(socket_);
  }
  WireCapture(const WireCapture&) = delete;
  WireCapture& operator=(const WireCapture&) = delete;

  /// False if this user may not listen.
  bool isListening() const { return socket_ >= 0; }
  /// Ends the capture; returns all bytes in order.
  const std::string& end() {
    if (thread_.joinable()) {
      thread_.request_stop();
      thread_.join();
    }
    return heard_;
  }

 private:
  void listen(const std::stop_token& stop) {
    std::array<char, 1 << 16> frame;
    while (!stop.stop_requested()) {
      const ssize_t size = ::recv(socket_, frame.data(), frame.size(), 0);
      if (size > 0 && isOurs(frame, static_cast<std::size_t>(size)))
        heard_.append(frame.data(), static_cast<std::size_t>(size));
    }
  }
  // UDP of IPv4, to a port of the domain. Other tests use other domains meanwhile.
  bool isOurs(const std::array<char, 1 << 16>& frame, std::size_t size) const {
    const auto at = [&](std::size_t i) { return static_cast<unsigned char>(frame[i]); };
    constexpr std::size_t kIp = 14;
    if (size < kIp + 28 || at(12) != 0x08 || at(13) != 0 || at(kIp + 9) != IPPROTO_UDP) return false;
    const std::size_t udp = kIp + (at(kIp) & 0x0fU) * 4;
    if (size < udp + 8) return false;
    const unsigned port = at(udp + 2) * 256U + at(udp + 3);
    return port >= firstPort_ && port < firstPort_ + 250;
  }

  unsigned firstPort_;
  int socket_;
  std::string heard_;
  std::jthread thread_;  // destroyed first
};

}  // namespace palpate
