// SPDX-License-Identifier: MIT
#include "server/relay/nats_connection.hpp"

#include "server/stream/stream_settings.hpp"

#if HAPTICAST_NATS

#include <nats/nats.h>
#include <spdlog/spdlog.h>

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "common/text.hpp"

namespace hapticast::server {

namespace {

// A lost server is noticed within three pings. The values are those of the failure tests.
constexpr std::int64_t kPingEvery_ms = 300;
constexpr int kPingsUnanswered = 2;
constexpr std::int64_t kReconnectAfter_ms = 100;
// Long enough for TLS over 200 ms; a server that is gone costs this long before the next is tried.
constexpr std::int64_t kConnectWithin_ms = 1000;
constexpr std::int64_t kWriteWithin_ms = 1000;
// While there is no connection, nothing waits: the least that libnats accepts.
constexpr int kWaiting_bytes = 1;

struct Free {
  void operator()(natsOptions* options) const { natsOptions_Destroy(options); }
  void operator()(natsConnection* connection) const { natsConnection_Destroy(connection); }
  void operator()(natsSubscription* subscription) const { natsSubscription_Destroy(subscription); }
  void operator()(natsMsg* message) const { natsMsg_Destroy(message); }
};

/// Counts the subscriptions and connections whose callbacks may still run.
class Running {
 public:
  void begin() {
    const std::lock_guard lock(mutex_);
    ++count_;
  }
  void end() {
    const std::lock_guard lock(mutex_);
    --count_;
    changed_.notify_all();
  }
  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return count_ == 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int count_ = 0;
};

struct Subscription {
  NatsConnection::OnMessage on_message;
  Running* running = nullptr;
  std::unique_ptr<natsSubscription, Free> handle;
};

void requireFile(const std::string& flag, const std::string& file) {
  std::error_code error;
  if (!file.empty() && !std::filesystem::is_regular_file(file, error))
    throw AddressError(flag + " " + file + ": there is no such file");
}

/// Returns the cause without the place in libnats that comes before it: "(FILE:LINE): CAUSE".
std::string describeLastError(natsStatus status) {
  const char* const last = nats_GetLastError(nullptr);
  const std::string detail = last != nullptr ? sanitizeUtf8(last) : "";
  const std::size_t place = detail.find("): ");
  if (detail.empty()) return natsStatus_GetText(status);
  return place == std::string::npos ? detail : detail.substr(place + 3);
}

std::string readUrl(natsConnection* connection) {
  char url[256] = "";
  (void)natsConnection_GetConnectedUrl(connection, url, sizeof url);
  return sanitizeUtf8(url);
}

void onLost(natsConnection* connection, void* text) {
  if (natsConnection_IsClosed(connection)) return;
  spdlog::warn("{}: the connection to NATS is lost; trying again",
               *static_cast<const std::string*>(text));
}

void onFound(natsConnection* connection, void* text) {
  spdlog::info("{}: connected to NATS again, by {}", *static_cast<const std::string*>(text),
               readUrl(connection));
}

void onClosed(natsConnection* /*of*/, void* running) { static_cast<Running*>(running)->end(); }

void onMessage(natsConnection* /*connection*/, natsSubscription* /*of*/, natsMsg* message,
               void* closure) {
  const std::unique_ptr<natsMsg, Free> owned(message);
  const auto& subscription = *static_cast<const Subscription*>(closure);
  const auto* const data = reinterpret_cast<const std::uint8_t*>(natsMsg_GetData(message));
  const char* const reply = natsMsg_GetReply(message);
  subscription.on_message(
      std::span(data,
                data != nullptr ? static_cast<std::size_t>(natsMsg_GetDataLength(message)) : 0),
      reply != nullptr ? reply : "");
}

void onComplete(void* closure) { static_cast<Subscription*>(closure)->running->end(); }

}  // namespace

struct NatsConnection::Library {
  std::string text;  // flag and address, for messages
  std::unique_ptr<natsOptions, Free> options;
  std::unique_ptr<natsConnection, Free> connection;
  Running running;
  std::vector<std::unique_ptr<Subscription>> subscriptions;

  void require(natsStatus status, const char* what) const {
    if (status != NATS_OK)
      throw AddressError(text + ": " + what + ": " + natsStatus_GetText(status));
  }
  void setOptions(const NatsAddress& address, const NatsCredentials& credentials);
  void setCredentials(const NatsAddress& address, const NatsCredentials& credentials);
  void connect();
};

void NatsConnection::Library::setOptions(const NatsAddress& address,
                                         const NatsCredentials& credentials) {
  natsOptions* made = nullptr;
  require(natsOptions_Create(&made), "libnats fails");
  options.reset(made);
  std::vector<std::string> urls;
  urls.reserve(address.servers.size());
  std::vector<const char*> pointers;
  for (const Endpoint& server : address.servers)
    pointers.push_back(urls.emplace_back(std::string(kNatsScheme) + toString(server)).c_str());
  const auto set = [this](natsStatus status) { require(status, "an option of libnats fails"); };
  set(natsOptions_SetServers(made, pointers.data(), static_cast<int>(pointers.size())));
  set(natsOptions_SetName(made, "hapticast"));
  set(natsOptions_SetTimeout(made, kConnectWithin_ms));
  set(natsOptions_SetPingInterval(made, kPingEvery_ms));
  set(natsOptions_SetMaxPingsOut(made, kPingsUnanswered));
  set(natsOptions_SetReconnectWait(made, kReconnectAfter_ms));
  set(natsOptions_SetReconnectJitter(made, kReconnectAfter_ms, kReconnectAfter_ms));
  set(natsOptions_SetMaxReconnect(made, -1));
  set(natsOptions_SetReconnectBufSize(made, kWaiting_bytes));
  set(natsOptions_SetWriteDeadline(made, kWriteWithin_ms));
  set(natsOptions_SetSendAsap(made, true));
  set(natsOptions_SetNoEcho(made, true));
  set(natsOptions_SetDisconnectedCB(made, onLost, &text));
  set(natsOptions_SetReconnectedCB(made, onFound, &text));
  set(natsOptions_SetClosedCB(made, onClosed, &running));
  setCredentials(address, credentials);
}

void NatsConnection::Library::setCredentials(const NatsAddress& address,
                                             const NatsCredentials& credentials) {
  natsOptions* const made = options.get();
  const auto set = [this](natsStatus status) { require(status, "an option of libnats fails"); };
  if (address.password) {
    set(natsOptions_SetUserInfo(made, address.user.c_str(), address.password->c_str()));
  } else if (!address.user.empty()) {
    set(natsOptions_SetToken(made, address.user.c_str()));
  }
  if (!credentials.creds_file.empty()) {
    requireFile("--nats-creds", credentials.creds_file);
    set(natsOptions_SetUserCredentialsFromFiles(made, credentials.creds_file.c_str(), nullptr));
  }
  if (credentials.ca_file.empty()) return;
  requireFile("--nats-ca", credentials.ca_file);
  set(natsOptions_SetSecure(made, true));
  if (natsOptions_LoadCATrustedCertificates(made, credentials.ca_file.c_str()) != NATS_OK)
    throw AddressError("--nats-ca " + credentials.ca_file +
                       ": is not a file of certificates (PEM)");
}

void NatsConnection::Library::connect() {
  natsConnection* made = nullptr;
  const natsStatus status = natsConnection_Connect(&made, options.get());
  connection.reset(made);
  if (status == NATS_OK) return running.begin();
  if (status == NATS_NO_SERVER)
    throw std::runtime_error(text + ": no nats-server answers there; is it running?");
  if (status == NATS_CONNECTION_AUTH_FAILED || status == NATS_NOT_PERMITTED)
    throw std::runtime_error(text + ": NATS refuses the credentials; see --nats-creds, or use " +
                             kNatsForm);
  throw std::runtime_error(text + ": cannot connect to NATS: " + describeLastError(status) +
                           "; see --nats-creds and --nats-ca");
}

NatsConnection::NatsConnection(const std::string& flag, const NatsAddress& address,
                               const NatsCredentials& credentials)
    : library_(std::make_unique<Library>()) {
  library_->text = flag + " " + toString(address);
  library_->setOptions(address, credentials);
  library_->connect();
}

NatsConnection::~NatsConnection() {
  for (const auto& subscription : library_->subscriptions) subscription->handle.reset();
  natsConnection_Close(library_->connection.get());
  library_->running.wait();
}

void NatsConnection::subscribe(const std::string& subject, OnMessage on_message) {
  auto& added = *library_->subscriptions.emplace_back(std::make_unique<Subscription>());
  added.on_message = std::move(on_message);
  added.running = &library_->running;
  natsSubscription* made = nullptr;
  library_->require(natsConnection_Subscribe(&made, library_->connection.get(), subject.c_str(),
                                             onMessage, &added),
                    "cannot subscribe");
  added.handle.reset(made);
  library_->require(natsSubscription_SetOnCompleteCB(made, onComplete, &added), "cannot subscribe");
  library_->running.begin();
}

bool NatsConnection::publish(const std::string& subject, std::span<const std::uint8_t> bytes,
                             const std::string& reply) {
  natsConnection* const to = library_->connection.get();
  const auto size = static_cast<int>(bytes.size());
  const natsStatus status =
      reply.empty()
          ? natsConnection_Publish(to, subject.c_str(), bytes.data(), size)
          : natsConnection_PublishRequest(to, subject.c_str(), reply.c_str(), bytes.data(), size);
  return status == NATS_OK;
}

bool NatsConnection::isConnected() const {
  return natsConnection_Status(library_->connection.get()) == NATS_CONN_STATUS_CONNECTED;
}

bool NatsConnection::isClosed() const {
  return natsConnection_IsClosed(library_->connection.get());
}

std::size_t NatsConnection::maxPayload() const {
  return static_cast<std::size_t>(natsConnection_GetMaxPayload(library_->connection.get()));
}

std::string NatsConnection::makeInbox() {
  natsInbox* inbox = nullptr;
  if (natsInbox_Create(&inbox) != NATS_OK) throw AddressError("libnats fails");
  std::string subject = inbox;
  natsInbox_Destroy(inbox);
  return subject;
}

}  // namespace hapticast::server

#else

namespace hapticast::server {

struct NatsConnection::Library {};

NatsConnection::NatsConnection(const std::string& flag, const NatsAddress& address,
                               const NatsCredentials& /*credentials*/) {
  throw AddressError(flag + " " + toString(address) +
                     ": this build has no NATS; install libnats-dev and build again");
}
NatsConnection::~NatsConnection() = default;
void NatsConnection::subscribe(const std::string& /*subject*/, OnMessage /*on_message*/) {}
bool NatsConnection::publish(const std::string& /*subject*/,
                             std::span<const std::uint8_t> /*bytes*/,
                             const std::string& /*reply*/) {
  return false;
}
bool NatsConnection::isConnected() const { return false; }
bool NatsConnection::isClosed() const { return true; }
std::size_t NatsConnection::maxPayload() const { return 0; }
std::string NatsConnection::makeInbox() { return ""; }

}  // namespace hapticast::server

#endif
