// SPDX-License-Identifier: MIT
// Answers of the programs to bad input: one clear line, the right exit code, no crash.
#include <algorithm>
#include <random>
#include <thread>

#include "tests/integration/programs_fixture.hpp"
#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {
namespace {

using Arguments = std::vector<std::string>;
using Words = std::vector<std::string>;

class ProgramsInputTest : public ProgramsTest {
 protected:
  /// One line on the whole, with these words in it, and this exit code.
  static void expectEnd(Process& process, int exit_code, const Words& words) {
    const auto ended = process.wait(kStart);
    const std::string text = process.output();
    EXPECT_EQ(ended, exit_code) << text;
    EXPECT_EQ(countOccurrences("\n", text), 1U) << text;
    for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << text;
    for (const char c : text) EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20);
    EXPECT_LT(text.size(), 600U) << text;
  }
  static void serverEnds(const Arguments& arguments, int exit_code, const Words& words) {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    expectEnd(*startServer(arguments), exit_code, words);
  }
  static void clientEnds(Arguments arguments, int exit_code, const Words& words) {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    arguments.emplace_back("--quiet");
    expectEnd(*startClient(std::move(arguments)), exit_code, words);
  }
  void setDepth(const std::string& clip, int number, const cv::Mat& depth) const {
    cv::imwrite(clip + "/depth/" + std::to_string(number) + ".png", depth);
  }
};

TEST_F(ProgramsInputTest, FlagsOfTheServer) {
  // Each flag with what it does not take, and what the line says beside flag and value.
  const std::vector<std::array<std::string, 3>> wrong = {
      {"--fps", "abc", "from 1 to 240"},
      {"--fps", "1000", "from 1 to 240"},
      {"--fps", "nan", "from 1 to 240"},
      {"--frames", "0", "from 1 to"},
      {"--frames", "-3", "whole number"},
      {"--frames", "2.5", "whole number"},
      {"--frames", "99999999999999999999999", "whole number"},
      {"--max-clients", "0", "from 1 to 10000"},
      {"--layout", "beside", "separate|side-by-side|top-bottom"},
      {"--depth-code", "red", "grey|hue|inverse"},
      {"--object", "1", "U,V"},
      {"--object", "1,nan", "U,V"},
      {"--object", "1,2@nan", "U,V[@SECONDS]"},
      {"--object", "1,2@soon", "U,V[@SECONDS]"},
      {"--not", "a,b", "U,V"},
      {"--preview", "picture.jpg", "FILE.png or a folder"},
      {"--preview", "", "FILE.png or a folder"},
      {"--segment", "magic", "auto|band|edges|source"},
      {"--depth-range", "5,1", "NEAR,FAR"},
      {"--map-range", "5,1", "NEAR,FAR"},
      {"--fov", "9", "from 10 to 170"},
      {"--fov", "171", "from 10 to 170"},
      {"--fov", "wide", "from 10 to 170"},
      {"--motion", "x", "auto|depth|lk|none"},
      {"--stiffness", "nan", "from 0.01 to 10"},
      {"--mass", "inf", "from 0.001 to 100"},
      {"--method", "x", "hapticast|thesis"},
  };
  for (const auto& [flag, value, allowed] : wrong) {
    serverEnds({"--source", "synthetic:still", flag, value}, 2, {flag, "'" + value + "'", allowed});
  }
  serverEnds({}, 2, {"--source", "required"});
  serverEnds({"--sourc", "synthetic:still"}, 2, {"--sourc"});
  serverEnds({"--source", "synthetic:still", "--bogus"}, 2, {"--bogus"});
  serverEnds({"--source", "synthetic:still", "more"}, 2, {"more"});
  serverEnds({"--source", "synthetic:still", "--loop=maybe"}, 2, {"--loop", "maybe"});
  serverEnds({"--source", "synthetic:still", "--fps", "1", "--fps", "2"}, 2, {"--fps", "once"});
  serverEnds({"--source", "synthetic:still", "--segment", "source", "--source", "x"}, 2, {"once"});
}

TEST_F(ProgramsInputTest, AddressesOfTheServer) {
  const auto listen = [](const std::string& address, int code, const Words& words) {
    SCOPED_TRACE(address);
    expectEnd(*startServer({"--source", "synthetic:still"}, address), code, words);
  };
  listen("127.0.0.1:99999", 2, {"--listen", "127.0.0.1:99999", "65535"});
  listen("", 2, {"--listen"});
  listen("nowhere:80", 2, {"--listen", "nowhere", "0.0.0.0 means all"});
  listen("192.0.2.1:7447", 1, {"192.0.2.1:7447", "this machine has no such address"});
  const auto first = startServer({"--source", makeClip("clip"), "--loop"});
  const std::string used = addressOf(*first);
  listen(used, 1, {used, "in use", "--listen"});
  interrupt(*first);
}

TEST_F(ProgramsInputTest, AServerListensAtItsAddress) {
  const std::string clip = makeClip("clip");
  const std::vector<std::pair<std::string, std::string>> forms = {
      {":0", "0.0.0.0:"}, {"0", "0.0.0.0:"}, {"localhost:0", "localhost:"}};
  for (const auto& [given, expected] : forms) {
    const auto server = startServer({"--source", clip, "--loop"}, given);
    const std::string address = addressOf(*server);
    EXPECT_TRUE(address.starts_with(expected)) << address;
    const auto client = startClient({address.substr(address.rfind(':') + 1)});
    EXPECT_TRUE(client->says("connected: ", kSoon)) << client->output();
    interrupt(*client);
    interrupt(*server);
  }
}

TEST_F(ProgramsInputTest, FlagsOfTheClient) {
  const std::vector<std::array<std::string, 3>> wrong = {
      {"--seconds", "0", "from 0.001"},       {"--seconds", "nan", "from 0.001"},
      {"--surface", "x", "normal|perturbed"}, {"--transport", "upd", "tcp|udp"},
      {"--method", "x", "hapticast|thesis"},
  };
  for (const auto& [flag, value, allowed] : wrong)
    clientEnds({flag, value}, 2, {flag, "'" + value + "'", allowed});
  clientEnds({"bad host"}, 2, {"'bad host'", "HOST[:PORT]"});
  clientEnds({"127.0.0.1:99999"}, 2, {"127.0.0.1:99999", "65535"});
  clientEnds({"a", "b"}, 2, {"b"});
  clientEnds({"--bogus"}, 2, {"--bogus"});
  expectEnd(*start(HAPTICAST_CLIENT_PROGRAM, {"--device", "spoon"}), 2,
            {"--device", "'spoon'", "|mouse|", "|virtual"});
  clientEnds({"--fault-dir", write("file", "") + "/below"}, 2, {"--fault-dir", "file/below"});
  for (const char* flag : {"--log", "--summary", "--screenshot"})
    clientEnds({flag, path("missing/file.png")}, 2, {flag, "missing/file.png", "folder"});
  clientEnds({"--film", path("missing/film.mp4")}, 2, {"--film", "missing/film.mp4", "folder"});
  clientEnds({"--screenshot", path("picture.xyz")}, 2, {"--screenshot", "picture.xyz", ".png"});
  EXPECT_FALSE(std::filesystem::exists(path("picture.xyz")));
  clientEnds({"--film", path("film.xyz")}, 2, {"--film", "film.xyz", ".mp4"});
  EXPECT_FALSE(std::filesystem::exists(path("film.xyz")));
}

TEST_F(ProgramsInputTest, ConfigFiles) {
  const auto config = [this](const std::string& text, const Words& words) {
    Words all = words;
    all.emplace_back("--config");
    SCOPED_TRACE(text);
    serverEnds({"--source", "synthetic:still", "--config", write("file.cfg", text)}, 2, all);
  };
  config("bogus = 3\n", {"file.cfg", "'bogus'"});
  config("nonsense\n", {"file.cfg", "'nonsense'"});
  config("[section]\nfps = 3\n", {"file.cfg", "section"});
  config("\x01\x1b[2J\x7f\n", {"file.cfg"});
  serverEnds({"--source", "synthetic:still", "--config", write("a.cfg", "fps = abc\n")}, 2,
             {"--fps", "'abc'", "from 1 to 240"});
  serverEnds({"--source", "synthetic:still", "--config", path("none.cfg")}, 2,
             {"--config", "none.cfg", "cannot be read"});
  serverEnds({"--source", "synthetic:still", "--config", path("")}, 2, {"--config"});
  clientEnds({"--config", write("c.cfg", "fps = 3\n")}, 2, {"--config", "c.cfg", "'fps'"});
}

TEST_F(ProgramsInputTest, FilesOfTheClient) {
  const auto file = [this](const char* flag, const std::string& text, const Words& words) {
    Words all = words;
    all.insert(all.end(), {flag, "file.txt"});
    SCOPED_TRACE(text);
    clientEnds({flag, write("file.txt", text)}, 2, all);
  };
  file("--profile", "mass_kg = -1\n", {":1", "mass_kg", "0.001"});
  file("--profile", "name = a\nbogus = 1\n", {":2", "bogus", "allowed"});
  file("--profile", "continuous_N = 5\n", {"continuous_N", "peak_N"});
  file("--profile", "\x1b[2J\x01\r\x02\n", {"is not a text file"});
  file("--hand", "0,0,0\n", {":1", "t_s,x_mm,y_mm,z_mm"});
  file("--hand", "0,0,0,1\n0,1,1,1\n", {":2", "rise"});
  file("--hand", "0,0,0,nan\n", {":1"});
  file("--hand", "t_s,x_mm,y_mm,z_mm\n", {"no rows"});
  file("--hand", std::string(1000, '1') + "\n", {":1", "256"});
  for (const char* flag : {"--profile", "--hand"}) {
    clientEnds({flag, path("none")}, 2, {flag, "none", "cannot be read", "allowed"});
    clientEnds({flag, path("")}, 2, {flag, "cannot be read"});
  }
}

TEST_F(ProgramsInputTest, ServersThatAreNotThere) {
  clientEnds({"no-such-host.invalid"}, 1, {"no-such-host.invalid:7447", "no host of this name"});
  const auto never = startClient({"127.0.0.1:1", "--seconds", "1.5", "--quiet"});
  EXPECT_EQ(never->wait(kSoon), 1);
  EXPECT_EQ(
      countOccurrences("waiting for a server at 127.0.0.1:1 (connection refused)", never->output()),
      1U)
      << never->output();
  EXPECT_EQ(countOccurrences("no server answered at 127.0.0.1:1 within 1.5 s (connection refused)",
                             never->output()),
            1U)
      << never->output();
  EXPECT_EQ(countOccurrences("\n", never->output()), 2U) << never->output();
}

TEST_F(ProgramsInputTest, AClientThatWaitsIsEndedBySignals) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const auto client = startClient({"127.0.0.1:1"});
    ASSERT_TRUE(client->says("waiting for a server", kSoon)) << client->output();
    interrupt(*client, signal);
  }
}

TEST_F(ProgramsInputTest, ClipsThatDoNotFit) {
  serverEnds({"--source", path("missing")}, 2, {"missing", "no such"});
  serverEnds({"--source", path("")}, 2, {"is empty", "rgb/", "depth/"});
  serverEnds({"--source", "synthetic:foo"}, 2, {"synthetic:foo", "bounce"});
  serverEnds({"--source", "camera:0"}, 2, {"camera:0", "depth"});

  std::string clip = makeClip("size");
  setDepth(clip, 100, cv::Mat(64, 64, CV_16UC1, cv::Scalar(900)));
  serverEnds({"--source", clip}, 2, {"depth/100.png", "64x64", "128x96"});
  clip = makeClip("count");
  std::filesystem::remove(clip + "/depth/103.png");
  for (const int i : {100, 101, 102, 104, 105}) {  // no numbers to pair them by
    const std::string folder = clip + "/depth/";
    std::filesystem::rename(folder + std::to_string(i) + ".png",
                            folder + static_cast<char>('a' + i - 100) + ".png");
  }
  serverEnds({"--source", clip}, 2, {"count/depth", "5 images", "6"});
  clip = makeClip("bits");
  setDepth(clip, 100, cv::Mat(96, 128, CV_8UC1, cv::Scalar(90)));
  write("bits/meta.json", "{\"depth_bits\": 16}");
  serverEnds({"--source", clip}, 2, {"depth/100.png", "8 bits", "16"});
  write("bits/meta.json", "{\"fps\": ");
  serverEnds({"--source", clip}, 2, {"meta.json", "JSON"});

  clip = makeClip("object");
  serverEnds({"--source", clip, "--object", "128,3"}, 2, {"--object 128,3", "128x96"});
  std::filesystem::remove_all(clip + "/mask");
  cv::Mat hole(96, 128, CV_16UC1, cv::Scalar(0));
  cv::circle(hole, {60, 48}, 24, cv::Scalar(900), cv::FILLED);
  for (int i = 100; i < 106; ++i) setDepth(clip, i, hole);
  serverEnds({"--source", clip, "--object", "3,3"}, 2, {"--object 3,3", "there is no depth"});
  serverEnds({"--source", clip, "--segment", "source"}, 2, {"--segment source", "no mask"});
}

TEST_F(ProgramsInputTest, AClipWithNothingToTouchIsReported) {
  const std::string clip = makeClip("clip");
  std::filesystem::remove_all(clip + "/mask");
  const auto warning = [&](const cv::Mat& depth) {
    for (int i = 100; i < 106; ++i) setDepth(clip, i, depth);
    const auto server = startServer({"--source", clip, "--frames", "2", "--quiet"});
    EXPECT_EQ(server->wait(kStart), 0) << server->output();
    EXPECT_EQ(countOccurrences("\n", server->output()), 1U) << server->output();
    return server->output();
  };
  cv::Mat depth = cv::Mat::zeros(96, 128, CV_16UC1);
  EXPECT_NE(warning(depth).find("depth is 0 in every pixel"), std::string::npos);
  depth.setTo(2000);
  depth.at<std::uint16_t>(90, 120) = 2001;
  EXPECT_NE(warning(depth).find("no object was found, so there is nothing to touch"),
            std::string::npos);
}

TEST_F(ProgramsInputTest, FramesThatCannotBeReadAreLeftOut) {
  const std::string clip = makeClip("clip");
  write("clip/depth/102.png", "this is no picture");
  setDepth(clip, 104, cv::Mat(48, 64, CV_16UC1, cv::Scalar(900)));
  const auto server = startServer({"--source", clip, "--loop", "--frames", "20", "--quiet"});
  EXPECT_EQ(server->wait(kStart), 0) << server->output();
  const std::string text = server->output();
  EXPECT_EQ(countOccurrences("depth/102.png: is not a whole PNG, JPEG, TIFF, EXR, PGM or NPY image",
                             text),
            1U)
      << text;
  EXPECT_EQ(countOccurrences("depth/104.png: is 64x48", text), 1U) << text;
  EXPECT_EQ(countOccurrences("left out", text), 2U) << text;
}

TEST_F(ProgramsInputTest, AServerThatSkipsFramesStillStartsEachRoundWithTheFirst) {
  const std::string clip = makeClip("clip", 8);
  std::filesystem::remove_all(clip + "/mask");
  for (int i = 100; i < 108; ++i) {  // the point named holds for the first only
    cv::Mat depth(96, 128, CV_16UC1, cv::Scalar(0));
    cv::circle(depth, {i == 100 ? 30 : 95, 48}, 16, cv::Scalar(900), cv::FILLED);
    setDepth(clip, i, depth);
  }
  const auto server = startServer({"--source", clip, "--object", "30,48", "--loop"});
  (void)addressOf(*server);
  // Stopped for some frames again and again, at any place of the clip: what is due is skipped.
  for (int i = 0; i < 12 && server->running(); ++i) {
    server->signal(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(130));
    server->signal(SIGCONT);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_TRUE(server->running()) << server->output();
  EXPECT_TRUE(server->says("frames skipped", kSoon)) << server->output();
  interrupt(*server);
}

TEST_F(ProgramsInputTest, PeersThatMisbehaveDoNotDisturbAViewer) {
  const auto server = startServer({"--source", makeClip("clip"), "--loop"});
  const std::string address = addressOf(*server);
  const auto port = static_cast<std::uint16_t>(std::stoi(address.substr(address.find(':') + 1)));
  asio::io_context io;
  RawPeer viewer(io, port);
  viewer.send(Hello{kProtocolVersion, "well-behaved", false, true});
  const auto frames = [&] {
    viewer.poll();
    return viewer.all<CodedFrame>();
  };
  // What peers get that send these bytes, at once: an error, and the end of the connection.
  const auto farewells = [&](const std::vector<std::vector<std::uint8_t>>& sent) {
    std::vector<std::unique_ptr<RawPeer>> peers;
    for (const auto& bytes : sent) {
      peers.push_back(std::make_unique<RawPeer>(io, port));
      if (!bytes.empty()) peers.back()->send(bytes);
    }
    EXPECT_TRUE(waitUntil(kSoon, [&] {
      viewer.send(Ping{localTime(1.0)});
      (void)frames();
      for (const auto& peer : peers) peer->poll();
      return std::all_of(peers.begin(), peers.end(), [](const auto& each) { return each->closed; });
    }));
    std::vector<WireError> answers;
    for (const auto& peer : peers) {
      EXPECT_FALSE(peer->reset) << "the error could have been lost";
      const auto errors = peer->all<WireError>();
      answers.push_back(
          errors.size() == 1 ? errors[0] : WireError{ErrorCode::kShuttingDown, "no single error"});
    }
    return answers;
  };
  std::mt19937 random(7);
  std::vector<std::uint8_t> noise(100'000);
  for (auto& byte : noise) byte = static_cast<std::uint8_t>(random() | 1U);
  const std::vector<std::uint8_t> short_noise(noise.begin(), noise.begin() + 500);
  const auto answers = farewells({framed(encode(Hello{kProtocolVersion + 1, "new\n", false, true})),
                                  noise,
                                  framed(short_noise),
                                  {0x01, 0x00, 0x01, 0x00},
                                  {},
                                  {0x10, 0x00}});
  EXPECT_EQ(answers[0].code, ErrorCode::kVersion);
  EXPECT_NE(answers[0].message.find("version"), std::string::npos);
  EXPECT_EQ(answers[1].code, ErrorCode::kTooLarge) << "random bytes";
  EXPECT_EQ(answers[2].code, ErrorCode::kMalformed) << "random bytes as a message";
  EXPECT_EQ(answers[3].code, ErrorCode::kTooLarge) << "64 KiB + 1";
  EXPECT_EQ(answers[4].code, ErrorCode::kTimeout) << "half-open";
  EXPECT_EQ(answers[5].code, ErrorCode::kTimeout) << "half a message";

  const std::size_t before = frames().size();
  EXPECT_TRUE(waitUntil(kSoon, [&] { return frames().size() > before + 10; }));
  const auto all = frames();
  for (std::size_t i = 1; i < all.size(); ++i) ASSERT_EQ(all[i].id, all[i - 1].id + 1);
  EXPECT_FALSE(viewer.closed);
  const std::string text = server->output();
  EXPECT_EQ(countOccurrences("closing 127.0.0.1", text), 6U) << text;
  for (const char* reason : {"protocol version", "are allowed here", "no hello arrived in time"})
    EXPECT_NE(text.find(reason), std::string::npos) << text;
  interrupt(*server);
}

TEST_F(ProgramsInputTest, HelpAndVersionOfBoth) {
  for (const char* program : {HAPTICAST_SERVER_PROGRAM, HAPTICAST_CLIENT_PROGRAM}) {
    const auto help = start(program, {"--help"});
    EXPECT_EQ(help->wait(kSoon), 0);
    for (const char* flag : {"--method", "--config", "--quiet", "--version"})
      EXPECT_NE(help->output().find(flag), std::string::npos) << help->output();
    EXPECT_EQ(start(program, {"--version"})->wait(kSoon), 0);
  }
}

}  // namespace
}  // namespace hapticast::testing
