// SPDX-License-Identifier: MIT
// The four surroundings of ClientSession: socket, page, library and --control end each false
// opening with the sentence that the session has for it.
#include <atomic>
#include <functional>
#include <thread>

#include "client/commands/control_command.hpp"
#include "client/include/hapticast/renderer.hpp"
#include "client/include/hapticast/stream.hpp"
#include "client/web/viewer.hpp"
#include "tests/integration/fake_server.hpp"
#include "tests/scenes/false_streams/false_openings.hpp"
#include "tests/support/log_lines.hpp"

namespace hapticast::testing {
namespace {

class FalseOpeningTest : public StreamTest {
 protected:
  /// Returns the sentence of the session alone.
  static std::string findWhy(const FalseOpening& opening) {
    client::ClientSession session({}, nullptr);
    EXPECT_FALSE(session.open({}, LocalTime{}));
    for (const auto& message : opening.messages) {
      const auto received = session.receive(message, LocalTime{});
      if (!received.ok()) return received.error().why;
    }
    return "";
  }
  /// Plays the server of an opening. Returns true once the client has ended the connection.
  static bool serve(FakeServer& server, const FalseOpening& opening) {
    if (!server.peer && server.accept())
      for (const auto& message : opening.messages) server.peer->send(framed(message));
    if (!server.peer) return false;
    server.peer->poll();
    return server.peer->closed;
  }
  /// Runs --control, and `step` until it has ended. Returns whether the request succeeded.
  bool control(const client::Settings& settings, const std::function<void()>& step) {
    std::atomic<bool> is_done{false};
    bool succeeded = false;
    std::jthread control_thread([&] {
      succeeded = client::controlServer(settings);
      is_done = true;
    });
    EXPECT_TRUE(runUntil([&] {
      step();
      return is_done.load();
    }));
    control_thread.join();
    return succeeded;
  }

  const std::vector<FalseOpening> openings = listFalseOpenings();
};

TEST_F(FalseOpeningTest, AConnectionEndsWithTheSentenceOfTheSession) {
  std::vector<std::unique_ptr<TestClient>> clients;  // which `io` may still call
  for (const FalseOpening& opening : openings) {
    FakeServer server(io);
    clients.push_back(std::make_unique<TestClient>(io, clock, server.port()));
    TestClient& client = *clients.back();
    ASSERT_TRUE(runUntil([&] {
      (void)serve(server, opening);
      return !client.failure.empty() || !client.lost.empty();
    })) << opening.name;
    EXPECT_EQ(client.failure.empty() ? client.lost.front() : client.failure, findWhy(opening))
        << opening.name;
    client.connection.stop();
    ASSERT_TRUE(runUntil([&] { return serve(server, opening); }));
  }
}

TEST_F(FalseOpeningTest, APageEndsWithTheSentenceOfTheSession) {
  for (const FalseOpening& opening : openings) {
    const auto viewer = std::make_unique<client::WebViewer>();
    ASSERT_TRUE(viewer->open({}, LocalTime{}));
    for (const auto& message : opening.messages) (void)viewer->receive(message, LocalTime{});
    EXPECT_EQ(viewer->end().why, findWhy(opening)) << opening.name;
  }
}

TEST_F(FalseOpeningTest, TheLibraryEndsWithTheSentenceOfTheSession) {
  for (const FalseOpening& opening : openings) {
    if (opening.is_plain_only) continue;  // MessagePlayer assumes that the caller used TLS
    Renderer renderer;
    MessagePlayer player(renderer);
    std::string why;
    for (const auto& message : opening.messages) {
      try {
        player.push(message, 1.0);
      } catch (const std::runtime_error& error) {
        why = error.what();
      }
    }
    EXPECT_EQ(why, findWhy(opening)) << opening.name;
  }
}

TEST_F(FalseOpeningTest, ControlEndsWithTheSentenceOfTheSession) {
  for (const FalseOpening& opening : openings) {
    if (opening.name == "an answer to nothing") continue;  // it answers the request
    FakeServer server(io);
    client::Settings settings;
    settings.server.port = server.port();
    settings.control = Control{};
    LogLines log;
    EXPECT_FALSE(control(settings, [&] { (void)serve(server, opening); })) << opening.name;
    EXPECT_NE(log.text().find(findWhy(opening)), std::string::npos)
        << opening.name << ": " << findWhy(opening) << " / " << log.text();
  }
}

TEST_F(FalseOpeningTest, ControlEndsWithTheSentenceOfTheSessionForASilentServer) {
  client::ClientSession session({}, nullptr);
  ASSERT_FALSE(session.open({}, LocalTime{}));
  const auto why = session.expire(session.nextDeadline());
  ASSERT_TRUE(why);
  FakeServer server(io);
  client::Settings settings;
  settings.server.port = server.port();
  settings.control = Control{};
  const LogLines log;
  EXPECT_FALSE(control(settings, [&] { (void)serve(server, {}); }));
  EXPECT_NE(log.text().find(why->why), std::string::npos) << log.text();
}

/// An operator's request goes to the expected origin only.
TEST_F(FalseOpeningTest, ControlChecksTheOriginsKey) {
  for (const bool is_expected : {false, true}) {
    FakeServer server(io);
    Welcome welcome{kProtocolVersion, 1, 0, {}};
    welcome.verifying_key = SigningKey(KeyBytes{1}).verifyingKey();
    client::Settings settings;
    settings.server.port = server.port();
    settings.control = Control{};
    settings.origin_keys = {
        {SigningKey(KeyBytes{is_expected ? std::uint8_t{1} : std::uint8_t{2}}).verifyingKey()}};
    const LogLines log;
    std::size_t requests = 0;
    const bool succeeded = control(settings, [&] {
      if (!server.peer && server.accept()) server.peer->send(welcome);
      if (server.peer) server.peer->poll();
      const bool is_new = server.peer && server.peer->all<Control>().size() > requests;
      if (is_new) server.peer->send(server.peer->all<Control>()[requests++]);
    });
    EXPECT_EQ(succeeded, is_expected);
    EXPECT_EQ(requests, is_expected ? 1U : 0U);
    EXPECT_EQ(log.text().find("not the expected one") == std::string::npos, is_expected)
        << log.text();
  }
}

}  // namespace
}  // namespace hapticast::testing
