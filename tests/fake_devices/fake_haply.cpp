#include "tests/fake_devices/fake_haply.hpp"

#include <utility>  // Boost 1.74 uses std::exchange without it

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"

namespace palpate {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using Failure = boost::system::error_code;
using Json = nlohmann::json;

/// Haply's axes in the order of the program's, each with its sign: the letters of a basis, and the signs before them.
std::vector<std::pair<int, double>> axesIn(const std::string& permutation) {
  std::vector<std::pair<int, double>> axes;
  double sign = 1;
  for (const char letter : permutation) {
    if (letter >= 'X') axes.emplace_back(letter - 'X', sign);
    sign = letter == '-' ? -1 : 1;
  }
  return axes;
}

/// In the program's axes.
Json permuted(const std::string& permutation, const DVec3& palpate) {
  const DVec3 haply(palpate.x, -palpate.z, palpate.y);
  Json out;
  const char* name = "xyz";
  for (const auto& [axis, sign] : axesIn(permutation)) out[std::string(1, *name++)] = sign * haply[axis];
  return out;
}

DVec3 unpermuted(const std::string& permutation, const Json& vector) {
  DVec3 haply(0);
  const char* name = "xyz";
  for (const auto& [axis, sign] : axesIn(permutation))
    haply[axis] = sign * vector[std::string(1, *name++)].get<double>();
  return {haply.x, haply.z, -haply.y};
}

/// A message with forces, and at most the program's name, besides.
bool isForce(Json message) {
  const Json named{{"configure", {{"profile", {{"name", "palpate"}}}}}};
  if (message.contains("session") && message["session"] == named) message.erase("session");
  return message.size() == 1 && std::ranges::all_of(message.at("inverse3"), [](const Json& entry) {
           const Json& commands = entry.at("commands");
           return entry.size() == 2 && commands.size() == 1 && commands.at("set_cursor_force").size() == 1;
         });
}

}  // namespace

struct FakeHaply::Service {
  using Socket = beast::websocket::stream<tcp::socket>;
  /// A connection to either port.
  struct Client {
    explicit Client(tcp::socket socket, bool isEvents) : web(std::move(socket)), events(isEvents) {
      web.next_layer().set_option(tcp::no_delay(true));
    }
    Socket web;
    bool events, writes = false;
    beast::flat_buffer buffer;
    beast::http::request<beast::http::string_body> request;
    beast::http::response<beast::http::string_body> answer;
    std::deque<std::string> out;
  };
  using ClientPtr = std::shared_ptr<Client>;

  Service(FakeHaplyOptions given, std::filesystem::path notes)
      : options(std::move(given)),
        folder(std::move(notes)),
        simulation(io, {asio::ip::address_v4::loopback(), 0}),
        events(io, {asio::ip::address_v4::loopback(), 0}),
        hand(Path(options.hand), {}, options.arm) {
    accept(simulation, false);
    accept(events, true);
  }

  void accept(tcp::acceptor& door, bool isEvents) {
    door.async_accept([this, &door, isEvents](const Failure& failure, tcp::socket socket) {
      if (failure) return;
      const auto client = std::make_shared<Client>(std::move(socket), isEvents);
      beast::http::async_read(client->web.next_layer(), client->buffer, client->request,
                              [this, client](const Failure& unread, std::size_t) {
                                if (!unread) greet(client);
                              });
      accept(door, isEvents);
    });
  }

  void greet(const ClientPtr& client) {
    if (beast::websocket::is_upgrade(client->request)) {
      client->web.async_accept(client->request, [this, client](const Failure& failure) {
        if (failure) return;
        if (client->events) {
          listener = client;
        } else {
          if (options.hangsUp) {
            Failure ignored;
            client->web.next_layer().close(ignored);
            return;
          }
          ++connections;
          if (options.restarts) rest();
          say(client, state(true).dump());
          hear(client);
        }
      });
      return;
    }
    // Up to 3.4 the version has the number of the format before it.
    const bool old = options.version < "3.5";
    if (client->request.method() != beast::http::verb::get || !client->request.target().ends_with("/version")) {
      const std::scoped_lock lock(guard);
      others.emplace_back(client->request.target());
    }
    const bool known = client->request.target() == (old ? "/3.0/version" : "/version");
    client->answer.result(known ? beast::http::status::ok : beast::http::status::not_found);
    client->answer.body() = Json{{"build_time", "2025-01-07T16:00:00"}, {"version", options.version}}.dump();
    client->answer.prepare_payload();
    beast::http::async_write(client->web.next_layer(), client->answer, [client](const Failure&, std::size_t) {
      Failure ignored;
      client->web.next_layer().shutdown(tcp::socket::shutdown_both, ignored);
    });
  }

  void say(const ClientPtr& client, std::string text) {
    client->out.push_back(std::move(text));
    if (!client->writes) write(client);
  }
  void write(const ClientPtr& client) {
    if (client->out.empty()) return;
    client->writes = true;
    client->web.async_write(asio::buffer(client->out.front()), [this, client](const Failure& failure, std::size_t) {
      client->writes = false;
      if (failure) return;
      client->out.pop_front();
      write(client);
    });
  }

  void hear(const ClientPtr& client) {
    client->web.async_read(client->buffer, [this, client](const Failure& failure, std::size_t) {
      if (failure) {
        --connections;
        return;
      }
      const Json message = Json::parse(beast::buffers_to_string(client->buffer.data()));
      client->buffer.consume(client->buffer.size());
      take(message);
      hear(client);
      answer(client);
    });
  }

  void rest() {
    const std::scoped_lock lock(guard);
    began_s.reset();
  }

  void take(const Json& message) {
    const std::scoped_lock lock(guard);
    const double now_s = time_s();
    if (!began_s && (options.begins.empty() || std::filesystem::exists(folder / options.begins))) began_s = now_s;
    if (!isForce(message)) others.push_back(message.dump());
    for (const Json& entry : message.at("inverse3")) {
      const Json& command = entry.at("commands").at("set_cursor_force");
      Command told{.time_s = now_s,
                   .id = entry.at("device_id"),
                   .values = command.contains("values"),
                   .profile = message.contains("session"),
                   .position_mm = sent_mm,
                   .afterFault = fault_s >= 0};
      told.force_N = unpermuted(options.permutation, command.at(told.values ? "values" : "vector"));
      felt = glm::length(told.force_N) >= kFelt_N ? felt + 1 : 0;
      applied_N = told.force_N + (faultIsOn(now_s) && options.fault == "second" ? kSecond_N : DVec3(0));
      hand.write(applied_N);
      if (step_mm && steppedAt_s && std::abs(told.force_N.y - *step_mm) < 0.05) {
        latencies.push_back(1e6 * (now_s - *steppedAt_s));
        steppedAt_s.reset();
      }
      commands.push_back(std::move(told));
    }
  }

  bool faultIsOn(double now_s) const { return fault_s >= 0 && now_s < fault_s + options.fault_s; }
  bool faultIs(const char* name) const { return options.fault == name && faultIsOn(time_s()); }

  double time_s() const { return options.clock ? stepped_s.load() : since.elapsed_s(); }
  void pass(double duration_s) {
    if (!options.clock) return;
    const double until_s = stepped_s + duration_s;
    options.clock->goOnTo(until_s);
    stepped_s = until_s;
  }

  void answer(const ClientPtr& client) {
    pass(1 / options.rate_Hz);
    heard_s = since.elapsed_s();
    if (fault_s < 0 && !options.fault.empty() && felt >= 30) begin(client);
    if (faultIs("closed")) {
      Failure ignored;
      client->web.next_layer().close(ignored);
    } else if (faultIs("half")) {
      // A frame of 1000 bytes of text, of which ten come.
      if (!std::exchange(halved, true))
        asio::write(client->web.next_layer(), asio::buffer(std::string("\x81\x7e\x03\xe8{\"inverse3", 14)));
    } else if (faultIs("mute") || faultIs("merged")) {
      owed = options.fault == "merged" ? 1 : owed + 1;
    } else {
      reply(client);
    }
  }

  void begin(const ClientPtr& client) {
    {
      const std::scoped_lock lock(guard);
      fault_s = time_s();
    }
    std::ofstream(folder / "fault");
    tend(client);
  }
  /// Each millisecond until the fault is over, as it keeps the device from asking or the service from answering.
  void tend(const ClientPtr& client) {
    const auto timer = std::make_shared<asio::steady_timer>(io, std::chrono::milliseconds(1));
    timer->async_wait([this, client, timer](const Failure& failure) {
      if (failure) return;
      if (owed > 0 || since.elapsed_s() - heard_s > kRests_s) pass(1e-3);
      if (faultIsOn(time_s())) return tend(client);
      for (; owed > 0; --owed) reply(client);
    });
  }

  void reply(const ClientPtr& client) {
    if (listener && options.fault == "safety" && fault_s >= 0 && stage < (faultIsOn(time_s()) ? 1 : 2)) {
      ++stage;
      say(listener, Json{{"name", "device-safety-triggered"},
                         {"category", "device"},
                         {"level", stage == 1 ? "error" : "notice"},
                         {"data",
                          {{"device_id", options.ids.front()},
                           {"safety_type", stage == 1 ? "ebrake_triggered" : "ebrake_released"}}},
                         {"message", ""}}
                        .dump());
    }
    std::string text = state(false).dump();
    if (faultIs("nan")) {
      const std::size_t x = text.find("\"x\":");
      text.replace(x, text.find_first_of(",}", x) - x, "\"x\":NaN");
    }
    say(client, text);
  }

  DVec3 position_mm() {
    const double now_s = time_s(), since_s = began_s ? now_s - *began_s : 0;
    if (options.step_s > 0) {
      const double wanted = std::fmod(since_s, 2 * options.step_s) < options.step_s ? 0 : kStep_mm;
      if (!step_mm || wanted != *step_mm) steppedAt_s = now_s;
      step_mm = wanted;
      return {0, wanted, 0};
    }
    const DVec3 jump(0, 0, faultIs("jump") ? 30 : 0);
    if (since_s >= options.hand.back().t_s && !std::exchange(isAtEnd, true)) std::ofstream(folder / "path_end");
    return hand.read(since_s).position + jump;
  }

  Json state(bool whole) {
    const std::scoped_lock lock(guard);
    sent_mm = position_mm();
    Json json;
    if (whole) json["session_id"] = 7;
    json["inverse3"] = Json::array();
    for (const std::string& id : options.ids) {
      if (faultIs("gone")) continue;
      Json entry{{"device_id", id},
                 {"state", {{"cursor_position", permuted(options.permutation, 1e-3 * (kMiddle_mm + sent_mm))}}},
                 {"status",
                  {{"calibrated", options.calibrated && !faultIs("uncalibrated")},
                   {"in_use", options.inUse},
                   {"power_supply", !faultIs("unpowered")},
                   {"ready", true}}}};
      entry["state"]["current_cursor_force"] = permuted(options.permutation, options.tellsForce ? applied_N : DVec3(0));
      if (faultIs("null")) entry["state"]["cursor_position"]["x"] = nullptr;
      if (whole)
        entry["config"] = {{"type", "inverse3"},
                           {"device_info", {{"major_version", 7}, {"minor_version", 4}}},
                           {"handedness", options.handedness},
                           {"basis", {{"permutation", options.permutation}}}};
      json["inverse3"].push_back(entry);
    }
    if (!options.grips) return json;
    const double half = std::sqrt(0.5);
    if (options.wireless)
      json["wireless_verse_grip"] = {{{"device_id", "61548"},
                                      {"state",
                                       {{"orientation", {{"w", half}, {"x", 0}, {"y", 0}, {"z", half}}},
                                        {"buttons", {{"a", false}, {"b", options.pressed}, {"c", false}}},
                                        {"battery_level", 0.8}}},
                                      {"status", {{"connected", true}}}}};
    else
      json["verse_grip"] = {
          {{"device_id", "1"},
           {"state",
            {{"button", options.pressed}, {"hall", 0}, {"orientation", {{"w", 1}, {"x", 0}, {"y", 0}, {"z", 0}}}}}}};
    return json;
  }

  static constexpr double kRests_s = 0.05;  // without a command: the device has given up

  FakeHaplyOptions options;
  std::filesystem::path folder;
  asio::io_context io{1};
  tcp::acceptor simulation, events;
  ClientPtr listener;
  Stopwatch since;
  double heard_s = 0;
  std::atomic<double> stepped_s = 0;
  std::atomic<int> connections = 0;  // of devices
  mutable std::mutex guard;          // of what follows
  SimulatedTouch hand;
  std::optional<double> began_s, step_mm, steppedAt_s;
  double fault_s = -1;
  int felt = 0, stage = 0, owed = 0;
  bool halved = false, isAtEnd = false;
  DVec3 sent_mm{0}, applied_N{0};
  std::vector<Command> commands;
  std::vector<std::string> others;
  std::vector<double> latencies;
};

FakeHaply::FakeHaply(FakeHaplyOptions options)
    : service_(std::make_unique<Service>(std::move(options), folder_.path())),
      config_("PALPATE_HAPLY_CONFIG", (folder_ / "haply.json").string()),
      thread_([this] { service_->io.run(); }) {
  const std::uint16_t port = service_->simulation.local_endpoint().port();
  std::ofstream(folder_ / "haply.json") << Json{
      {"communication/websocket/host", "192.0.2.1"},  // reserved for documentation (RFC 5737): no machine has it
      {"communication/websocket/port", port},
      {"communication/http/port", port},
      {"communication/events/port", service_->events.local_endpoint().port()}};
}

FakeHaply::~FakeHaply() { service_->io.stop(); }

std::vector<FakeHaply::Command> FakeHaply::commands() const {
  const std::scoped_lock lock(service_->guard);
  return service_->commands;
}

void FakeHaply::waitUntilLeft() const {
  for (int i = 0; i < 30'000 && service_->connections > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  if (service_->connections > 0) throw Error("a device keeps its connection to the fake Haply service");
}

std::vector<std::string> FakeHaply::otherRequests() const {
  const std::scoped_lock lock(service_->guard);
  return service_->others;
}

double FakeHaply::faultBegan_s() const {
  const std::scoped_lock lock(service_->guard);
  return service_->fault_s;
}

int FakeHaply::forcesAfterFault() const {
  int count = 0;
  for (const Command& command : commands()) count += command.afterFault && command.force_N != DVec3(0);
  return count;
}

std::vector<double> FakeHaply::latencies_us() const {
  const std::scoped_lock lock(service_->guard);
  return service_->latencies;
}

}  // namespace palpate
