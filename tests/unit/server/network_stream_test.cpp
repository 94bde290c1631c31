// SPDX-License-Identifier: MIT
// Live streams from a sender of the test, over a real socket: what is refused, and what happens
// when the sender ends. The videos are written with ffmpeg where it is there.
#include "server/source/live/network_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "common/transport/asio.hpp"
#include "server/source/video/video_file.hpp"
#include "tests/support/installed.hpp"
#include "tests/support/waiting.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kHttpStart = "HTTP/1.0 200 OK\r\nContent-Type: video/mp2t\r\n\r\n";
const VideoLayout kBeside{Layout::kSideBySide, DepthCode::kGrey};
constexpr int kLongest_ms = 60'000;  // for what takes moments on an idle machine

/// Serves HTTP on a port of this machine, one connection after the other.
class HttpSender {
 public:
  /// What the sender does with connection `number`, 0 for the first one, after its request.
  using Script = std::function<void(HttpSender& sender, int number)>;

  explicit HttpSender(const Script& script)
      : acceptor_(io_, {asio::ip::address_v4::loopback(), 0}), thread_([this, script] {
          for (int number = 0; !stop_; ++number) {
            boost::system::error_code error;
            socket_.emplace(acceptor_.accept(error));
            if (error) return;
            char request[4096];
            socket_->read_some(asio::buffer(request), error);
            script(*this, number);
            socket_.reset();
          }
        }) {}
  ~HttpSender() {
    stop_ = true;
    ::shutdown(acceptor_.native_handle(), SHUT_RDWR);  // wakes accept()
  }
  HttpSender(const HttpSender&) = delete;
  HttpSender& operator=(const HttpSender&) = delete;

  [[nodiscard]] std::string url(const std::string& path) const {
    return "http://me:secret@127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port()) + path;
  }
  /// Sends all of `bytes`. Returns false if the receiver has gone.
  bool send(const std::string& bytes) {
    boost::system::error_code error;
    asio::write(*socket_, asio::buffer(bytes), error);
    return !error && !stop_;
  }
  /// Sends `bytes` evenly within `duration`, in steps of 20 ms.
  bool sendSlowly(const std::string& bytes, std::chrono::milliseconds duration) {
    const auto steps = static_cast<std::size_t>(duration.count() / 20);
    for (std::size_t i = 0; i < steps; ++i) {
      const std::size_t from = bytes.size() * i / steps;
      if (!send(bytes.substr(from, bytes.size() * (i + 1) / steps - from))) return false;
      restBetweenTurns(std::chrono::milliseconds(20));
    }
    return true;
  }
  /// Sends nothing until the receiver has gone.
  void hold() {
    pollfd wait{socket_->native_handle(), POLLIN, 0};
    while (!stop_ && ::poll(&wait, 1, 20) == 0) {
    }
  }

 private:
  asio::io_context io_;
  asio::ip::tcp::acceptor acceptor_;
  std::optional<asio::ip::tcp::socket> socket_;  // of the thread
  std::atomic<bool> stop_{false};
  std::jthread thread_;
};

/// Returns why VideoFile refuses what the sender sends. It waits for the network as long as
/// `patience` questions whether to go on.
std::string refusal(const HttpSender::Script& script, int patience = 1'000'000,
                    const std::string& path = "/cam") {
  HttpSender sender(script);
  return errorOf([&] {
    (void)VideoFile(NetworkStream{sender.url(path), "http://host" + path,
                                  [&patience] { return --patience < 0; }});
  });
}

TEST(NetworkStream, ARefusalNamesTheAddressWithoutItsSecrets) {
  std::string url;
  {
    url = HttpSender([](HttpSender&, int) {}).url("/cam.ts?token=secret");
  }
  EXPECT_THAT(openError(url), AllOf(HasSubstr("/cam.ts: cannot be opened (Connection refused); "),
                                    Not(HasSubstr("secret"))));
}

TEST(NetworkStream, RefusesDataThatIsNoVideo) {
  const std::string page = "<html>" + std::string(100'000, 'x');
  EXPECT_THAT(refusal([&](HttpSender& sender, int) {
                sender.send("HTTP/1.0 200 OK\r\nContent-Length: " + std::to_string(page.size()) +
                            "\r\n\r\n" + page);
              }),
              HasSubstr("delivers no video that can be read"));
  EXPECT_THAT(refusal([&](HttpSender& sender, int) { sender.send(kHttpStart + page); }),
              HasSubstr("cannot be opened (no answer, or no video)"));
  EXPECT_THAT(refusal([](HttpSender& sender, int) { sender.send("HTTP/1.0 404 No\r\n\r\n"); }),
              HasSubstr("cannot be opened (Server returned 404 Not Found)"));
}

TEST(NetworkStream, PlaylistsAndOtherPlacesAreRefused) {
  const SourceFolder folder;
  const std::string file = folder.write("x.ts", "secret");
  const std::string playlist =
      "#EXTM3U\n#EXT-X-TARGETDURATION:2\n#EXTINF:2,\nfile://" + file + "\n";
  const auto send_playlist = [&](HttpSender& sender, int) { sender.send(kHttpStart + playlist); };
  EXPECT_THAT(refusal(send_playlist, 1'000'000, "/cam.m3u8"), HasSubstr("is no single stream"));
  // FFmpeg 7.1 knows a playlist by its name only.
  EXPECT_THAT(refusal(send_playlist),
              AnyOf(HasSubstr("is no single stream"),
                    HasSubstr("cannot be opened (no answer, or no video)")));
  for (const std::string& text :
       {"ffconcat version 1.0\nfile '" + file + "'\n",
        std::string("v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\nm=video 5004 "
                    "RTP/AVP 96\na=rtpmap:96 H264/90000\n")}) {
    EXPECT_THAT(refusal([&](HttpSender& sender, int) { sender.send(kHttpStart + text); }),
                HasSubstr("is no single stream"))
        << text;
  }
  EXPECT_THAT(refusal([&](HttpSender& sender, int) {
                sender.send("HTTP/1.0 302 Found\r\nLocation: file://" + file + "\r\n\r\n");
              }),
              HasSubstr("is no single stream"));
}

TEST(NetworkStream, SilenceAndEndlessHeadersAreGivenUp) {
  EXPECT_THAT(refusal([](HttpSender& sender, int) { sender.hold(); }, 10),
              HasSubstr("cannot be opened (no answer in time)"));
  EXPECT_THAT(refusal(
                  [](HttpSender& sender, int) {
                    sender.send("HTTP/1.0 200 OK\r\n");
                    while (sender.send("X-More: " + std::string(1000, 'x') + "\r\n")) {
                    }
                  },
                  200),
              HasSubstr("cannot be opened (no answer in time)"));
}

class NetworkStreams : public testing::Test {
 protected:
  void SetUp() override {
    if (!isInstalled("ffmpeg")) GTEST_SKIP() << "needs ffmpeg";
  }
  /// Returns a moving picture of 25 frames/s in MPEG-TS. Its frames have about the same size.
  /// `more`: further arguments of ffmpeg.
  [[nodiscard]] std::string video(const std::string& size, int duration_s,
                                  const std::string& more = "") const {
    const std::string file = (folder / "video.ts").string();
    const std::string command = "ffmpeg -loglevel quiet -y -f lavfi -i testsrc=size=" + size +
                                ":rate=25:duration=" + std::to_string(duration_s) + " " + more +
                                " -vf format=gray,format=yuv420p -c:v libx264 -preset ultrafast "
                                "-tune zerolatency -g 1 -pix_fmt yuv420p -f mpegts '" +
                                file + "' </dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0);
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  /// Reads until a frame is there.
  static std::optional<RgbdFrame> next(RgbdSource& source) {
    for (int waits = 0; waits < kLongest_ms / 50; ++waits) {
      if (auto frame = source.read()) return frame;
    }
    ADD_FAILURE() << "no frame";
    return std::nullopt;
  }
  SourceFolder folder;
};

TEST_F(NetworkStreams, ARecordedFileIsRefused) {
  const std::string bytes = video("256x96", 1);
  EXPECT_THAT(refusal([&](HttpSender& sender, int) {
                sender.send("HTTP/1.0 200 OK\r\nContent-Length: " + std::to_string(bytes.size()) +
                            "\r\n\r\n" + bytes);
              }),
              HasSubstr("is a recorded file"));
}

TEST_F(NetworkStreams, OneTrackNeedsALayout) {
  const std::string bytes = video("256x96", 1);
  HttpSender sender([&](HttpSender& to, int) { to.send(kHttpStart + bytes); });
  EXPECT_THAT(openError(sender.url("/cam")),
              AllOf(HasSubstr("/cam: has one video track"), HasSubstr("--layout"),
                    Not(HasSubstr("secret"))));
}

TEST_F(NetworkStreams, FramesComeBackAfterTheEndOfTheStream) {
  const std::string bytes = video("256x96", 4);
  const std::string one_frame = video("256x96", 1, "-frames:v 1");
  HttpSender sender([&](HttpSender& to, int number) {
    if (number == 1) {
      to.send(kHttpStart + one_frame);
      return;
    }
    // The first packets at once, as from a sender that keeps the last key frame.
    if (to.send(kHttpStart + bytes.substr(0, bytes.size() / 2)))
      to.sendSlowly(bytes.substr(bytes.size() / 2), std::chrono::milliseconds(2000));
  });
  const LogLines log;
  const auto source = openNetworkStream(sender.url("/cam.ts?token=secret"), kBeside, 0.0);
  const SourceInfo& info = source->info();
  EXPECT_TRUE(info.live);
  EXPECT_EQ(info.name, "cam.ts");
  EXPECT_EQ(info.width_px, 128);
  EXPECT_EQ(info.height_px, 96);
  EXPECT_EQ(info.fps, 25.0);
  EXPECT_FALSE(info.frame_count);
  EXPECT_THAT(errorOf([&] { source->rewind(); }), HasSubstr("is live"));
  std::optional<RgbdFrame> last;
  while (!last || last->epoch < 2) {
    std::optional<RgbdFrame> frame = next(*source);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->color.size(), cv::Size(128, 96));
    EXPECT_EQ(frame->depth.size(), cv::Size(128, 96));
    EXPECT_GE(frame->age, Duration::zero());
    if (last) {
      EXPECT_GT(frame->index, last->index);
      EXPECT_GE(frame->epoch, last->epoch);
      if (frame->epoch == last->epoch) {
        EXPECT_GE(frame->clip_time_s, last->clip_time_s);
      }
    }
    last = std::move(frame);
  }
  EXPECT_THAT(log.text(),
              AllOf(HasSubstr("no frames from http://127.0.0.1"),
                    HasSubstr("cam.ts: frames are back after "), Not(HasSubstr("secret"))));
}

TEST_F(NetworkStreams, AnotherSizeEndsTheSource) {
  const std::string first = video("256x96", 2);
  const std::string other = video("192x96", 2);
  HttpSender sender([&](HttpSender& to, int number) {
    if (to.send(kHttpStart))
      to.sendSlowly(number == 0 ? first : other, std::chrono::milliseconds(2000));
  });
  const LogLines log;
  const auto source = openNetworkStream(sender.url("/cam"), kBeside, 0.0);
  EXPECT_THAT(errorOf([&] {
                while (next(*source)) {
                }
              }),
              AllOf(HasSubstr("cam: came back with other pictures or depth (96x96), but began "
                              "with 128x96"),
                    Not(HasSubstr("secret"))));
}

TEST_F(NetworkStreams, ASourceEndsWhileItsSenderIsSilent) {
  const std::string bytes = video("256x96", 2);
  HttpSender sender([&](HttpSender& to, int) {
    if (to.send(kHttpStart) && to.sendSlowly(bytes, std::chrono::milliseconds(2000))) to.hold();
  });
  const auto source = openNetworkStream(sender.url("/cam"), kBeside, 0.0);
  EXPECT_TRUE(next(*source));
}

}  // namespace
}  // namespace hapticast::server
