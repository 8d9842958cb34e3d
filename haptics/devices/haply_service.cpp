#include "haptics/devices/haply_service.hpp"

#include <algorithm>
#include <chrono>
#include <utility>  // Boost 1.74 uses std::exchange without it

#include "engine/core/error.hpp"
#include "haptics/devices/system_devices.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket.hpp>

namespace palpate {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using Failure = boost::system::error_code;

constexpr double kHandshake_s = 2, kGoodbye_s = 0.05;
constexpr std::size_t kLongestMessage = 1 << 20;

/// Runs handlers until `done`, but not longer than `timeout_s`. Returns done().
template <typename Done>
bool runUntil(asio::io_context& io, double timeout_s, const Done& done) {
  using Clock = std::chrono::steady_clock;
  const auto until =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_s));
  while (!done()) {
    io.restart();
    if (timeout_s <= 0) {
      if (io.poll_one() == 0) break;
    } else if (io.run_one_until(until) == 0 && Clock::now() >= until) {
      break;
    }
  }
  return done();
}

/// The Nagle algorithm would hold a force back until the state before it is acknowledged.
void connect(asio::io_context& io, tcp::socket& socket, std::uint16_t port, double timeout_s, Failure& failure) {
  bool done = false;
  socket.async_connect({asio::ip::address_v4::loopback(), port}, [&](const Failure& problem) {
    done = true;
    failure = problem;
  });
  if (!runUntil(io, timeout_s, [&done] { return done; })) {
    Failure ignored;
    socket.close(ignored);  // its handler runs before the variables that it refers to are gone
    runUntil(io, timeout_s, [&done] { return done; });
    failure = asio::error::timed_out;
  }
  if (!failure) socket.set_option(tcp::no_delay(true), failure);
}

constexpr double kFirst_s = 2, kAsk_s = 0.5;

std::string listOf(const std::vector<haply::Inverse>& inverses) {
  std::string list;
  for (const haply::Inverse& inverse : inverses)
    list += fmt::format("{}haply:{} ({} hand{})", list.empty() ? "" : ", ", inverse.id, inverse.handedness,
                        inverse.inUse ? ", in use" : "");
  return list;
}

HaplyLink connected(const haply::Ports& ports) try { return HaplyLink(ports.simulation); } catch (const Error& error) {
  throw Error("haply: the Haply service does not answer ({}); install it from Haply, and start it: {}", error.what(),
              haplyStart());
}

}  // namespace

struct HaplyLink::System {
  asio::io_context io{1};
  beast::websocket::stream<tcp::socket> socket{io};
  beast::flat_buffer heard;
  std::string said;
  bool listens = false, arrived = false, speaks = false, closed = false;

  bool isOver(const Failure& failure) {
    closed = closed || failure.failed();
    return closed;
  }
};

HaplyLink::HaplyLink(std::uint16_t port) : system_(std::make_unique<System>()) {
  System& s = *system_;
  Failure failure;
  connect(s.io, s.socket.next_layer(), port, kHandshake_s, failure);
  if (failure) throw Error("127.0.0.1:{}: {}", port, failure.message());
  s.socket.read_message_max(kLongestMessage);
  s.speaks = true;
  s.socket.async_handshake("localhost", "/", [&s](const Failure& problem) {
    s.speaks = false;
    s.isOver(problem);
  });
  runUntil(s.io, kHandshake_s, [&s] { return !s.speaks; });
  if (s.speaks || s.closed) throw Error("127.0.0.1:{}: the service there is not a WebSocket", port);
}

HaplyLink::~HaplyLink() {
  System& s = *system_;
  if (!s.closed && !s.speaks) {
    bool left = false;
    s.socket.async_close(beast::websocket::close_code::normal, [&left](const Failure&) { left = true; });
    runUntil(s.io, kGoodbye_s, [&left] { return left; });
  }
  Failure ignored;
  s.socket.next_layer().close(ignored);
}

HaplyLink::Heard HaplyLink::hear(double timeout_s, std::string& message) {
  System& s = *system_;
  if (!s.listens && !s.arrived && !s.closed) {
    s.listens = true;
    s.socket.async_read(s.heard, [&s](const Failure& failure, std::size_t) {
      s.listens = false;
      s.arrived = !s.isOver(failure);
    });
  }
  runUntil(s.io, timeout_s, [&s] { return s.arrived || s.closed; });
  if (!s.arrived) return s.closed ? Heard::closed : Heard::nothing;
  s.arrived = false;
  message.assign(static_cast<const char*>(s.heard.data().data()), s.heard.size());
  s.heard.consume(s.heard.size());
  return Heard::message;
}

bool HaplyLink::say(std::string message, double timeout_s) {
  System& s = *system_;
  if (s.closed || s.speaks) return false;
  s.said = std::move(message);
  s.speaks = true;
  s.socket.async_write(asio::buffer(s.said), [&s](const Failure& failure, std::size_t) {
    s.speaks = false;
    s.isOver(failure);
  });
  runUntil(s.io, timeout_s, [&s] { return !s.speaks; });
  s.closed = s.closed || s.speaks;
  return !s.closed;
}

std::optional<std::string> askHaplyService(std::uint16_t port, const std::string& path, double timeout_s) {
  asio::io_context io{1};
  tcp::socket socket(io);
  Failure failure;
  connect(io, socket, port, timeout_s, failure);
  if (failure) return std::nullopt;
  beast::http::request<beast::http::empty_body> request(beast::http::verb::get, path, 11);
  request.set(beast::http::field::host, "localhost");
  request.set(beast::http::field::connection, "close");
  beast::http::response<beast::http::string_body> answer;
  beast::flat_buffer buffer;
  bool done = false, good = false;
  beast::http::async_write(socket, request, [&](const Failure& unsent, std::size_t) {
    if (unsent) {
      done = true;
      return;
    }
    beast::http::async_read(socket, buffer, answer, [&](const Failure& unread, std::size_t) {
      done = true;
      good = !unread && answer.result() == beast::http::status::ok;
    });
  });
  runUntil(io, timeout_s, [&done] { return done; });
  return good ? std::optional(answer.body()) : std::nullopt;
}

HaplyService::HaplyService() : ports(haply::servicePorts()), link(connected(ports)) {
  const HaplyLink::Heard heard = link.hear(kFirst_s, first);
  if (heard == HaplyLink::Heard::closed)
    throw Error("haply: the Haply service closes the connection before it lists its devices; start it again");
  if (heard == HaplyLink::Heard::nothing)
    throw Error("haply: the Haply service accepts connections but lists no devices; start it again");
  auto found = haply::inventoryIn(first);
  if (!found) throw Error("haply: the Haply service's first message is not JSON; update the service");
  inventory = std::move(*found);
  for (const std::uint16_t port : ports.http)
    for (const char* path : {"/version", "/3.1/version", "/3.0/version"})
      if (version.empty())
        if (const auto answer = askHaplyService(port, path, kAsk_s)) version = haply::versionIn(*answer);
  try {
    events = std::make_unique<HaplyLink>(ports.events);
  } catch (const Error&) {
    events.reset();
  }
}

const haply::Inverse& HaplyService::device(const std::string& serial, bool shares) const {
  const std::vector<haply::Inverse>& all = inventory.inverses;
  if (all.empty())
    throw Error("haply: the Haply service has no Inverse3; check its cable and power supply, and the Haply Hub");
  if (serial.empty() && all.size() > 1)
    throw Error("haply: there are {} devices; choose one by its serial number: {}", all.size(), listOf(all));
  const auto chosen = serial.empty() ? all.begin() : std::ranges::find(all, serial, &haply::Inverse::id);
  if (chosen == all.end()) throw Error("haply: no device '{}' is connected; devices are {}", serial, listOf(all));
  if (chosen->inUse && !shares)
    throw Error(
        "haply: another program uses {}, and the forces of both would add up; close it, or use it nevertheless: "
        "haply:{}:shared",
        chosen->id, chosen->id);
  return *chosen;
}

const haply::Grip* HaplyService::gripOf(const haply::Inverse& inverse) const {
  const auto place = &inverse - inventory.inverses.data();
  const haply::Grip* grip = nullptr;
  std::ptrdiff_t count = 0;
  for (const haply::Grip& one : inventory.grips)
    if (one.connected && count++ <= place) grip = &one;
  return grip;
}

}  // namespace palpate
