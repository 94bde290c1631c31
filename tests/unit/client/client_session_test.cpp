// SPDX-License-Identifier: MIT
// The client's end of the protocol, in memory and in virtual time.
#include "client/net/client_session.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/net/inline_preparation.hpp"
#include "tests/scenes/false_streams/false_openings.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/golden_messages.hpp"

namespace hapticast::client {
namespace {

using testing::FalseOpening;

LocalTime at(double seconds) { return localTime(1.0 + seconds); }

/// A session with its receiver.
struct Client {
  explicit Client(SessionSettings settings = {}) : session(std::move(settings), &receiver) {
    EXPECT_FALSE(session.open({}, at(0.0)));
    EXPECT_TRUE(session.poll(at(0.0))) << "the hello";
  }
  [[nodiscard]] auto receive(const Message& message, double time_s) {
    return session.receive(encode(message), at(time_s));
  }
  [[nodiscard]] bool welcome(double time_s = 0.0) {
    return receive(Welcome{kProtocolVersion, 1, 0, {}}, time_s).ok();
  }
  /// Answers each ping up to `until_s`.
  void answer(double from_s, double until_s) {
    for (double now_s = from_s; now_s < until_s; now_s += 0.01)
      while (const auto message = session.poll(at(now_s))) {
        const auto* const ping = std::get_if<Ping>(&*message);
        if (ping == nullptr) continue;
        EXPECT_TRUE(receive(Pong{ping->t0, mediaTime(now_s), mediaTime(now_s), {}}, now_s).ok());
      }
  }

  SetClock clock;
  FramePool pool;
  LatestValue<StreamTiming> timing;
  InlinePreparation preparation{
      pool, clock, Method::kHapticast,
      [this](const PreparedFrame& frame) { receiver.addPrepared(frame); }};
  Receiver receiver{preparation, timing, 1};
  ClientSession session;
};

TEST(ClientSession, EndsEachFalseOpeningWithItsSentence) {
  const auto openings = testing::listFalseOpenings();
  EXPECT_GE(openings.size(), 40U);
  for (const FalseOpening& opening : openings) {
    Client client;
    std::optional<SessionEnd> end;
    for (const auto& message : opening.messages) {
      ASSERT_FALSE(end) << opening.name << ": " << end->why;
      const auto received = client.session.receive(message, at(0.1));
      if (!received.ok()) end = received.error();
    }
    ASSERT_TRUE(end) << opening.name;
    EXPECT_NE(end->why.find(opening.why), std::string::npos) << opening.name << ": " << end->why;
    EXPECT_TRUE(end->code) << opening.name;
    EXPECT_FALSE(client.receiver.stream().connected) << opening.name;
  }
}

TEST(ClientSession, SendsTheHelloThenPingsAndReports) {
  Client client;
  EXPECT_FALSE(client.session.poll(at(1.0))) << "before the welcome";
  ASSERT_TRUE(client.welcome(1.0));
  int pings = 0, reports = 0;
  for (int ms = 1000; ms < 4000; ++ms)
    while (const auto message = client.session.poll(at(1e-3 * ms))) {
      pings += std::holds_alternative<Ping>(*message) ? 1 : 0;
      reports += std::holds_alternative<ReceiverReport>(*message) ? 1 : 0;
    }
  EXPECT_EQ(pings, 16 + 2);
  EXPECT_EQ(reports, 3);
}

TEST(ClientSession, APongCountsForAPingThatWasSentAndOnce) {
  Client client;
  ASSERT_TRUE(client.welcome());
  for (int i = 0; i < 20; ++i)
    ASSERT_TRUE(client.receive(Pong{at(-i), mediaTime(100.0), mediaTime(100.0), {}}, 0.1).ok());
  EXPECT_FALSE(client.receiver.stream().connected) << "the clock is not set";
  client.answer(0.1, 1.0);
  EXPECT_TRUE(client.receiver.stream().connected);
  const auto ping = client.session.poll(at(3.0));
  ASSERT_TRUE(ping && std::holds_alternative<Ping>(*ping));
  const LocalTime t0 = std::get<Ping>(*ping).t0;
  const Duration offset = client.receiver.stream().clock_offset;
  ASSERT_TRUE(client.receive(Pong{t0, mediaTime(3.0), mediaTime(3.0), {}}, 3.0).ok());
  for (int i = 0; i < 50; ++i)
    ASSERT_TRUE(client.receive(Pong{t0, mediaTime(99.0), mediaTime(99.0), {}}, 3.0).ok());
  EXPECT_LT(std::abs(toSeconds(client.receiver.stream().clock_offset - offset)), 0.01);
}

TEST(ClientSession, EndsAfterEachTimeLimit) {
  Client client;
  EXPECT_FALSE(client.session.expire(at(4.9)));
  ASSERT_TRUE(client.session.expire(at(5.0)));
  EXPECT_EQ(client.session.expire(at(5.0))->why, "no welcome arrived; is it a hapticast server?");
  ASSERT_TRUE(client.welcome(1.0));
  EXPECT_FALSE(client.session.expire(at(3.9)));
  ASSERT_TRUE(client.session.expire(at(4.1)));
  EXPECT_EQ(client.session.expire(at(4.1))->why, "the server stopped sending");
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(client.receive(Preparing{0.5}, 1.0 + i).ok());
  ASSERT_TRUE(client.session.expire(at(6.1))) << "no pong";
  EXPECT_EQ(client.session.expire(at(6.1))->code, ErrorCode::kTimeout);
  client.answer(6.0, 6.5);
  EXPECT_FALSE(client.session.expire(at(6.6)));
}

TEST(ClientSession, PausesDoubleUntilASessionWasGood) {
  Client client;
  const auto close = [&](double now_s) {
    const auto pause = client.session.close({.why = "lost"}, at(now_s));
    EXPECT_FALSE(client.session.open({}, at(now_s)));
    return pause ? toSeconds(*pause) : -1.0;
  };
  for (const double expected_s : {0.2, 0.4, 0.8, 1.0, 1.0}) EXPECT_EQ(close(0.0), expected_s);
  ASSERT_TRUE(client.welcome(1.0));
  ASSERT_TRUE(client.receive(testing::coded(testing::goldenFrame()), 1.0).ok());
  EXPECT_EQ(close(2.0), 1.0) << "one second of frames";
  ASSERT_TRUE(client.welcome(3.0));
  ASSERT_TRUE(client.receive(testing::coded(testing::goldenFrame()), 3.0).ok());
  EXPECT_EQ(close(6.5), 0.2);
}

TEST(ClientSession, DoesNotRetryWhereItIsUseless) {
  using enum ErrorCode;
  for (const bool welcomed : {false, true})
    for (const ErrorCode code : {kMalformed, kTooLarge, kVersion, kUnexpected, kServerFull,
                                 kTimeout, kShuttingDown, kUnauthorized, kForbidden}) {
      Client client;
      ASSERT_EQ(welcomed && client.welcome(), welcomed);
      const bool always = code == kVersion || code == kUnauthorized || code == kForbidden;
      const bool of_another_program =
          code == kMalformed || code == kTooLarge || code == kUnexpected;
      const auto pause = client.session.close({.why = "", .code = code}, at(1.0));
      EXPECT_EQ(!pause, always || (of_another_program && !welcomed)) << static_cast<int>(code);
    }
  for (const bool welcomed : {false, true}) {
    Client client;
    ASSERT_EQ(welcomed && client.welcome(), welcomed);
    EXPECT_EQ(!client.session.close({.why = "", .no_such_server = true}, at(1.0)), !welcomed);
  }
}

TEST(ClientSession, ATokenGoesOverTlsOrToThisMachine) {
  SessionSettings settings;
  settings.access_token = "secret";
  for (const bool insecure : {false, true}) {
    settings.insecure = insecure;
    ClientSession session(settings, nullptr);
    const auto refusal = session.open({}, at(0.0));
    EXPECT_EQ(refusal.has_value(), !insecure);
    EXPECT_FALSE(refusal && session.close(*refusal, at(0.0))) << "a retry is useless";
    EXPECT_FALSE(session.open({.encrypted = true}, at(0.0)));
    EXPECT_FALSE(session.open({.of_this_machine = true}, at(0.0)));
    const auto hello = session.poll(at(0.0));
    ASSERT_TRUE(hello);
    EXPECT_EQ(std::get<Hello>(*hello).access_token, "secret");
  }
}

TEST(ClientSession, RequestsWaitForTheWelcomeAndAreLimited) {
  Client client;
  EXPECT_FALSE(client.session.request(Control{}));
  ASSERT_TRUE(client.welcome());
  for (std::size_t i = 0; i < ClientSession::kMostRequests; ++i)
    EXPECT_TRUE(client.session.request(Control{}));
  EXPECT_FALSE(client.session.request(Control{}));
  client.session.request(Delivery{});
  const auto first = client.session.poll(at(0.0));
  ASSERT_TRUE(first);
  EXPECT_TRUE(std::holds_alternative<Delivery>(*first));
  const auto second = client.session.poll(at(0.0));
  ASSERT_TRUE(second && std::holds_alternative<Control>(*second));
  EXPECT_TRUE(client.receive(Control{}, 0.1).ok()) << "the answer";
}

TEST(ClientSession, JoinsThePartsOfAPictureAndConfirmsThem) {
  SessionSettings settings;
  settings.wants_video = true;
  settings.sends_pings = false;
  Client client(settings);
  ASSERT_TRUE(client.welcome());
  EXPECT_FALSE(client.session.poll(at(0.0))) << "no receipt before the first part";
  const auto whole = encode(VideoFrame{0, 1, {}, {0xFF, 0xD8, 1, 2, 3, 4}});
  const auto size = static_cast<std::uint32_t>(whole.size());
  const auto middle = whole.begin() + 5;
  std::uint64_t bytes = encode(Welcome{kProtocolVersion, 1, 0, {}}).size();
  const auto send = [&](const PicturePart& part, double time_s) {
    bytes += encode(part).size();
    return client.receive(part, time_s);
  };
  ASSERT_TRUE(send({size, {9, 9}, false}, 0.9).ok()) << "a picture that the server gives up";
  ASSERT_TRUE(send({size, {whole.begin(), middle}, true}, 1.0).ok());
  EXPECT_TRUE(client.session.arePicturesReduced());
  const auto receipt = client.session.poll(at(1.0));
  ASSERT_TRUE(receipt && std::holds_alternative<Receipt>(*receipt));
  EXPECT_EQ(std::get<Receipt>(*receipt).bytes, bytes);
  const auto last = send({0, {middle, whole.end()}, false}, 1.001);
  ASSERT_TRUE(last.ok());
  ASSERT_TRUE(std::holds_alternative<VideoFrame>(last.value()));
  EXPECT_EQ(std::get<VideoFrame>(last.value()).jpeg.size(), 6U);
  EXPECT_FALSE(client.session.poll(at(1.001))) << "receipts have a shortest interval";
  EXPECT_EQ(client.session.nextMessage(), at(1.02));
  const auto second = client.session.poll(at(1.02));
  ASSERT_TRUE(second);
  EXPECT_EQ(std::get<Receipt>(*second).held, at(1.02) - at(1.001));
  EXPECT_FALSE(send({0, {1}, false}, 1.1).ok()) << "a part of no picture";
}

TEST(ClientSession, EndsAtPartsThatAreNoPicture) {
  SessionSettings settings;
  settings.wants_video = true;
  const auto ping = encode(Ping{});
  for (const auto& parts :
       {std::vector<PicturePart>{{4, {1, 2, 3, 4, 5}, false}},
        std::vector<PicturePart>{{static_cast<std::uint32_t>(ping.size()), ping, false}},
        std::vector<PicturePart>{{2, {0xFF, 0xFF}, false}}}) {
    Client client(settings);
    ASSERT_TRUE(client.welcome());
    for (const PicturePart& part : parts) EXPECT_FALSE(client.receive(part, 0.1).ok());
  }
  Client blind;
  ASSERT_TRUE(blind.welcome());
  EXPECT_FALSE(blind.receive(PicturePart{4, {1}, false}, 0.1).ok()) << "it requested no pictures";
}

TEST(ClientSession, ReceivesTheActsOfOthersIfItWantsThem) {
  const Control act{true, {}, {}, {}, {}, "Anna", mediaTime(1.0)};
  for (const bool wants : {false, true}) {
    SessionSettings settings;
    settings.wants_acts = wants;
    Client client(settings);
    ASSERT_TRUE(client.welcome());
    EXPECT_EQ(client.receive(act, 0.1).ok(), wants);
  }
}

TEST(ClientSession, AnotherWelcomeBeginsAnew) {
  Client client;
  ASSERT_TRUE(client.welcome());
  EXPECT_TRUE(client.session.isDescriptionNew());
  client.answer(0.0, 1.0);
  EXPECT_TRUE(client.receiver.stream().connected);
  ASSERT_TRUE(client.welcome(2.0));
  EXPECT_EQ(client.session.welcomes(), 2U);
  EXPECT_FALSE(client.session.isDescriptionNew());
  EXPECT_FALSE(client.receiver.stream().connected) << "the clock is measured again";
  EXPECT_EQ(client.session.nextMessage(), at(2.0));
}

/// Any messages of any kind at any time: the session says hello first, sends nothing before a
/// welcome, and each error ends it.
TEST(ClientSession, SurvivesAnyOrderOfMessages) {
  std::mt19937 random(20261130);
  const auto golden = testing::goldenMessages();
  for (int run = 0; run < 100; ++run) {
    Client client;
    double now_s = 0.0;
    for (int step = 0; step < 60; ++step) {
      now_s += 1e-3 * static_cast<double>(random() % 1500);
      auto bytes = encode(golden[random() % golden.size()].second);
      if (random() % 4 == 0) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      const auto received = client.session.receive(bytes, at(now_s));
      auto end = client.session.expire(at(now_s));
      if (!received.ok()) end = received.error();
      if (end) {
        (void)client.session.close(*end, at(now_s));
        EXPECT_FALSE(client.session.open({}, at(now_s)));
        const auto hello = client.session.poll(at(now_s));
        ASSERT_TRUE(hello && std::holds_alternative<Hello>(*hello));
      }
      while (const auto message = client.session.poll(at(now_s)))
        ASSERT_TRUE(client.session.welcomed()) << message->index();
    }
  }
}

}  // namespace
}  // namespace hapticast::client
