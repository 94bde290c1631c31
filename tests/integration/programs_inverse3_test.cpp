// SPDX-License-Identifier: MIT
// The client with an Inverse3 behind its service, which runs on a loopback port of this test.
#include "tests/integration/inverse3_service.hpp"
#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

class ProgramsInverse3Test : public ProgramsTest {
 protected:
  std::unique_ptr<Process> touchWith(const std::string& address, const Inverse3Service& service,
                                     std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{address, "--view", "off", "--device", "inverse3",
                                       "--device-option", "service=" + service.address(),
                                       // A starved service counts as lost, and comes back.
                                       "--rearm", "--fault-dir", path("faults")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return startClient(std::move(arguments));
  }
};

/// Returns the median of the relative differences of the forces at the service from those of the
/// log, each beside the row of its time, three rows more or less. On a busy machine the helper
/// reduces some forces: the median ignores them. The log begins `begin_s` after the clock.
double compare(const std::vector<Inverse3Service::Force>& sent, const std::vector<LogRow>& logged,
               double begin_s) {
  constexpr std::size_t kRows = 3;
  std::vector<double> errors;
  std::size_t at = 0;
  for (const auto& each : sent) {
    const double time_s = 1e-9 * static_cast<double>(each.time_ns) - begin_s;
    while (at + 1 < logged.size() && logged[at + 1].t_s <= time_s) ++at;
    double least = each.force_N.norm();
    for (std::size_t row = at < kRows ? 0 : at - kRows;
         row < std::min(at + kRows + 1, logged.size()); ++row)
      least = std::min(least, (logged[row].force_N - each.force_N).norm());
    errors.push_back(least / each.force_N.norm());
  }
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

/// The log does not say when on the clock it begins: the begin that fits best, within two seconds
/// of the first message.
double compare(const std::vector<Inverse3Service::Force>& sent, const std::vector<LogRow>& logged,
               std::int64_t first_ns) {
  double best = 1.0;
  for (int ms = 0; ms < 2000; ms += 2)
    best = std::min(best, compare(sent, logged, 1e-9 * static_cast<double>(first_ns) + 1e-3 * ms));
  return best;
}

TEST_F(ProgramsInverse3Test, TheForcesOfTheLogReachTheService) {
  const auto server = startStillServer();
  const std::string address = addressOf(*server);
  for (const char* version : {"3.4.0", "3.5.1"}) {
    SCOPED_TRACE(version);
    const Inverse3Service service(version);
    const std::string log = path(std::string(version) + ".csv");
    const auto client = touchWith(address, service, {"--log", log});
    const auto listContacts = [&service] {
      std::vector<Inverse3Service::Force> sent = service.forces();
      std::erase_if(sent, [](const auto& each) { return each.force_N.norm() <= 0.05; });
      return sent;
    };
    // Forces, not seconds: a busy machine sends fewer of them in a second.
    EXPECT_TRUE(waitUntil(kSoon, [&] { return listContacts().size() > 1000; })) << client->output();
    interrupt(*client);
    EXPECT_EQ(service.foreignForces(), 0) << "the key of this version";
    EXPECT_EQ(service.lastForce_N(), 0.0);
    const std::vector<Inverse3Service::Force> sent = listContacts();
    const double error = compare(sent, readLog(log), service.forces().front().time_ns);
    EXPECT_LT(error, 0.02);
  }
  interrupt(*server);
}

TEST_F(ProgramsInverse3Test, AServiceThatMisbehavesInContactEndsAtZero) {
  struct Case {
    const char* fault;
    const char* line;
  };
  constexpr Case kCases[] = {
      {"nan", "the device does not answer"},
      {"no_position", "the device does not answer"},
      {"text", "the device does not answer"},
      {"silent", "inverse3: the service is lost (it is silent); no force"},
      {"long", "inverse3: the service is lost ("},
      {"close", "inverse3: the service is lost ("},
      {"gone", "the device does not answer"},
      {"uncalibrated", ""},
  };
  const auto server = startStillServer();
  const std::string address = addressOf(*server);
  for (const Case& each : kCases) {
    SCOPED_TRACE(each.fault);
    Inverse3Service service;
    const auto client = touchWith(address, service);
    ASSERT_TRUE(waitUntil(kSoon, [&] { return service.lastForce_N() > 0.3; })) << client->output();
    service.misbehave(each.fault);
    if (std::string(each.fault) == "silent" || std::string(each.fault) == "uncalibrated") {
      EXPECT_TRUE(client->says(each.line, kSoon)) << client->output();
    }
    EXPECT_TRUE(waitUntil(kSoon, [&] { return service.lastForce_N() == 0.0; }) ||
                std::string(each.fault) == "silent")
        << client->output();
    interrupt(*client);
    EXPECT_EQ(service.lastForce_N(), 0.0) << client->output();
  }
  interrupt(*server);
}

TEST_F(ProgramsInverse3Test, AFreeGripPassesTheCheck) {
  Inverse3Service service;
  service.releaseGrip();
  const auto client = startClient(
      {"--check-device", "inverse3", "--device-option", "service=" + service.address()});
  EXPECT_EQ(client->wait(kSoon), 0) << client->output();
  EXPECT_LE(countOccurrences("warning", client->output()), 1U) << client->output();
  for (const auto& force : service.forces()) ASSERT_LE(force.force_N.norm(), 0.3 + 1e-9);
  EXPECT_EQ(service.lastForce_N(), 0.0);
}

TEST_F(ProgramsInverse3Test, WithoutItsServiceTheClientEndsWithOneLine) {
  const auto client = startClient({"--view", "off", "--device", "inverse3", "--device-option",
                                   "service=127.0.0.1:1", "--seconds", "1"});
  EXPECT_EQ(client->wait(kSoon), 1);
  EXPECT_NE(client->output().find("--device inverse3: the Inverse service does not answer at "
                                  "127.0.0.1:1 (Connection refused): start it"),
            std::string::npos)
      << client->output();
}

}  // namespace
}  // namespace hapticast::testing
