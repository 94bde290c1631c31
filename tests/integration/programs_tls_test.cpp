// SPDX-License-Identifier: MIT
// TLS and access tokens, by the real programs and by openssl: certificates that are right, wrong,
// expired or of another host; keys that change; tokens that are valid, expired, unknown or missing.
#include <cstdlib>

#include "common/transport/network_interfaces.hpp"
#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

class ProgramsTlsTest : public ProgramsTest {
 protected:
  [[nodiscard]] std::unique_ptr<Process> startTlsServer(
      std::vector<std::string> flags, const std::string& address = "127.0.0.1:0") {
    flags.insert(flags.begin(), {"--source", "synthetic:still", "--loop"});
    return startServer(flags, address);
  }
  static std::unique_ptr<Process> startViewer(const std::string& address,
                                              std::vector<std::string> flags = {}) {
    flags.insert(flags.begin(), {address, "--device", "virtual", "--view", "off"});
    return startClient(flags);
  }
  /// Expects a client that ends with one error line that has `why`.
  static void expectRefusal(Process& viewer, const std::string& why) {
    EXPECT_EQ(viewer.wait(kSoon), 1) << viewer.output();
    EXPECT_NE(viewer.output().find(why), std::string::npos) << viewer.output();
  }
  void run(const std::string& command) const {
    const std::string line = "cd " + path("") + " && " + command + " > openssl.log 2>&1";
    ASSERT_EQ(std::system(line.c_str()), 0) << command;  // NOLINT(cert-env33-c): a test's command
  }
  /// Makes an authority (ca.pem) and a certificate NAME.pem with NAME.key for `names`.
  void makeCertificate(const std::string& name, const std::string& names, int days) const {
    const std::string key = "-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout ";
    if (!std::filesystem::exists(path("ca.pem")))
      run("openssl req -x509 " + key + "ca.key -out ca.pem -subj /CN=authority -days 10");
    write(name + ".ext", "subjectAltName=" + names);
    run("openssl req " + key + name + ".key -out " + name + ".csr -subj /CN=server");
    const std::string sign = "openssl x509 -req -in " + name +
                             ".csr -CA ca.pem -CAkey ca.key -CAcreateserial -extfile " + name +
                             ".ext -out " + name + ".pem -days " + std::to_string(days);
    // OpenSSL 3.4 and later refuse negative days, and know -not_after.
    const std::string past = " -not_before 20200101000000Z -not_after 20200102000000Z";
    run(days < 0 ? "{ " + sign + " || " + sign.substr(0, sign.find(" -days")) + past + "; }"
                 : sign);
  }
  [[nodiscard]] std::string makeToken(const std::string& name, const std::string& grant) {
    write(name, "token of " + name + "\n");
    run("printf '%s %s\\n' $(printf %s 'token of " + name + "' | sha256sum | cut -c1-64) '" +
        grant + "' >> tokens; chmod 600 tokens");
    return path(name);
  }
};

TEST_F(ProgramsTlsTest, TheKeyOfTheFirstConnectionCounts) {
  keepPorts();
  auto server = startTlsServer({"--tls", "auto"});
  const std::string address = addressOf(*server);
  for (int round = 0; round < 2; ++round) {
    const auto viewer = startViewer("hapticasts://" + address);
    EXPECT_TRUE(viewer->says("connected: ", kSoon)) << viewer->output();
    interrupt(*viewer);
  }
  const auto plain = startViewer(address);
  EXPECT_TRUE(plain->says("connected: ", kSoon)) << "without tokens plain TCP is open, too";
  interrupt(*plain);
  interrupt(*server);
  std::filesystem::remove(path("state/hapticast/tls.pem"));
  server = startTlsServer({"--tls", "auto"}, address);
  (void)addressOf(*server);
  const auto viewer = startViewer("hapticasts://" + address);
  expectRefusal(*viewer,
                "not the expected one: somebody else may answer, or the server has a new "
                "key; to accept its new key, delete line 1 of " +
                    path("state/hapticast/known_servers"));
  interrupt(*server);
}

TEST_F(ProgramsTlsTest, AnAuthorityDecidesWhereTheUserNamesOne) {
  makeCertificate("good", "IP:127.0.0.1", 10);
  makeCertificate("old", "IP:127.0.0.1", -1);
  makeCertificate("other", "DNS:elsewhere.example", 10);
  const std::vector<std::string> trust{"--tls-ca", path("ca.pem")};
  const auto with = [this](const std::string& name) {
    return std::vector<std::string>{"--tls-cert", path(name + ".pem"), "--tls-key",
                                    path(name + ".key")};
  };
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"old", "certificate has expired, by the clock of this machine"},
      {"other", "IP address mismatch"}};
  for (const auto& [name, why] : wrong) {
    const auto server = startTlsServer(with(name));
    const auto viewer = startViewer("hapticasts://" + addressOf(*server), trust);
    expectRefusal(*viewer, "the server's certificate is not valid: " + why);
    interrupt(*server);
  }
  const auto own = startTlsServer({"--tls", "auto"});
  const auto unknown_viewer = startViewer("hapticasts://" + addressOf(*own), trust);
  expectRefusal(*unknown_viewer, "the server's certificate is not valid: ");
  interrupt(*own);
  const auto server = startTlsServer(with("good"));
  const auto viewer = startViewer("hapticasts://" + addressOf(*server), trust);
  EXPECT_TRUE(viewer->says("connected: ", kSoon)) << viewer->output();
  interrupt(*viewer);
  interrupt(*server);
}

TEST_F(ProgramsTlsTest, OpensslTalksToThePortAndTls12IsRefused) {
  const auto server = startTlsServer({"--tls", "auto"});
  const std::string client = "openssl s_client -connect " + addressOf(*server) + " </dev/null";
  run(client + " | grep -q 'New, TLSv1.3'");
  run("! " + client + " -tls1_2");
  EXPECT_TRUE(server->says("TLS failed: unsupported protocol", kSoon)) << server->output();
  interrupt(*server);
}

TEST_F(ProgramsTlsTest, AServerWithoutTlsIsNoServerForATlsClient) {
  const auto server = startTlsServer({});
  EXPECT_TRUE(server->says("the stream is not encrypted: anybody on the way can read it", kStart));
  const auto viewer = startViewer("hapticasts://" + addressOf(*server));
  EXPECT_TRUE(viewer->says("TLS", kSoon)) << viewer->output();
  interrupt(*viewer);
  interrupt(*server);
}

TEST_F(ProgramsTlsTest, OnlyTokensOfTheFileOpenTheStream) {
  const std::string viewer_token = makeToken("alice", "viewer never");
  const std::string old_token = makeToken("bob", "viewer 2020-01-01");
  const auto server = startTlsServer({"--tls", "auto", "--tokens", path("tokens")});
  const std::string address = "hapticasts://" + addressOf(*server);
  const auto none = startViewer(address);
  expectRefusal(*none, "this server needs an access token (--token-file)");
  const auto expired = startViewer(address, {"--token-file", old_token});
  expectRefusal(*expired, "the access token has expired");
  const auto unknown = startViewer(address, {"--token-file", write("eve", "a guess")});
  expectRefusal(*unknown, "the access token is unknown");
  const auto viewer = startViewer(address, {"--token-file", viewer_token});
  EXPECT_TRUE(viewer->says("connected: ", kSoon)) << viewer->output();
  interrupt(*viewer);
  interrupt(*server);
}

TEST_F(ProgramsTlsTest, AnOperatorControlsTheStreamAndAViewerMayNot) {
  const std::string viewer_token = makeToken("alice", "viewer never");
  const std::string operator_token = makeToken("boss", "operator never");
  const auto server = startTlsServer({"--tls", "auto", "--tokens", path("tokens")});
  const std::string address = "hapticasts://" + addressOf(*server);
  const auto viewer = startViewer(address, {"--token-file", viewer_token, "--summary",
                                            path("run.json"), "--log", path("run.csv")});
  EXPECT_TRUE(waitUntil(kStart, [&] {
    const std::vector<LogRow> rows = readLog(path("run.csv"));
    return !rows.empty() && rows.back().penetration_mm > 0.0;
  })) << viewer->output();
  const auto request = [&](const std::string& token, const std::string& what) {
    return startClient({address, "--token-file", token, "--control", what});
  };
  const auto denied = request(viewer_token, "pause");
  expectRefusal(*denied, "this access token is a viewer's, not an operator's");
  EXPECT_EQ(request(operator_token, "pause")->wait(kSoon), 0);
  EXPECT_TRUE(viewer->says("no new frames arrive: the force has faded", kSoon));
  EXPECT_EQ(request(operator_token, "play,seek=1,stiffness=0.8")->wait(kSoon), 0);
  EXPECT_TRUE(viewer->says("frames arrive again", kSoon)) << viewer->output();
  EXPECT_TRUE(server->says("an operator seeks to 1 s", kSoon)) << server->output();
  interrupt(*viewer);
  std::ifstream in(path("run.json"));
  const std::string summary((std::istreambuf_iterator<char>(in)), {});
  EXPECT_NE(summary.find("\"step_excess_max_N\": 0.0,"), std::string::npos) << summary;
  interrupt(*server);
}

TEST_F(ProgramsTlsTest, ATokenThatIsRemovedEndsItsViewersAtTheNextReload) {
  const std::string alice = makeToken("alice", "viewer never");
  const std::string bob = makeToken("bob", "viewer never");
  const auto server = startTlsServer({"--tls", "auto", "--tokens", path("tokens")});
  const std::string address = "hapticasts://" + addressOf(*server);
  const auto removed = startViewer(address, {"--token-file", alice});
  const auto kept = startViewer(address, {"--token-file", bob, "--summary", path("run.json")});
  EXPECT_TRUE(removed->says("connected: ", kSoon)) << removed->output();
  EXPECT_TRUE(kept->says("connected: ", kSoon)) << kept->output();
  write("tokens", "nonsense\n");
  server->signal(SIGHUP);
  EXPECT_TRUE(server->says("the files before stay in use", kSoon)) << server->output();
  EXPECT_EQ(server->output().find("nonsense"), std::string::npos) << "it could be a token";
  write("tokens", "");
  server->signal(SIGHUP);
  EXPECT_TRUE(server->says("has no token, so no client could connect; ", kSoon))
      << server->output();
  std::filesystem::remove(path("tokens"));
  (void)makeToken("bob", "viewer never");
  server->signal(SIGHUP);
  expectRefusal(*removed, "your access token is no longer valid");
  EXPECT_TRUE(server->says("--tokens " + path("tokens") + ": 1 tokens", kSoon));
  interrupt(*kept);
  interrupt(*server);
}

TEST_F(ProgramsTlsTest, OtherMachinesNeedTlsWhereTokensAreNeeded) {
  std::string host;
  for (const NetworkInterface& each : networkInterfaces()) {
    if (each.address.is_v4() && !each.address.is_loopback()) host = each.address.to_string();
  }
  if (host.empty()) GTEST_SKIP() << "this machine has no address but 127.0.0.1";
  const std::string token = makeToken("alice", "viewer never");
  const auto server = startTlsServer({"--tls", "auto", "--tokens", path("tokens")}, host + ":0");
  const std::string address = addressOf(*server);
  const auto careful = startViewer(address, {"--token-file", token});
  expectRefusal(*careful, "the access token would travel unencrypted: use hapticasts://HOST");
  const auto careless = startViewer(address, {"--token-file", token, "--insecure"});
  expectRefusal(*careless, "this server needs TLS: use hapticasts://HOST");
  const auto viewer = startViewer("hapticasts://" + address, {"--token-file", token});
  EXPECT_TRUE(viewer->says("connected: ", kSoon)) << viewer->output();
  interrupt(*viewer);
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
