// SPDX-License-Identifier: MIT
#include "common/live/live_protocol.hpp"

#include <openssl/evp.h>

#include <nlohmann/json.hpp>
#include <utility>

namespace hapticast {

namespace {

using Json = nlohmann::json;

constexpr std::uint8_t kMessageData = 1;  // opcode
constexpr int kWarning = 1;               // level of a status

std::string toBase64(std::string_view bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // OpenSSL appends a zero
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                   reinterpret_cast<const unsigned char*>(bytes.data()),
                                   static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

std::optional<std::uint32_t> toNumber(const Json& json) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > UINT32_MAX) return std::nullopt;
  return json.get<std::uint32_t>();
}

/// Returns the field `name` of an object if it is a list, else null.
const Json* findList(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_array() ? &*found : nullptr;
}

std::optional<LiveRequest> decodeSubscriptions(const Json& list) {
  LiveRequest request;
  request.begin.reserve(list.size());
  for (const Json& each : list) {
    if (!each.is_object() || !each.contains("id") || !each.contains("channelId"))
      return std::nullopt;
    const auto number = toNumber(each["id"]), channel = toNumber(each["channelId"]);
    if (!number || !channel) return std::nullopt;
    request.begin.push_back({*number, *channel});
  }
  return request;
}

std::optional<LiveRequest> decodeEnds(const Json& list) {
  LiveRequest request;
  request.end.reserve(list.size());
  for (const Json& each : list) {
    const auto number = toNumber(each);
    if (!number) return std::nullopt;
    request.end.push_back(*number);
  }
  return request;
}

}  // namespace

std::string makeServerInfo(const std::string& name) {
  const Json empty = Json::array();
  return Json{{"op", "serverInfo"},
              {"name", name},
              {"capabilities", empty},
              {"supportedEncodings", empty},
              {"metadata", Json::object()}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string makeAdvertisement(const std::vector<McapChannel>& channels) {
  Json list = Json::array();
  for (const McapChannel& channel : channels)
    list.push_back({{"id", list.size() + 1},
                    {"topic", channel.topic},
                    {"encoding", channel.message_encoding},
                    {"schemaName", channel.schema.name},
                    {"schema", toBase64(channel.schema.data)},
                    {"schemaEncoding", channel.schema.encoding}});
  return Json{{"op", "advertise"}, {"channels", std::move(list)}}.dump();
}

std::string makeWarning(const std::string& text) {
  return Json{{"op", "status"}, {"level", kWarning}, {"message", text}}.dump();
}

std::array<std::uint8_t, 13> makeDataHead(std::uint32_t subscription, std::uint64_t time_ns) {
  std::array<std::uint8_t, 13> head{kMessageData};
  for (std::size_t i = 0; i < 4; ++i)
    head[1 + i] = static_cast<std::uint8_t>(subscription >> (8 * i));
  for (std::size_t i = 0; i < 8; ++i) head[5 + i] = static_cast<std::uint8_t>(time_ns >> (8 * i));
  return head;
}

std::optional<LiveRequest> decodeLiveRequest(std::string_view text) {
  if (text.size() > kMostRequestBytes) return std::nullopt;
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto op = json.find("op");
  if (op == json.end() || !op->is_string()) return std::nullopt;
  if (*op == "subscribe") {
    const Json* const list = findList(json, "subscriptions");
    return list != nullptr ? decodeSubscriptions(*list) : std::nullopt;
  }
  if (*op == "unsubscribe") {
    const Json* const list = findList(json, "subscriptionIds");
    return list != nullptr ? decodeEnds(*list) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace hapticast
