// SPDX-License-Identifier: MIT
// Reads and writes the binary form of protobuf messages without libprotobuf. make_messages.py
// generates the classes of the messages; each lists its fields in visitFields(). A field of another
// wire type than expected is skipped, as an unknown one is. Where this reader and libprotobuf
// disagree is a defect (tests/fuzz/messages_fuzz.cpp). Thread: any, one at a time for each object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/protocol/wire_reader.hpp"

namespace hapticast::proto::wire {

template <class T>
class Message;

/// An integer, a bool or an enum as a varint.
template <class T>
struct Varint {
  static constexpr WireType kType = WireType::kVarint;
  T value{};
  bool read(WireReader& in) {
    std::uint64_t bits = 0;
    if (!in.readVarint(bits)) return false;
    if constexpr (std::is_same_v<T, bool>) {
      value = bits != 0;
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(static_cast<std::int32_t>(bits));
    } else {
      value = static_cast<T>(bits);
    }
    return true;
  }
  [[nodiscard]] bool isDefault() const { return value == T{}; }
  void write(WireWriter& out) const { out.varint(static_cast<std::uint64_t>(value)); }
};

/// A number of four or eight bytes, little-endian.
template <class T>
struct Fixed {
  static constexpr WireType kType = sizeof(T) == 4 ? WireType::kFixed32 : WireType::kFixed64;
  T value{};
  bool read(WireReader& in) { return in.readFixed(value); }
  [[nodiscard]] bool isDefault() const {  // -0.0 is not the default
    const T zero{};
    return std::memcmp(&value, &zero, sizeof(T)) == 0;
  }
  void write(WireWriter& out) const { out.fixed(value); }
};

/// A number that is written even if it is 0.
template <class Number>
struct Optional {
  static constexpr WireType kType = Number::kType;
  Number number;
  bool given = false;
  bool read(WireReader& in) { return given = number.read(in); }
  [[nodiscard]] bool isDefault() const { return !given; }
  void write(WireWriter& out) const { number.write(out); }
};

/// Bytes of any kind.
struct Bytes {
  static constexpr WireType kType = WireType::kBytes;
  std::string value;
  bool read(WireReader& in) {
    std::span<const std::uint8_t> bytes;
    if (!in.readBytes(bytes)) return false;
    value.assign(bytes.begin(), bytes.end());
    return true;
  }
  [[nodiscard]] bool isDefault() const { return value.empty(); }
  void write(WireWriter& out) const { out.bytes(value); }
};

/// A text in UTF-8.
struct Text : Bytes {
  bool read(WireReader& in) { return Bytes::read(in) && isUtf8(value); }
};

/// A message in a message. A second one of the same field is merged into the first.
template <class T>
class Boxed {
 public:
  static constexpr WireType kType = WireType::kBytes;
  [[nodiscard]] bool has() const { return message_ != nullptr; }
  [[nodiscard]] const T& get() const {
    static const T none;
    return message_ ? *message_ : none;
  }
  T& make() {
    if (!message_) message_ = std::make_unique<T>();
    return *message_;
  }
  void reset() { message_.reset(); }
  bool read(WireReader& in) {
    return in.readMessage([this](WireReader& inner) { return make().read(inner); });
  }
  [[nodiscard]] bool isDefault() const { return !message_; }
  void write(WireWriter& out) const { message_->writeSized(out); }

 private:
  std::unique_ptr<T> message_;
};

/// Repeated numbers in one field (packed); single ones are read, too.
class Floats {
 public:
  [[nodiscard]] int size() const { return static_cast<int>(values_.size()); }
  [[nodiscard]] float Get(int index) const { return values_[static_cast<std::size_t>(index)]; }
  template <class Iterator>
  void Add(Iterator begin, Iterator end) {
    values_.insert(values_.end(), begin, end);
  }
  bool readOne(WireReader& in) { return in.readFixed(values_.emplace_back()); }
  bool read(WireReader& in) {
    std::span<const std::uint8_t> bytes;
    if (!in.readBytes(bytes) || bytes.size() % sizeof(float) != 0) return false;
    const std::size_t before = values_.size();
    values_.resize(before + bytes.size() / sizeof(float));
    if (!bytes.empty()) std::memcpy(values_.data() + before, bytes.data(), bytes.size());
    return true;
  }
  [[nodiscard]] bool isDefault() const { return values_.empty(); }
  void write(WireWriter& out) const {
    out.varint(values_.size() * sizeof(float));
    for (const float value : values_) out.fixed(value);
  }

 private:
  std::vector<float> values_;
};

template <class T>
using Messages = std::vector<T>;
using Strings = std::vector<std::string>;

template <class Field>
bool readField(WireReader& in, std::uint32_t tag, Field& field) {
  return typeOf(tag) == Field::kType ? field.read(in) : in.skip(tag);
}
inline bool readField(WireReader& in, std::uint32_t tag, Floats& field) {
  if (typeOf(tag) == WireType::kFixed32) return field.readOne(in);
  return typeOf(tag) == WireType::kBytes ? field.read(in) : in.skip(tag);
}
template <class T>
bool readField(WireReader& in, std::uint32_t tag, Messages<T>& field) {
  if (typeOf(tag) != WireType::kBytes) return in.skip(tag);
  return in.readMessage([&](WireReader& inner) { return field.emplace_back().read(inner); });
}
inline bool readField(WireReader& in, std::uint32_t tag, Strings& field) {
  if (typeOf(tag) != WireType::kBytes) return in.skip(tag);
  std::span<const std::uint8_t> bytes;
  if (!in.readBytes(bytes)) return false;
  field.emplace_back(bytes.begin(), bytes.end());
  return true;
}

template <class Field>
void writeField(WireWriter& out, std::uint32_t number, const Field& field) {
  constexpr WireType kType = [] {
    if constexpr (std::is_same_v<Field, Floats>)
      return WireType::kBytes;
    else
      return Field::kType;
  }();
  if (field.isDefault()) return;
  out.tag(number, kType);
  field.write(out);
}
template <class T>
void writeField(WireWriter& out, std::uint32_t number, const Messages<T>& field) {
  for (const T& each : field) {
    out.tag(number, WireType::kBytes);
    each.writeSized(out);
  }
}
inline void writeField(WireWriter& out, std::uint32_t number, const Strings& field) {
  for (const std::string& each : field) {
    out.tag(number, WireType::kBytes);
    out.bytes(each);
  }
}

/// What all messages have. T::visitFields() calls its argument with number and member of each
/// field, in the order of the numbers.
template <class T>
class Message {
 public:
  /// Adds the fields of `in` up to its end. Returns false if they are no message.
  bool read(WireReader& in) {
    T& self = static_cast<T&>(*this);
    while (!in.atEnd()) {
      std::uint32_t tag = 0;
      if (!in.readTag(tag)) return false;
      const std::uint32_t number = numberOf(tag);
      bool known = false, ok = true;
      T::visitFields(self, [&](std::uint32_t each, auto& field) {
        if (each != number) return;
        known = true;
        if constexpr (requires { self.begin(number); }) {
          if (typeOf(tag) == WireType::kBytes) self.begin(number);
        }
        ok = readField(in, tag, field);
      });
      if (!known) ok = in.skip(tag);
      if (!ok) return false;
    }
    return true;
  }
  /// Appends the fields, in the order of their numbers.
  void write(WireWriter& out) const {
    T::visitFields(static_cast<const T&>(*this), [&](std::uint32_t number, const auto& field) {
      writeField(out, number, field);
    });
  }
  /// Appends the size and the fields.
  void writeSized(WireWriter& out) const {
    WireWriter inner;
    write(inner);
    out.bytes(inner.result());
  }

  // As in libprotobuf:
  bool ParseFromArray(const void* data, int size) {
    WireReader in({static_cast<const std::uint8_t*>(data), static_cast<std::size_t>(size)});
    return read(in);
  }
  [[nodiscard]] std::size_t ByteSizeLong() const { return bytes().size(); }
  void SerializeWithCachedSizesToArray(std::uint8_t* to) const {
    const std::string all = bytes();
    if (!all.empty()) std::memcpy(to, all.data(), all.size());
  }

 private:
  [[nodiscard]] std::string bytes() const {
    WireWriter out;
    write(out);
    return std::move(out).result();
  }
};

}  // namespace hapticast::proto::wire
