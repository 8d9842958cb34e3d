// What goes over the loopback while this lives, as whoever sits on the wire reads it.
#pragma once

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <thread>

namespace palpate {

class WireCapture {
 public:
  WireCapture() : socket_(::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, htons(ETH_P_ALL))) {
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

  /// False where this user may not listen.
  bool isListening() const { return socket_ >= 0; }
  /// Ends it; all that has come, one after the other.
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
      if (size > 0) heard_.append(frame.data(), static_cast<std::size_t>(size));
    }
  }

  int socket_;
  std::string heard_;
  std::jthread thread_;  // goes first
};

}  // namespace palpate
