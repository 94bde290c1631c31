// SPDX-License-Identifier: MIT
// The client's end of the protocol of proto/README.md, without I/O: a state machine. Bytes and
// times come in. Messages for the server, and the time of the next call, go out. It says hello,
// checks the welcome, the origin's key and the signatures, measures the clock by pings, and
// reports. It decides when a session has failed, and when the next one begins. Its surroundings
// carry the bytes: Connection (sockets), the worker of the page (a WebSocket), MessagePlayer (the
// caller) and controlServer().
// The calls of a session: open(), then receive(), poll() and expire(), then close(). Thread: one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/net/origin_pin.hpp"
#include "client/net/receiver.hpp"
#include "client/net/welcome_limiter.hpp"
#include "common/protocol/messages.hpp"

namespace hapticast::client {

struct SessionSettings {
  OriginPin origin;  ///< check of the server's key
  std::string client_name = "hapticast-client";
  std::string access_token;  ///< secret for the server; empty: none
  /// True: the client may send the token to other machines without TLS.
  bool insecure = false;
  bool wants_video = false;
  bool wants_acts = false;  ///< of other operators, if the token is an operator's
  /// False: the surroundings send the pings, so that every pong counts.
  bool sends_pings = true;
  /// Time limit for the welcome. A connection also uses it for the look-up of the name, and for the
  /// connection itself.
  Duration connect_deadline = std::chrono::seconds(5);
  /// If no message from the server arrives for this time, the session counts as lost.
  Duration silence_limit = std::chrono::seconds(3);
  /// First pause before a retry. Each further pause is twice as long, but at most last_retry.
  Duration first_retry = std::chrono::milliseconds(200);
  Duration last_retry = std::chrono::seconds(1);
  /// Only a session that delivered frames for this time resets the pause to first_retry. Chosen so
  /// that the client retries a server that fails after every welcome only once a second.
  Duration good_after = std::chrono::seconds(3);
  /// If the server answers no ping within this time after the welcome, the session counts as lost.
  Duration pong_limit = std::chrono::seconds(5);
  Duration ping_interval = std::chrono::seconds(1);
  /// Shortest time between two receipts. Chosen: 50 a second are a quarter of the messages that a
  /// server permits.
  Duration receipt_interval = std::chrono::milliseconds(20);
  Duration burst_interval =
      std::chrono::milliseconds(20);  ///< interval of the first ClockSync::kBurst pings
};

/// What protects the bytes of a session on their way.
struct Protection {
  bool encrypted = false;        ///< by TLS
  bool of_this_machine = false;  ///< the server is a program of this machine
};

/// The reason why a session ended.
struct SessionEnd {
  std::string why;                     ///< one line
  std::optional<ErrorCode> code = {};  ///< code of the protocol, if it has one
  bool untrusted = false;       ///< the client does not trust the server, or its way to the server
  bool no_such_server = false;  ///< the host name does not exist
};

/// A client's sessions with one server, one after the other.
class ClientSession {
 public:
  /// `receiver` processes times and frames, and must outlive this object; null: the session
  /// discards them.
  ClientSession(SessionSettings settings, Receiver* receiver);

  /// Begins a session. The hello waits for poll(). Returns an error if the access token must not go
  /// over a connection with this protection. A session that is open begins anew.
  [[nodiscard]] std::optional<SessionEnd> open(Protection protection, LocalTime now);
  /// Processes a message with the bytes `bytes` that arrived at `now`. Returns the message; a
  /// frame has no objects, because the receiver has them. Returns an error if the message
  /// breaks a rule of the protocol, or if it is the server's Error. Then call close().
  [[nodiscard]] Result<Message, SessionEnd> receive(std::span<const std::uint8_t> bytes,
                                                    LocalTime now);
  /// Returns the next message for the server, or nullopt if none is due at `now`.
  [[nodiscard]] std::optional<Message> poll(LocalTime now);
  /// Returns the time of the next ping or receipt; LocalTime::max() before the welcome. Requests
  /// are due at once.
  [[nodiscard]] LocalTime nextMessage() const {
    return std::min(state_.next_ping, state_.receipt_due);
  }
  /// Returns the time at which expire() returns an error if nothing arrives before. Each message
  /// may change it. LocalTime::max() without a session.
  [[nodiscard]] LocalTime nextDeadline() const;
  /// Returns an error if a time limit has passed at `now`. Then call close().
  [[nodiscard]] std::optional<SessionEnd> expire(LocalTime now) const;
  /// Ends the session, or an attempt to connect that never became one. Returns the pause before the
  /// next attempt, or nullopt if it is useless: the server has another protocol version, is not
  /// trusted, or refuses the access token. Before the first welcome of a server, two more causes
  /// make it useless: the host name does not exist, or the peer uses another protocol.
  std::optional<Duration> close(const SessionEnd& end, LocalTime now);

  /// Adds a request for the server: another pause, place, speed or material. Returns false while
  /// kMostRequests wait, or before the welcome.
  bool request(const Control& control);
  /// Sets the request for another transport. It replaces one that waits.
  void request(const Delivery& delivery) { state_.delivery = delivery; }
  /// Requests pictures, or none. Requires SessionSettings::wants_video.
  void requestPictures(bool wanted);
  /// Returns whether the link carries fewer or coarser pictures than the stream has.
  [[nodiscard]] bool arePicturesReduced() const { return state_.reduced; }
  /// Sets the contact flag that the next reports to the server have.
  void setInContact(bool in_contact) { in_contact_ = in_contact; }

  [[nodiscard]] bool welcomed() const { return state_.welcomes > 0; }
  /// Returns the number of welcomes of this session. Each one after the first means that the stream
  /// comes from another origin: clock, key, frame ids and datagrams have begun again.
  [[nodiscard]] std::size_t welcomes() const { return state_.welcomes; }
  /// Returns whether the newest welcome has another description than the message before it.
  [[nodiscard]] bool isDescriptionNew() const { return state_.is_description_new; }
  [[nodiscard]] const StreamDescription& description() const { return state_.description; }
  /// Returns the size of the longest message that the server may send now.
  [[nodiscard]] std::size_t readLimit() const;

  /// Chosen: more than a user presses in a moment.
  static constexpr std::size_t kMostRequests = 16;

 private:
  /// Of one session.
  struct State {
    bool is_open = false;
    Protection protection;
    bool hello_due = true;
    std::size_t welcomes = 0;
    RateLimiter welcome_limiter = makeWelcomeLimiter();
    bool untrusted = false;
    StreamDescription description;
    bool is_description_new = false;
    std::optional<VerifyingKey> key;  // absent: the server signs nothing
    std::uint32_t stream = 0;
    bool sealed_datagrams = false;
    std::optional<Delivery> delivery;  // request that waits
    Delivery last_delivery;
    bool hello_wants_pictures = false;
    std::deque<Control> controls;  // requests that wait
    bool has_requested = false;    // a control, so that one may come back
    std::size_t sent_pings = 0;    // since the newest welcome
    std::deque<LocalTime> pings;   // sent and unanswered
    LocalTime next_ping = LocalTime::max();
    bool report_due = false;
    std::optional<LocalTime> unanswered_since;  // welcome without an answered ping yet
    std::uint64_t received_bytes = 0;           // payloads
    LocalTime received_at{};
    bool sends_receipts = false;  // the server sends parts of pictures
    LocalTime receipt_sent{};
    LocalTime receipt_due = LocalTime::max();
    std::vector<std::uint8_t> picture;  // the parts so far
    std::size_t picture_bytes = 0;      // size of all parts; 0: the first part is next
    bool reduced = false;
    std::optional<LocalTime> first_frame;
    LocalTime deadline{};
    const char* overdue = "";  // the error after the deadline
  };

  [[nodiscard]] std::optional<WireError> process(Message& message,
                                                 std::span<const std::uint8_t> bytes,
                                                 LocalTime now);
  using WelcomeKey = Result<std::optional<VerifyingKey>, WireError>;
  [[nodiscard]] std::optional<WireError> checkWelcome(const Welcome& welcome, const WelcomeKey& key,
                                                      LocalTime now);
  [[nodiscard]] std::optional<WireError> onWelcome(const Welcome& welcome, LocalTime now);
  [[nodiscard]] std::optional<WireError> onFrame(CodedFrame& frame,
                                                 std::span<const std::uint8_t> bytes,
                                                 LocalTime now);
  /// Adds a part of a picture. Turns `message` into the picture if the part is its last.
  [[nodiscard]] std::optional<WireError> onPart(Message& message);
  void onPong(const Pong& pong, LocalTime now);
  void onDescription(const StreamDescription& description, LocalTime now);
  [[nodiscard]] bool isPermanent(const SessionEnd& end) const;
  [[nodiscard]] Message makePing(LocalTime now);
  [[nodiscard]] ReceiverReport makeReport() const;

  SessionSettings settings_;
  Receiver* receiver_;
  State state_;
  bool ever_welcomed_ = false;
  bool in_contact_ = false;
  bool wants_pictures_;
  Duration pause_;
};

}  // namespace hapticast::client
