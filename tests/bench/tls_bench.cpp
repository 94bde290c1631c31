// SPDX-License-Identifier: MIT
// Cost of TLS for a server: a frame to one viewer by TCP with TLS and without, and a handshake.
#include <benchmark/benchmark.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#include <ctime>

#include <array>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "common/transport/tls.hpp"

namespace hapticast {
namespace {

using Bytes = std::vector<std::uint8_t>;

TlsContext makeServerContext() { return TlsContext::ofServer(makeTlsIdentity()).value(); }

/// Delivers bytes between both ends until none wait.
void completeHandshake(TlsEngine& client, TlsEngine& server) {
  Bytes received;
  while (!client.output().empty() || !server.output().empty()) {
    (void)server.receive(std::exchange(client.output(), {}), received);
    (void)client.receive(std::exchange(server.output(), {}), received);
  }
}

double threadTime_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

/// A TCP connection over loopback, whose second one a thread empties.
class Drain {
 public:
  Drain() {
    const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{
        .sin_family = AF_INET, .sin_port = 0, .sin_addr = {htonl(INADDR_LOOPBACK)}, .sin_zero = {}};
    socklen_t size = sizeof(address);
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    ::bind(listener, any, size);
    ::listen(listener, 1);
    ::getsockname(listener, any, &size);
    sockets_[0] = ::socket(AF_INET, SOCK_STREAM, 0);
    ::connect(sockets_[0], any, size);
    sockets_[1] = ::accept(listener, nullptr, nullptr);
    ::close(listener);
    reader_ = std::thread([socket = sockets_[1]] {
      Bytes bytes(1 << 20);
      while (::recv(socket, bytes.data(), bytes.size(), 0) > 0) {
      }
    });
  }
  ~Drain() {
    ::shutdown(sockets_[0], SHUT_RDWR);
    reader_.join();
    ::close(sockets_[0]);
    ::close(sockets_[1]);
  }
  void send(std::span<const std::uint8_t> bytes) const {
    while (!bytes.empty()) {
      const auto sent = ::send(sockets_[0], bytes.data(), bytes.size(), 0);
      if (sent <= 0) return;
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
  }

 private:
  std::array<int, 2> sockets_{};
  std::thread reader_;
};

void sendTlsFrame(benchmark::State& state) {
  const Drain drain;
  const Bytes frame(static_cast<std::size_t>(state.range(0)), 7);
  const bool encrypted = state.range(1) != 0;
  TlsEngine server(makeServerContext());
  TlsEngine client(TlsContext::ofPinningClient(), "server", nullptr);
  completeHandshake(client, server);
  for (auto _ : state) {
    const double begin_s = threadTime_s();
    if (encrypted) {
      (void)server.send({}, frame);
      drain.send(server.output());
      server.output().clear();
    } else {
      drain.send(frame);
    }
    state.SetIterationTime(threadTime_s() - begin_s);
  }
}
// Bytes of a frame; without TLS, with TLS.
BENCHMARK(sendTlsFrame)->ArgsProduct({{2200, 20'000}, {0, 1}})->UseManualTime();

void completeTlsHandshake(benchmark::State& state) {
  const TlsContext context = makeServerContext();
  for (auto _ : state) {
    TlsEngine server(context);
    TlsEngine client(TlsContext::ofPinningClient(), "server", nullptr);
    completeHandshake(client, server);
  }
}
BENCHMARK(completeTlsHandshake)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hapticast
