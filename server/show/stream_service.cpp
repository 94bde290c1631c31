// SPDX-License-Identifier: MIT
#include "server/show/stream_service.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <utility>

#include "common/cli/run_program.hpp"
#include "common/text.hpp"
#include "server/http/host_names.hpp"
#include "server/page/page_link.hpp"
#include "server/stream/key_file.hpp"

namespace hapticast::server {

namespace {

std::optional<MulticastGroup> openMulticastGroup(asio::io_context& io, const Settings& settings) {
  if (!settings.multicast) return std::nullopt;
  return MulticastGroup(io, *settings.multicast, static_cast<int>(settings.multicast_hops));
}

constexpr std::size_t kLeastAnswers = 32;  // chosen: five browsers

StreamSettings makeStreamSettings(const Settings& settings) {
  constexpr std::size_t kHandshakes = Broadcaster::kMaxPendingHandshakes;
  std::size_t pending = settings.tls.wanted() ? kHandshakes : Broadcaster::kMaxPending;
  const std::size_t http =
      settings.http ? HttpServer::kMostConnections + HttpServer::kMostSilent : 0;
  const std::size_t recordings = settings.on_demand ? settings.max_clients : 0;
  const std::size_t viewers = raiseFileLimit(settings.max_clients, pending + http + recordings);
  std::size_t answers = StreamSettings{}.max_answers;
  if (settings.page) {  // it has the files that viewers leave
    const std::size_t handshakes = kHandshakes - pending;
    const std::size_t spare = raiseSpareFiles(handshakes + StreamSettings{}.max_answers,
                                              viewers + pending + http + recordings);
    pending += std::min(spare, handshakes);
    answers = std::max(spare - std::min(spare, handshakes), kLeastAnswers);
  }
  return {.max_clients = viewers,
          .max_pending = pending,
          .max_answers = answers,
          .insecure = settings.insecure};
}

}  // namespace

StreamService::StreamService(const Settings& settings, const Clock& clock,
                             const MediaClock& media_clock, const StreamDescription& description,
                             const StreamIdentity& identity)
    : settings_(settings),
      clock_(clock),
      media_clock_(media_clock),
      started_(clock.now()),
      manager_(clock),
      secrets_log_(clock),
      broadcaster_(io_, clock, media_clock, description, makeStreamSettings(settings)),
      tls_(loadServerTls(settings.tls, secrets_log_)),
      host_names_(listHostNames(findMachineName(), settings.host_names)),
      page_(settings.page ? std::make_optional<PageResponder>(host_names_) : std::nullopt),
      listener_(io_, settings.listen, broadcaster_, tls_, page_ ? &*page_ : nullptr) {
  broadcaster_.introduce(identity);
  if (tls_) spdlog::info("TLS fingerprint: {}", toHex(tls_->fingerprint()));
  if (!settings.tokens_file.empty()) {
    broadcaster_.setAccess(loadAccessList(settings.tokens_file, secrets_log_));
    if (!tls_ && !settings.insecure)
      spdlog::warn(
          "--tokens without TLS: only viewers on this machine can connect; add --tls auto");
  }
  if (settings.http)
    http_.emplace(io_, clock, *settings.http, host_names_, [this] { return collectMetrics(); });
  if (!settings.announce.empty()) requireReachable(listener_.endpoint().address());
  if (!settings.datagrams) {
    if (settings.multicast) throw AddressError("--multicast: --transport tcp sends no datagrams");
    return;
  }
  datagrams_.emplace(io_, clock, listener_, identity, settings);
  broadcaster_.enableUdp(datagrams_->sender);
}

StreamService::Datagrams::Datagrams(asio::io_context& io, const Clock& clock,
                                    const Listener& listener, const StreamIdentity& identity,
                                    const Settings& settings)
    : group(openMulticastGroup(io, settings)),
      sender(io, clock, listener.endpoint(), identity, group ? &*group : nullptr) {}

StreamService::~StreamService() { end(); }

void StreamService::start(std::function<void()> on_signal, std::function<void()> on_reload) {
  signals_.emplace(io_, SIGINT, SIGTERM);
  reload_signal_.emplace(io_);
  if (!sighupIgnored()) (sighupReloads() ? *reload_signal_ : *signals_).add(SIGHUP);
  on_reload_ = std::move(on_reload);
  awaitReload();
  signals_->async_wait(
      [this, on_signal = std::move(on_signal)](const boost::system::error_code& error, int) {
        if (error) return;
        on_signal();
        signals_->clear();  // a second signal has its default action and ends a blocked program
      });
  status_signal_.emplace(io_, SIGUSR1);
  awaitStatusRequest();
  if (http_) {
    http_->start();
    spdlog::info("figures for operators at http://{}/metrics", toString(http_->address()));
  }
  network_ = std::jthread([this] { io_.run(); });
}

void StreamService::awaitReload() {
  reload_signal_->async_wait([this](const boost::system::error_code& error, int) {
    if (error) return;
    if (!std::exchange(reload_waits_, true))
      reload_pause_.async_wait([this](const boost::system::error_code& stopped) {
        if (!stopped) reload();
      });
    awaitReload();
  });
}

void StreamService::reload() {
  reload_waits_ = false;
  reload_pause_.expires_after(kReloadPause);
  manager_.reportReload();
  reloadSecrets();
  on_reload_();
  manager_.reportReloaded();
}

void StreamService::reloadSecrets() {
  try {
    if (auto tls = loadServerTls(settings_.tls, secrets_log_)) {
      if (tls->fingerprint() != tls_->fingerprint()) {
        secrets_log_.info("TLS fingerprint from now on: " + toHex(tls->fingerprint()));
        if (!settings_.announce.empty())
          secrets_log_.warn("--announce carries the fingerprint of the start until the next start");
      }
      listener_.setTls(std::move(*tls));
    }
    if (settings_.tokens_file.empty()) return;
    AccessList list = loadAccessList(settings_.tokens_file, secrets_log_);
    secrets_log_.info(fmt::format("--tokens {}: {} tokens", settings_.tokens_file, list.size()));
    broadcaster_.setAccess(std::move(list));
  } catch (const KeyFileError& error) {
    secrets_log_.error(sanitizeUtf8(error.what()) + "; the files before stay in use");
  }
}

void StreamService::awaitStatusRequest() {
  status_signal_->async_wait([this](const boost::system::error_code& error, int) {
    if (error) return;
    broadcaster_.logStatus();
    awaitStatusRequest();
  });
}

Metrics StreamService::collectMetrics() const {
  Metrics metrics;
  metrics.version = programVersion();
  metrics.name = broadcaster_.description().name;
  metrics.fps = broadcaster_.description().fps;
  metrics.now = clock_.now();
  metrics.uptime = metrics.now - started_;
  metrics.clock_error = media_clock_.errorBound();
  metrics.stream = broadcaster_.counts();
  if (datagrams_) metrics.datagrams = datagrams_->sender.counts();
  if (complete_metrics_) complete_metrics_(metrics);
  return metrics;
}

void StreamService::open(const std::string& name) {
  if (std::exchange(open_, true)) return;
  spdlog::info("listening on {}; Ctrl-C ends the server", toString(listener_.address()));
  const bool has_page = page_ && isPageComplete();
  if (has_page)
    spdlog::info("touch it in a browser: {}",
                 makePageLink(listener_.endpoint(), tls_.has_value(), networkInterfaces()));
  if (!tls_)
    spdlog::info("the stream is not encrypted: anybody on the way can read it (--tls auto)");
  listener_.start();
  if (!settings_.announce.empty())
    announcer_.emplace(settings_.announce, listener_.endpoint(), name,
                       tls_ ? toHex(tls_->fingerprint()) : "", has_page);
  manager_.reportReady(name + ": listening on " + toString(listener_.address()));
}

void StreamService::end() {
  if (!network_.joinable()) return;
  manager_.reportStop();
  announcer_.reset();
  listener_.stop();
  if (http_) http_->stop();
  broadcaster_.stop();
  asio::post(io_, [this] {
    signals_->cancel();
    reload_signal_->cancel();
    reload_pause_.cancel();
    status_signal_->cancel();
  });
  network_.join();
}

}  // namespace hapticast::server
