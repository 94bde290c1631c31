// SPDX-License-Identifier: MIT
#include "common/transport/tcp_channel.hpp"

#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "common/endpoint.hpp"
#include "common/transport/tcp_delay.hpp"
#include "common/transport/websocket_framing.hpp"

namespace hapticast {

namespace {

constexpr const char* kHttpAnswer =
    "HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain; charset=utf-8\r\n"
    "X-Content-Type-Options: nosniff\r\nContent-Length: 70\r\nConnection: close\r\n\r\n"
    "This port is for hapticast-client. It has no pages for a web browser.\n";
// Chosen: a picture of 50 KB needs few reads, and a thousand sessions need 16 MB.
constexpr std::size_t kChunkBytes = 16U << 10U;
constexpr std::size_t kWriteAtOnceBytes = 64U << 10U;  // asio's own default

std::string formatName(const asio::ip::tcp::endpoint& peer) {
  if (peer.port() == 0) return "?";
  return toString(Endpoint{unmapAddress(peer.address()).to_string(), peer.port()});
}

asio::ip::tcp::endpoint remoteEndpoint(const asio::ip::tcp::socket& socket) {
  boost::system::error_code ended;
  return socket.remote_endpoint(ended);
}

}  // namespace

TcpChannel::TcpChannel(asio::ip::tcp::socket socket, std::size_t read_limit_bytes,
                       std::unique_ptr<TlsEngine> tls, ChannelEnd end, HttpResponder* responder)
    : Channel(formatName(remoteEndpoint(socket)), read_limit_bytes),
      socket_(std::move(socket)),
      chunk_(kChunkBytes),
      framing_(std::make_unique<LengthFraming>(read_limit_bytes)),
      tls_(std::move(tls)),
      outer_(end == ChannelEnd::kServer),
      inner_(end == ChannelEnd::kServer),
      responder_(responder) {
  boost::system::error_code ignored;  // without it messages are only later
  socket_.set_option(asio::ip::tcp::no_delay(true), ignored);
  socket_.non_blocking(true, ignored);  // for writeNow()
  hosts_.peer = unmapAddress(remoteEndpoint(socket_).address());
  hosts_.local = unmapAddress(socket_.local_endpoint(ignored).address());
}

asio::awaitable<Result<std::optional<Payload>, WireError>> TcpChannel::read() {
  for (;;) {
    framing_->setLimit(read_limit_bytes_);
    auto payload = framing_->next();
    if (!payload.ok() || payload.value()) co_return payload;
    if (framing_->ended() || (tls_ != nullptr && tls_->ended())) co_return std::optional<Payload>();
    const std::size_t size = co_await readSome();
    if (size == 0) co_return std::optional<Payload>();
    if (auto failure = receive(std::span(chunk_).first(size)))
      co_return WireError{ErrorCode::kMalformed, std::move(failure->message)};
    if (answer_ && !co_await upgrade()) co_return std::optional<Payload>();
  }
}

void TcpChannel::receivePlain(std::span<const std::uint8_t> bytes) {
  if (carrier_ == Carrier::kHttp) return collectHead(bytes);
  if (!inner_.undecided()) return framing_->feed(bytes);
  const auto kind = inner_.add(bytes);
  if (!kind) return;
  const std::vector<std::uint8_t> first = inner_.pop();
  if (kind != ConnectionKind::kHttp) return framing_->feed(first);
  carrier_ = Carrier::kHttp;
  collectHead(first);
}

void TcpChannel::collectHead(std::span<const std::uint8_t> bytes) {
  if (answer_ || !head_.add(bytes)) return;
  if (responder_ != nullptr) {
    answer_ = responder_->respond(head_.text(), encrypted());
  } else {
    answer_.emplace();
    answer_->head = kHttpAnswer;
    answer_->problem = "a request of HTTP on the port for viewers";
  }
  problem_ = answer_->problem;
}

asio::awaitable<bool> TcpChannel::upgrade() {
  if (!answer_->is_websocket) co_return false;
  const HttpAnswer answer = *std::exchange(answer_, std::nullopt);
  if (finished_ || !co_await writeBytes({asio::buffer(answer.head), {}})) co_return false;
  framing_ = std::make_unique<WebSocketFraming>(read_limit_bytes_);
  framing_->feed(head_.rest());
  head_ = {};
  for_this_machine_ = answer.for_this_machine;
  carrier_ = Carrier::kWebSocket;
  co_return true;
}

asio::awaitable<void> TcpChannel::answer() {
  if (!answer_ || finished_) co_return;
  const HttpAnswer answer = *std::exchange(answer_, std::nullopt);
  const asio::const_buffer body(answer.body.data(), answer.body.size());
  if (co_await writeBytes({asio::buffer(answer.head), body})) co_await finishWriting();
}

std::optional<Error> TcpChannel::receive(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> first;
  if (outer_.undecided()) {
    const auto kind = outer_.add(bytes);
    if (!kind) return std::nullopt;
    if (kind != ConnectionKind::kTls) tls_.reset();
    first = outer_.pop();
    bytes = first;
  }
  if (tls_ == nullptr) {
    receivePlain(bytes);
    return std::nullopt;
  }
  plain_.clear();
  auto failure = tls_->receive(bytes, plain_);
  untrusted_ = tls_->untrusted();
  flushNow();
  receivePlain(plain_);
  return failure;
}

asio::awaitable<std::optional<Error>> TcpChannel::completeHandshake() {
  while (!tls_->established()) {
    flushNow();
    const std::size_t size = co_await readSome();
    if (size == 0) co_return Error{"the server ended the TLS handshake (" + why_ended_ + ")"};
    if (auto failure = receive(std::span(chunk_).first(size))) co_return failure;
  }
  co_return std::nullopt;
}

bool TcpChannel::encrypt(const SharedBytes& payload) {
  framing_->writePrefix(payload->size(), prefix_);
  return tls_->send(prefix_.view(), *payload);
}

void TcpChannel::flushNow() noexcept {
  std::vector<std::uint8_t>& output = tls_->output();
  if (flushing_ || output.empty()) return;
  boost::system::error_code ec;
  const std::size_t sent = socket_.write_some(asio::buffer(output), ec);
  bytes_written_ += sent;
  output.erase(output.begin(), output.begin() + static_cast<std::ptrdiff_t>(sent));
}

asio::awaitable<bool> TcpChannel::flush() {
  flushing_ = true;
  bool open = true;
  while (open && !tls_->output().empty()) {
    sending_.clear();
    sending_.swap(tls_->output());
    open = co_await writeAll({asio::buffer(sending_), {}});
  }
  flushing_ = false;
  co_return open;
}

asio::awaitable<bool> TcpChannel::writeBytes(std::array<asio::const_buffer, 2> parts) {
  if (tls_ == nullptr) co_return co_await writeAll(parts);
  for (asio::const_buffer part : parts) {
    for (; part.size() > 0; part += kWriteAtOnceBytes) {  // stored twice, so in pieces
      const std::span all(static_cast<const std::uint8_t*>(part.data()), part.size());
      if (!tls_->send({}, all.first(std::min(all.size(), kWriteAtOnceBytes)))) co_return false;
      if (!co_await flush()) co_return false;
    }
  }
  co_return true;
}

asio::awaitable<bool> TcpChannel::writeAll(std::array<asio::const_buffer, 2> bytes) {
  const std::uint64_t before = bytes_written_;
  boost::system::error_code ec;
  const std::size_t all = co_await asio::async_write(
      socket_, bytes,
      [this, before](const boost::system::error_code& error, std::size_t written) {
        bytes_written_ = before + written;
        return error ? 0 : kWriteAtOnceBytes;
      },
      asio::redirect_error(asio::use_awaitable, ec));
  bytes_written_ = before + all;
  if (ec) why_ended_ = ec.message();
  co_return !ec;
}

asio::awaitable<std::size_t> TcpChannel::readSome() {
  boost::system::error_code ec;
  const std::size_t size = co_await socket_.async_read_some(
      asio::buffer(chunk_), asio::redirect_error(asio::use_awaitable, ec));
  bytes_read_ += size;
  if (ec) why_ended_ = ec.message();
  co_return ec ? 0 : size;
}

bool TcpChannel::writeNow(const SharedBytes& payload, bool more_follows) noexcept {
  if (isMute()) return true;
  if (tls_ != nullptr) {
    if (!encrypt(payload)) return true;  // the connection has failed
    if (more_follows) return true;       // flushNow() sends both
    flushNow();
    encrypted_ = !tls_->output().empty();
    return !encrypted_;
  }
  framing_->writePrefix(payload->size(), prefix_);
  const std::array<asio::const_buffer, 2> buffers{asio::buffer(prefix_.view().data(), prefix_.size),
                                                  asio::buffer(*payload)};
  boost::system::error_code ec;
  written_ = socket_.send(buffers, more_follows ? MSG_MORE : 0, ec);
  bytes_written_ += written_;
  if (written_ < prefix_.size + payload->size()) return false;
  written_ = 0;
  prefix_.size = 0;
  return true;
}

asio::awaitable<bool> TcpChannel::write(SharedBytes payload) {
  if (isMute()) co_return true;
  if (tls_ != nullptr) {
    if (!std::exchange(encrypted_, false) && !encrypt(payload)) co_return false;
    co_return co_await flush();
  }
  if (prefix_.size == 0) framing_->writePrefix(payload->size(), prefix_);
  const std::size_t done = std::exchange(written_, 0), of_prefix = std::min(done, prefix_.size);
  const asio::const_buffer prefix(prefix_.view().data(), std::exchange(prefix_.size, 0));
  co_return co_await writeAll({prefix + of_prefix, asio::buffer(*payload) + (done - of_prefix)});
}

asio::awaitable<void> TcpChannel::drain(std::size_t most_bytes) {
  for (std::size_t drained = 0; drained <= most_bytes;) {
    const std::size_t size = co_await readSome();
    if (size == 0) co_return;
    drained += size;
  }
}

asio::awaitable<void> TcpChannel::finishWriting() {
  finished_ = true;
  if (!isMute()) {
    const FramePrefix farewell = framing_->makeFarewell();
    (void)co_await writeBytes({asio::const_buffer(farewell.bytes.data(), farewell.size), {}});
  }
  if (tls_ != nullptr) {
    tls_->finish();
    (void)co_await flush();
  }
  boost::system::error_code ignored;  // the connection has ended already
  socket_.shutdown(asio::socket_base::shutdown_send, ignored);
}

std::size_t TcpChannel::undeliveredBytes() noexcept {
  int bytes = 0;
  if (::ioctl(socket_.native_handle(), SIOCOUTQ, &bytes) != 0) return 0;
  return static_cast<std::size_t>(bytes);
}

Duration TcpChannel::estimateDelay(std::size_t bytes) noexcept {
  return estimateTcpDelay(socket_.native_handle(), bytes);
}

void TcpChannel::close() noexcept {
  boost::system::error_code ignored;
  socket_.close(ignored);
}

void TcpChannel::abort() noexcept {
  boost::system::error_code ignored;
  socket_.set_option(asio::socket_base::linger(true, 0), ignored);
  close();
}

}  // namespace hapticast
