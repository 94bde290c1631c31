// SPDX-License-Identifier: MIT
// The page on the port of the viewers: its files, and the answer to each kind of request.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/page/page_files.hpp"
#include "server/page/page_link.hpp"
#include "server/page/page_responder.hpp"
#include "server/page/websocket_handshake.hpp"

namespace hapticast::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::vector<std::uint8_t> gzip(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::vector<std::uint8_t> out(deflateBound(&stream, static_cast<uLong>(text.size())));
  std::string in = text;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

struct PageTest : ::testing::Test {
  const std::string html = "<!doctype html><title>a</title>" + std::string(100'000, ' ');
  const std::vector<std::uint8_t> gzipped_html = gzip(html), gzipped_core = gzip("core");
  const std::vector<PageFile> files{
      {"index.html", "text/html; charset=utf-8", gzipped_html, "\"0011\""},
      {"core.wasm", "application/wasm", gzipped_core, "\"0022\""}};
  PageResponder page{{"localhost", "lab"}, files};

  HttpAnswer ask(const std::string& head, bool encrypted = false) {
    return page.respond(head, encrypted);
  }
  HttpAnswer get(const std::string& path, const std::string& fields = "",
                 const std::string& host = "lab:7447") {
    return ask("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n" + fields + "\r\n");
  }
  static std::string body(const HttpAnswer& answer) {
    return {answer.body.begin(), answer.body.end()};
  }
  static int status(const HttpAnswer& answer) { return std::stoi(answer.head.substr(9, 3)); }
  /// A whole answer: its length is that of its body, and the connection ends.
  static void expectWhole(const HttpAnswer& answer) {
    EXPECT_THAT(answer.head, StartsWith("HTTP/1.1 "));
    EXPECT_TRUE(answer.head.ends_with("\r\n\r\n"));
    const std::string length = "\r\nContent-Length: " + std::to_string(answer.body.size()) + "\r\n";
    EXPECT_EQ(answer.head.find(length) != std::string::npos, status(answer) != 304) << answer.head;
    EXPECT_THAT(answer.head, HasSubstr("\r\nConnection: close\r\n"));
    EXPECT_FALSE(answer.is_websocket);
  }
};

struct HandshakeTest : PageTest {
  struct Fields {
    std::string host = "192.0.2.7:7447";
    std::string origin = "http://192.0.2.7:7447";
    std::string key = "dGhlIHNhbXBsZSBub25jZQ==";
    std::string version = "13";
    std::string protocol = "hapticast.3";
    std::string more{};
  };
  HttpAnswer open(const Fields& fields, bool encrypted = false) {
    return ask("GET /stream HTTP/1.1\r\nHost: " + fields.host +
                   "\r\nConnection: keep-alive, Upgrade\r\nUpgrade: WebSocket\r\n" +
                   field("Origin", fields.origin) + field("Sec-WebSocket-Key", fields.key) +
                   field("Sec-WebSocket-Version", fields.version) +
                   field("Sec-WebSocket-Protocol", fields.protocol) + fields.more + "\r\n",
               encrypted);
  }
  static std::string field(const std::string& name, const std::string& value) {
    return value.empty() ? "" : name + ": " + value + "\r\n";
  }
  static Fields with(std::string Fields::*field, const std::string& value) {
    Fields fields;
    fields.*field = value;
    return fields;
  }
};

TEST_F(PageTest, SendsAFileCompressedOrNot) {
  const HttpAnswer zipped = get("/", "Accept-Encoding: br;q=1.0, gzip\r\n");
  expectWhole(zipped);
  EXPECT_EQ(status(zipped), 200);
  EXPECT_THAT(zipped.head, HasSubstr("\r\nContent-Encoding: gzip\r\n"));
  EXPECT_THAT(zipped.head, HasSubstr("\r\nContent-Type: text/html; charset=utf-8\r\n"));
  EXPECT_EQ(zipped.body.data(), gzipped_html.data()) << "its bytes are not copied";
  EXPECT_EQ(zipped.problem, "") << "no line of the log";
  for (const std::string accepted :
       {"", "Accept-Encoding: br\r\n", "Accept-Encoding: gzip;q=0\r\n",
        "Accept-Encoding: gzip;q=0.000, deflate\r\n", "Accept-Encoding: xgzip\r\n"}) {
    const HttpAnswer plain = get("/index.html", accepted);
    expectWhole(plain);
    EXPECT_THAT(plain.head, Not(HasSubstr("Content-Encoding"))) << accepted;
    EXPECT_EQ(body(plain), html) << accepted;
  }
  EXPECT_THAT(get("/core.wasm", "Accept-Encoding: GZIP;q=0.5\r\n").head,
              HasSubstr("\r\nContent-Encoding: gzip\r\n"));
}

TEST_F(PageTest, SendsAnUnchangedFileOnce) {
  const HttpAnswer first = get("/");
  EXPECT_THAT(first.head, HasSubstr("\r\nETag: W/\"0011\"\r\nCache-Control: no-cache\r\n"));
  for (const std::string known : {"W/\"0011\"", "\"0011\"", "\"1\", W/\"0011\"", "*"}) {
    const HttpAnswer again = get("/", "If-None-Match: " + known + "\r\n");
    expectWhole(again);
    EXPECT_EQ(status(again), 304) << known;
    EXPECT_EQ(again.body.size(), 0U);
  }
  EXPECT_EQ(status(get("/", "If-None-Match: W/\"0012\"\r\n")), 200);
}

TEST_F(PageTest, EachAnswerForbidsContentOfOthers) {
  for (const HttpAnswer& answer : {get("/"), get("/nothing"), get("/", "", "evil.example"),
                                   get("/", "If-None-Match: *\r\n"), ask("GET \r\n\r\n")}) {
    EXPECT_THAT(answer.head, HasSubstr("\r\nContent-Security-Policy: default-src 'none'; "));
    EXPECT_THAT(answer.head, Not(HasSubstr("unsafe-inline")));
    EXPECT_THAT(answer.head, HasSubstr("\r\nX-Content-Type-Options: nosniff\r\n"));
    EXPECT_THAT(answer.head, HasSubstr("\r\nReferrer-Policy: no-referrer\r\n"));
    EXPECT_THAT(answer.head, HasSubstr("\r\nCross-Origin-Opener-Policy: same-origin\r\n"));
    EXPECT_THAT(answer.head, Not(HasSubstr("Set-Cookie")));
  }
}

TEST_F(PageTest, HasNoOtherFiles) {
  for (const std::string path :
       {"/../etc/passwd", "/..", "//index.html", "/./index.html", "/index.html/", "/INDEX.HTML",
        "/%69ndex.html", "/..%2findex.html", "/\\index.html", "/core.wasm%00.html", "/stream/", "*",
        "/etc/passwd", "/index.html;a"}) {
    const HttpAnswer answer = get(path);
    expectWhole(answer);
    EXPECT_EQ(status(answer), 404) << path;
    EXPECT_THAT(answer.problem, StartsWith("HTTP 404: there is no file ")) << path;
  }
  EXPECT_EQ(status(get("/index.html?a=../b")), 200) << "a query has no meaning";
  EXPECT_EQ(get("/favicon.ico").problem, "") << "each browser asks for it";
  EXPECT_EQ(status(get("/favicon.ico")), 404);
}

TEST_F(PageTest, IsOnlyForRequestsToANameOfThisServer) {
  for (const std::string host : {"lab", "LAB:7447", "localhost", "192.0.2.7", "[2001:db8::1]:7447"})
    EXPECT_EQ(status(get("/", "", host)), 200) << host;
  for (const std::string host : {"evil.example", "lab.evil.example", "", "lab:a", "lab@evil"}) {
    for (const std::string path : {"/", "/core.wasm", "/stream", "/nothing"}) {
      const HttpAnswer answer = get(path, "", host);
      EXPECT_EQ(status(answer), 403) << host << path;
      EXPECT_THAT(body(answer), HasSubstr("--host-name"));
    }
  }
}

TEST_F(PageTest, RefusesBytesThatAreNoRequest) {
  for (const std::string wrong :
       {"GET / HTTP/1.1\r\n\r\n", "GET / HTTP/1.0\r\n\r\n", "GET / HTTP/2.0\r\nHost: lab\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: lab\r\nHost: lab\r\n\r\n", "GET \r\n\r\n", "GET / \r\n\r\n",
        "GET / HTTP/1.1\r\nHost lab\r\n\r\n", "GET / HTTP/1.1\r\nHost: lab\r\nA: \x01\r\n\r\n",
        "GET / HTTP/1.1\nHost: lab\n\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: lab\r\nContent-Length: 1\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: lab\r\nTransfer-Encoding: chunked\r\n\r\n"}) {
    const HttpAnswer answer = ask(wrong);
    expectWhole(answer);
    EXPECT_EQ(status(answer), 400) << wrong;
    EXPECT_THAT(answer.problem, StartsWith("HTTP 400: "));
  }
  EXPECT_EQ(status(ask("GET /" + std::string(HttpHead::kMostBytes, 'a'))), 431);
  EXPECT_EQ(status(ask("GET / HTTP/1.1\r\nHost: lab\r\nA: " +
                       std::string(HttpHead::kMostBytes, 'a') + "\r\n\r\n")),
            431);
}

TEST_F(PageTest, AnswersHeadAsGetWithoutABodyAndRefusesOtherMethods) {
  for (const std::string path : {"/", "/core.wasm", "/nothing", "/stream"}) {
    const std::string rest = path + " HTTP/1.1\r\nHost: lab\r\n\r\n";
    const HttpAnswer head = ask("HEAD " + rest), whole = ask("GET " + rest);
    EXPECT_EQ(head.head, whole.head) << path;
    EXPECT_EQ(body(head), "");
  }
  for (const std::string method : {"POST", "PUT", "DELETE", "OPTIONS", "get", "BREW"}) {
    const HttpAnswer answer = ask(method + " / HTTP/1.1\r\nHost: lab\r\n\r\n");
    expectWhole(answer);
    EXPECT_EQ(status(answer), 405) << method;
    EXPECT_THAT(answer.head, HasSubstr("Allow: GET, HEAD\r\n"));
  }
}

TEST_F(PageTest, NamesThePackagesThatABuildWithoutTheCoreLacks) {
  PageResponder without({"lab"}, std::span(files).first(1));
  const HttpAnswer answer = without.respond("GET / HTTP/1.1\r\nHost: lab\r\n\r\n", false);
  expectWhole(answer);
  EXPECT_EQ(status(answer), 503);
  EXPECT_THAT(body(answer), HasSubstr("libc++-dev-wasm32"));
}

TEST_F(HandshakeTest, AnswersTheExampleOfRfc6455) {
  EXPECT_EQ(acceptWebSocketKey("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
  const HttpAnswer answer = open({});
  EXPECT_TRUE(answer.is_websocket);
  EXPECT_EQ(answer.problem, "");
  EXPECT_EQ(answer.head,
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"
            "Sec-WebSocket-Protocol: hapticast.3\r\n\r\n");
  EXPECT_FALSE(answer.for_this_machine);
}

TEST_F(HandshakeTest, NegotiatesNoCompression) {
  const HttpAnswer answer =
      open(with(&Fields::more, "Sec-WebSocket-Extensions: permessage-deflate; server_max\r\n"));
  EXPECT_TRUE(answer.is_websocket);
  EXPECT_THAT(answer.head, Not(HasSubstr("Extensions")));
}

TEST_F(HandshakeTest, IsOnlyForPagesOfThisServer) {
  for (const std::string origin :
       {"", "null", "http://evil.example", "https://192.0.2.7:7447", "http://192.0.2.7",
        "http://192.0.2.7:7447/", "http://192.0.2.7:7447@evil.example", "192.0.2.7:7447",
        "http://192.0.2.7:7448", "file://"}) {
    const HttpAnswer answer = open(with(&Fields::origin, origin));
    expectWhole(answer);
    EXPECT_EQ(status(answer), 403) << origin;
    EXPECT_THAT(answer.problem, StartsWith("HTTP 403: ")) << origin;
  }
  EXPECT_EQ(status(open(with(&Fields::more, "Origin: http://192.0.2.7:7447\r\n"))), 403) << "twice";
  EXPECT_EQ(status(open({}, true)), 403) << "a page by http, the stream by https";
  EXPECT_TRUE(open(with(&Fields::origin, "https://192.0.2.7:7447"), true).is_websocket);
  EXPECT_EQ(status(open({.host = "evil.example", .origin = "http://evil.example"})), 403);
}

TEST_F(HandshakeTest, KnowsARequestToThisMachine) {
  for (const std::string host : {"localhost:7447", "127.0.0.1", "[::1]:7447", "127.1.2.3:1"})
    EXPECT_TRUE(open({.host = host, .origin = "http://" + host}).for_this_machine) << host;
  for (const std::string host : {"lab", "192.0.2.7", "[2001:db8::1]"}) {
    const HttpAnswer answer = open({.host = host, .origin = "http://" + host});
    EXPECT_TRUE(answer.is_websocket && !answer.for_this_machine) << host;
  }
}

TEST_F(HandshakeTest, RefusesOtherVersionsAndWrongKeys) {
  for (const std::string version : {"", "8", "14", "13, 8"}) {
    const HttpAnswer answer = open(with(&Fields::version, version));
    expectWhole(answer);
    EXPECT_EQ(status(answer), 426) << version;
    EXPECT_THAT(answer.head, HasSubstr("\r\nSec-WebSocket-Version: 13\r\n"));
  }
  for (const std::string key : {"", "abc", "dGhlIHNhbXBsZSBub25jZQ=", "dGhlIHNhbXBsZSBub25jZ!==",
                                "dGhlIHNhbXBsZSBub25jZWE=="})
    EXPECT_EQ(status(open(with(&Fields::key, key))), 400) << key;
  EXPECT_EQ(status(get("/stream")), 426);
  const HttpAnswer other = open(with(&Fields::protocol, "hapticast.4, hapticast.44"));
  EXPECT_EQ(status(other), 400);
  EXPECT_EQ(body(other),
            "This server speaks hapticast.3, the page hapticast.4, hapticast.44: load the page "
            "again.\n");
  EXPECT_EQ(status(open(with(&Fields::protocol, ""))), 400);
  EXPECT_TRUE(open(with(&Fields::protocol, "hapticast.4, hapticast.3")).is_websocket);
}

TEST(PageFiles, AreThoseOfTheFolder) {
  for (const PageFile& file : listPageFiles()) {
    EXPECT_EQ(findPageFile("/" + std::string(file.name)), &file);
    EXPECT_EQ(file.content_type.starts_with("text/"),
              file.content_type.ends_with("; charset=utf-8"))
        << file.name;
    const std::filesystem::path source =
        std::filesystem::path(HAPTICAST_TESTS) / "../client/web/page" / file.name;
    const auto content = inflate(file);
    EXPECT_FALSE(content.empty()) << file.name;
    if (!std::filesystem::exists(source)) continue;  // the build has made it
    std::ifstream in(source, std::ios::binary);
    const std::vector<std::uint8_t> expected{std::istreambuf_iterator<char>(in), {}};
    EXPECT_EQ(content, expected) << file.name;
  }
}

TEST(PageLink, HasAnAddressThatOthersReach) {
  const auto interfaces = [](const std::vector<std::string>& addresses) {
    std::vector<NetworkInterface> all;
    all.reserve(addresses.size() + 1);
    for (const std::string& each : addresses)
      all.push_back({"eth0", 2, asio::ip::make_address(each), false});
    all.push_back({"lo", 1, asio::ip::make_address("127.0.0.1"), true});
    return all;
  };
  const asio::ip::tcp::endpoint all(asio::ip::address_v6::any(), 7447);
  EXPECT_EQ(makePageLink(all, false, interfaces({"fe80::1", "169.254.1.1", "192.0.2.7"})),
            "http://192.0.2.7:7447/");
  EXPECT_EQ(makePageLink(all, true, interfaces({"fe80::1", "2001:db8::1"})),
            "https://[2001:db8::1]:7447/");
  EXPECT_EQ(makePageLink(all, false, interfaces({"fe80::1"})), "http://localhost:7447/");
  EXPECT_EQ(makePageLink({asio::ip::address_v4::any(), 80}, false, interfaces({"2001:db8::1"})),
            "http://localhost:80/");
  EXPECT_EQ(makePageLink({asio::ip::make_address("127.0.0.1"), 7447}, false, {}),
            "http://127.0.0.1:7447/");
}

}  // namespace
}  // namespace hapticast::server
