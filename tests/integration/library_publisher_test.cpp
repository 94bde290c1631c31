// SPDX-License-Identifier: MIT
// The Publisher of the library against the client's network half and hand-made peers.
#include "server/include/hapticast/publisher.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <future>
#include <limits>
#include <stdexcept>

#include "common/wire_limits.hpp"
#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {
namespace {

PublisherSettings local() {
  PublisherSettings settings;
  settings.info.name = "disc";
  settings.listen = "127.0.0.1:0";
  return settings;
}

/// A disc whose top is tilted.
std::shared_ptr<HeightMap> makeDisc(double top_mm) {
  auto map = std::make_shared<HeightMap>(270, 190, 100, 80);
  for (int v = 0; v < 80; ++v) {
    for (int u = 0; u < 100; ++u) {
      if (std::hypot(u - 49.5, v - 39.5) < 35.0)
        map->set(u, v, static_cast<float>(top_mm + 0.037 * u));
    }
  }
  return map;
}

Frame makeFrame(double top_mm = 20.0) {
  Frame frame;
  frame.objects.emplace_back().heights = makeDisc(top_mm);
  return frame;
}

std::size_t countOpenFiles() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

class LibraryPublisher : public StreamTest {
 protected:
  std::unique_ptr<RawPeer> join(Publisher& publisher, bool wants_video = false) {
    auto peer = std::make_unique<RawPeer>(io, publisher.port());
    peer->send(Hello{kProtocolVersion, "raw", wants_video, true});
    EXPECT_TRUE(receives<Welcome>(*peer));
    return peer;
  }
  /// Returns the largest error of the heights in the newest frame; nullopt: none has come.
  static std::optional<double> measureError_mm(TestClient& client, const HeightMap& sent) {
    while (client.preparation.step()) {
    }
    std::optional<double> largest_mm;
    client::FramePool::Index index = 0;
    while (client.pool->pop(index)) {
      const client::PlayFrame& frame = client.pool->frame(index);
      client.frames.push_back({frame.epoch, frame.id});
      largest_mm = 0.0;
      for (int v = 0; v < sent.height_px; ++v) {
        for (int u = 0; u < sent.width_px; ++u) {
          const auto at = static_cast<std::size_t>(v * sent.width_px + u);
          if (sent.mask[at] == 0) continue;
          const Vec2 px(sent.left_px + u + 0.5, sent.top_px + v + 0.5);
          const client::PlayObject& object = frame.objects[0];
          EXPECT_TRUE(object.field->inside(px));
          const double height_mm = object.field->bilinear(px).height_mm;
          largest_mm = std::max(*largest_mm, std::abs(height_mm - sent.height_mm[at]));
        }
      }
      client.pool->release(index);
    }
    return largest_mm;
  }

  SteadyClock real;
};

TEST_F(LibraryPublisher, FramesArriveWithTheirHeightsAndRisingIds) {
  Publisher publisher(local());
  TestClient client(io, real, publisher.port());
  ASSERT_TRUE(runUntil([&] { return client.welcomes > 0 && publisher.viewers() == 1; }));
  for (int i = 0; i < 10; ++i) {
    const Frame frame = makeFrame(10.0 + i);
    const double time_s = publisher.publish(frame);
    EXPECT_LE(time_s, publisher.now());
    std::optional<double> error_mm;
    ASSERT_TRUE(runUntil([&] {
      error_mm = measureError_mm(client, *frame.objects[0].heights);
      return error_mm.has_value();
    }));
    EXPECT_LT(*error_mm, 0.0201);
  }
  ASSERT_EQ(client.frames.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(client.frames[i].second, i + 1);
}

TEST_F(LibraryPublisher, UnchangedHeightsAreSentOnce) {
  Publisher publisher(local());
  const auto peer = join(publisher);
  EXPECT_EQ(peer->all<Welcome>()[0].description.name, "disc");
  const Frame frame = makeFrame();
  publisher.publish(frame, 0.0);
  publisher.publish(frame, 0.001);
  publisher.publish(makeFrame(21.0), 0.002);
  ASSERT_TRUE(receives<CodedFrame>(*peer, 3));
  const auto frames = peer->all<CodedFrame>();
  EXPECT_TRUE(frames[0].objects[0].relief);
  EXPECT_FALSE(frames[1].objects[0].relief);
  EXPECT_TRUE(frames[2].objects[0].relief);
  EXPECT_EQ(frames[1].media_time, mediaTime(0.001));
}

TEST_F(LibraryPublisher, ObjectsWithoutHeightsAreLeftOut) {
  Publisher publisher(local());
  const auto peer = join(publisher);
  Frame frame = makeFrame();
  frame.objects.emplace_back().id = 2;
  frame.objects.emplace_back().id = 3;
  frame.objects.back().heights = std::make_shared<HeightMap>(0, 0, 50, 50);  // nothing in the mask
  publisher.publish(frame);
  ASSERT_TRUE(receives<CodedFrame>(*peer, 1));
  ASSERT_EQ(peer->all<CodedFrame>()[0].objects.size(), 1U);
  EXPECT_EQ(peer->all<CodedFrame>()[0].objects[0].id, 1U);
}

TEST_F(LibraryPublisher, ThePictureReachesViewersThatWantIt) {
  Publisher publisher(local());
  const auto blind = join(publisher);
  const auto seeing = join(publisher, true);
  Frame frame = makeFrame();
  frame.jpeg = {0xFF, 0xD8, 1, 2, 3};
  publisher.publish(frame);
  ASSERT_TRUE(receives<VideoFrame>(*seeing));
  EXPECT_EQ(seeing->all<VideoFrame>()[0].jpeg, frame.jpeg);
  EXPECT_EQ(seeing->all<VideoFrame>()[0].id, 1U);
  ASSERT_TRUE(receives<CodedFrame>(*blind));
  EXPECT_TRUE(blind->all<VideoFrame>().empty());
}

TEST_F(LibraryPublisher, WrongFramesThrowAndSendNothing) {
  Publisher publisher(local());
  const auto peer = join(publisher, true);
  const Frame right = makeFrame();
  publisher.publish(right, 0.0);
  Frame wrong = right;
  wrong.objects[0].position_mm.x() = std::nan("");
  EXPECT_THROW(publisher.publish(wrong), std::invalid_argument);
  wrong = right;
  wrong.jpeg = {1, 2, 3};
  EXPECT_THROW(publisher.publish(wrong), std::invalid_argument);
  wrong.jpeg.assign(limits::kJpeg + 1, 0xFF);
  wrong.jpeg[1] = 0xD8;
  EXPECT_THROW(publisher.publish(wrong), std::invalid_argument);
  for (const double time_s : {0.0, publisher.now() + 5.0, std::nan("")})
    EXPECT_THROW(publisher.publish(right, time_s), std::invalid_argument) << time_s;
  wrong = right;
  wrong.time_s = std::nan("");  // ignored, as its id
  wrong.id = 99;
  publisher.publish(wrong);
  ASSERT_TRUE(receives<CodedFrame>(*peer, 2));
  EXPECT_EQ(peer->all<CodedFrame>()[1].id, 2U);
  EXPECT_FALSE(peer->all<CodedFrame>()[1].objects[0].relief) << "known from the first frame";
  EXPECT_TRUE(peer->all<VideoFrame>().empty());
}

TEST_F(LibraryPublisher, CloseSaysGoodbyeToAWaitingViewer) {
  Publisher publisher(local());
  const auto peer = join(publisher);
  auto closed = std::async(std::launch::async, [&] { publisher.close(); });
  EXPECT_EQ(farewell(*peer).code, ErrorCode::kShuttingDown);
  closed.get();
  publisher.close();
  EXPECT_EQ(publisher.viewers(), 0U);
  EXPECT_THROW(publisher.publish(makeFrame()), std::runtime_error);
}

TEST_F(LibraryPublisher, AThousandOfThemLeaveNothingOpen) {
  { const Publisher first(local()); }
  const std::size_t before = countOpenFiles();
  for (int i = 0; i < 1000; ++i) {
    Publisher publisher(local());
    if (i % 2 == 0) publisher.close();
  }
  EXPECT_EQ(countOpenFiles(), before);
}

TEST_F(LibraryPublisher, AMoveKeepsTheStream) {
  Publisher publisher(local());
  const auto peer = join(publisher);
  Publisher other(local());
  other = std::move(publisher);
  other.publish(makeFrame());
  EXPECT_TRUE(receives<CodedFrame>(*peer, 1));
}

TEST_F(LibraryPublisher, AChildProcessNeitherSendsNorHangs) {
  auto publisher = std::make_unique<Publisher>(local());
  const auto peer = join(*publisher);
  const pid_t child = ::fork();
  if (child == 0) {
    int refused = 0;
    const auto attempt = [&refused](const std::function<void()>& use) {
      try {
        use();
      } catch (const std::runtime_error&) {
        ++refused;
      }
    };
    attempt([&] { publisher->publish({}); });
    attempt([&] { (void)publisher->now(); });
    attempt([&] { (void)publisher->port(); });
    attempt([&] { (void)publisher->viewers(); });
    attempt([&] { publisher->close(); });
    publisher.reset();
    ::_exit(refused);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 5);
  publisher->publish(makeFrame());
  EXPECT_TRUE(receives<CodedFrame>(*peer, 1));
}

/// The message of the exception that `settings` cause.
template <class Failure>
std::string complain(const PublisherSettings& settings) {
  try {
    const Publisher publisher(settings);
  } catch (const Failure& error) {
    return error.what();
  }
  return "";
}

TEST_F(LibraryPublisher, WrongSettingsAreNamed) {
  const auto changed = [](const std::function<void(PublisherSettings&)>& change) {
    PublisherSettings settings = local();
    change(settings);
    return settings;
  };
  const std::vector<std::pair<PublisherSettings, std::string>> wrong{
      {changed([](auto& s) { s.listen = "1:2:3:x"; }), "listen"},
      {changed([](auto& s) { s.listen = "somewhere:7447"; }), "listen"},
      {changed([](auto& s) { s.listen = "1:70000"; }), "listen"},
      {changed([](auto& s) { s.max_viewers = 0; }), "max_viewers"},
      {changed([](auto& s) { s.max_viewers = 10'001; }), "max_viewers"},
      {changed([](auto& s) { s.tls_cert_file = "a.pem"; }), "tls_key_file"},
      {changed([](auto& s) { s.info.fps = 0.0; }), "fps"},
      {changed([](auto& s) { s.info.name = "\xFF"; }), "name"},
  };
  for (const auto& [settings, member] : wrong) {
    const std::string what = complain<std::invalid_argument>(settings);
    EXPECT_NE(what.find(member), std::string::npos) << member << ": " << what;
    EXPECT_EQ(what.find("--"), std::string::npos) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
  }
  const std::vector<std::pair<PublisherSettings, std::string>> missing{
      {changed([](auto& s) { s.tokens_file = "/no/tokens"; }), "tokens_file /no/tokens"},
      {changed([](auto& s) { s.tls_cert_file = s.tls_key_file = "/no/a.pem"; }), "tls_cert_file"},
  };
  for (const auto& [settings, member] : missing)
    EXPECT_EQ(complain<std::runtime_error>(settings).find(member), 0U);
}

TEST_F(LibraryPublisher, APortInUseIsAnError) {
  const Publisher first(local());
  PublisherSettings settings = local();
  settings.listen = "127.0.0.1:" + std::to_string(first.port());
  const std::string what = complain<std::runtime_error>(settings);
  EXPECT_NE(what.find("in use"), std::string::npos) << what;
  EXPECT_EQ(what.find("--"), std::string::npos) << what;
}

}  // namespace
}  // namespace hapticast::testing
