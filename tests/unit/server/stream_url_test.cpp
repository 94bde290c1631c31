// SPDX-License-Identifier: MIT
// The visible part of a stream's address.
#include "server/source/stream_url.hpp"

#include <gtest/gtest.h>

namespace hapticast::server {
namespace {

TEST(StreamUrl, SchemesOfStreams) {
  for (const char* spec : {"rtsp://h/1", "rtsps://h", "srt://h:1", "http://h/a", "https://h/a",
                           "udp://@239.1.1.1:5", "tcp://h:1", "rtp://h:2", "RTSP://h/1"})
    EXPECT_TRUE(isStreamUrl(spec)) << spec;
  for (const char* spec : {"ftp://h/1", "file:///etc/passwd", "concat:a|b", "://h", "clip", "",
                           "synthetic:still", "nats://h/c", "a b://c", "rtsp:/h"})
    EXPECT_FALSE(isStreamUrl(spec)) << spec;
}

TEST(StreamUrl, SecretsAreHidden) {
  EXPECT_EQ(hideCredentials("rtsp://me:pass@host:554/cam/1"), "rtsp://host:554/cam/1");
  EXPECT_EQ(hideCredentials("srt://host:9000?passphrase=secret&mode=caller"), "srt://host:9000");
  EXPECT_EQ(hideCredentials("https://host/a.ts?token=secret#secret"), "https://host/a.ts");
  EXPECT_EQ(hideCredentials("ftp://me:pass@host/a"), "ftp://host/a");
  EXPECT_EQ(hideCredentials("udp://@239.1.1.1:5"), "udp://239.1.1.1:5");
  EXPECT_EQ(hideCredentials("my_clip@home?x"), "my_clip@home?x") << "a file";
}

TEST(StreamUrl, SecretsThatAreWrittenWronglyAreHiddenToo) {
  for (const char* spec :
       {"rtsp://me:sec/ret@host/cam", "rtsp://me:sec?ret@host/cam", "rtsp://me:sec#ret@host/cam",
        "rtsp://me:sec@ret@host/cam", "rtsp://me:s@ec/ret@host", "srt://host?passphrase=sec@ret",
        "http://h/a,http://me:secret@h/b"}) {
    const std::string shown = hideCredentials(spec);
    EXPECT_EQ(shown.find("sec"), std::string::npos) << shown;
    EXPECT_EQ(shown.find("ret"), std::string::npos) << shown;
    EXPECT_EQ(streamName(spec).find("ret"), std::string::npos) << shown;
  }
}

TEST(StreamUrl, AnAddressWithoutItsSlashesShowsNoSecret) {
  EXPECT_EQ(hideCredentials("rtsps:/me:secret@host/cam"), "rtsps:...");
  EXPECT_EQ(hideCredentials("folder/a:/b"), "folder/a:/b");
}

TEST(StreamUrl, NamesForViewers) {
  EXPECT_EQ(streamName("rtsp://me:pass@host:554/cam/hands?x=y"), "hands");
  EXPECT_EQ(streamName("rtsp://host/cam/"), "cam");
  EXPECT_EQ(streamName("srt://me:pass@host:9000"), "host:9000");
  EXPECT_EQ(streamName("udp://"), "udp");
  EXPECT_EQ(streamName("http://h/" + std::string(5000, 'x')).size(), 256U);
}

}  // namespace
}  // namespace hapticast::server
