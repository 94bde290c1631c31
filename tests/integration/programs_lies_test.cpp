// SPDX-License-Identifier: MIT
// The client as a user runs it, and servers that lie to it over TCP: nothing is felt that the log
// could not stand, and the user is told.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/integration/programs_fixture.hpp"
#include "tests/integration/stream_fixture.hpp"
#include "tests/support/lying_server.hpp"

namespace hapticast::testing {
namespace {

/// Tells one lie to whoever comes, one viewer at a time.
class LyingListener {
 public:
  explicit LyingListener(const Lie& lie)
      : server_(lie),
        acceptor_(io_, {asio::ip::address_v4::loopback(), 0}),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}
  [[nodiscard]] std::string address() const {
    return "127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port());
  }

 private:
  void run(const std::stop_token& stop) {
    acceptor_.non_blocking(true);
    while (!stop.stop_requested()) {
      boost::system::error_code none;
      asio::ip::tcp::socket socket(io_);
      acceptor_.accept(socket, none);
      if (none) {
        pause();
        continue;
      }
      RawPeer viewer(std::move(socket));
      talk(viewer, stop);
    }
  }
  void talk(RawPeer& viewer, const std::stop_token& stop) {
    while (viewer.all<Hello>().empty() && !viewer.closed && !stop.stop_requested()) {
      viewer.poll();
      pause();
    }
    viewer.got.clear();
    viewer.send(framed(server_.welcome()));
    const LocalTime begin = clock_.now();
    while (!viewer.closed && !stop.stop_requested()) {
      viewer.poll();
      const double now_s = secondsSince(begin);
      for (const Ping& ping : viewer.all<Ping>()) {
        if (const auto answer = server_.answer(ping, now_s)) viewer.send(framed(*answer));
      }
      viewer.got.clear();
      for (const Bytes& message : server_.messages(now_s)) viewer.send(framed(message));
      pause();
    }
  }
  [[nodiscard]] double secondsSince(LocalTime begin) const {
    return toSeconds(clock_.now() - begin);
  }
  static void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(2)); }

  SteadyClock clock_;
  asio::io_context io_;
  LyingServer server_;
  asio::ip::tcp::acceptor acceptor_;
  std::jthread thread_;  // last: it uses the others
};

struct Told {
  const char* lie;
  const char* said;  ///< in the client's output
};

class ProgramsLiesTest : public ProgramsTest {
 protected:
  static const Lie& named(const std::string& name) {
    const auto& all = lies();
    return *std::find_if(all.begin(), all.end(), [&](const Lie& lie) { return lie.name == name; });
  }
  void expectSafe(const std::string& name) const {
    const std::vector<LogRow> rows = readLog(path(name + ".csv"));
    EXPECT_GT(rows.size(), 1000U) << name;
    double most_N = 0.0;
    for (const LogRow& row : rows) most_N = std::max(most_N, row.force_N.norm());
    EXPECT_LE(most_N, 3.3 + 1e-6) << name;
    EXPECT_EQ(rows.empty() ? 1.0 : rows.back().force_N.norm(), 0.0) << name << ": it ends at rest";
  }
};

TEST_F(ProgramsLiesTest, AreLimitedAndTheUserIsTold) {
  const std::array kLies = std::to_array<Told>({
      {"acceleration_1e8_described", "the stream is not trusted any more"},
      {"acc_square_4hz_x", "no force from now on; start again, or with --rearm"},
      {"id_max_once", "jumps of the frames' ids"},
      {"outside", "whose objects are not shown"},
      {"silence", "no new frames come: the force has faded"},
      {"stiffness_1000", "a wall is softer than its author asks for"},
      {"structure_cut", "trying again"},
  });
  const std::string hold = write("hold.csv", "0,0,0,25\n1,0,0,25\n1.5,0,0,4\n100,0,0,4\n");
  std::vector<std::unique_ptr<LyingListener>> servers;
  std::vector<std::unique_ptr<Process>> clients;
  servers.reserve(kLies.size());
  clients.reserve(kLies.size());
  for (const Told& each : kLies) {
    servers.push_back(std::make_unique<LyingListener>(named(each.lie)));
    clients.push_back(startClient({servers.back()->address(), "--device", "virtual", "--hand", hold,
                                   "--log", path(std::string(each.lie) + ".csv"), "--fault-dir",
                                   path("faults"), "--seconds", "6"}));
  }
  for (std::size_t i = 0; i < kLies.size(); ++i) {
    EXPECT_EQ(clients[i]->wait(kSoon), 0) << kLies[i].lie << clients[i]->output();
    EXPECT_NE(clients[i]->output().find(kLies[i].said), std::string::npos) << kLies[i].lie << ":\n"
                                                                           << clients[i]->output();
    const std::string output = clients[i]->output();
    EXPECT_LE(std::count(output.begin(), output.end(), '\n'), 24) << output;
    expectSafe(kLies[i].lie);
  }
}

}  // namespace
}  // namespace hapticast::testing
