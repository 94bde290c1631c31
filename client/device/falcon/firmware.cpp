// SPDX-License-Identifier: MIT
#if HAPTICAST_LIBUSB
#include "client/device/falcon/firmware.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace hapticast::client {

namespace {

using std::chrono::milliseconds;
using Bytes = std::vector<std::uint8_t>;
using Steady = std::chrono::steady_clock;

// Requests to the serial chip (FT232R).
constexpr std::uint8_t kReset = 0;
constexpr std::uint8_t kModem = 1;
constexpr std::uint8_t kFlow = 2;
constexpr std::uint8_t kBaud = 3;
constexpr std::uint8_t kFormat = 4;
constexpr std::uint8_t kEventCharacter = 6;
constexpr std::uint8_t kLatency = 9;
constexpr std::uint16_t kPurgeIncoming = 1;
constexpr std::uint16_t kPurgeOutgoing = 2;
constexpr std::uint16_t kReadyOff = 0x0100;  // DTR
constexpr std::uint16_t kReadyOn = 0x0101;
constexpr std::uint16_t kSendOff = 0x0200;  // RTS
// Divisors of 3 MHz with their fraction: 9600, about 142,900 and 1,500,000 baud.
constexpr std::uint16_t kBaudHello = 0x4138;
constexpr std::uint16_t kBaudLoad = 0x0015;
constexpr std::uint16_t kBaudRun = 0x0002;
constexpr std::uint16_t kEightNone = 0x0008;
constexpr std::uint16_t kHelloLatency_ms = 16;  // at 1 ms the boot loader answers unreliably
constexpr std::uint16_t kRunLatency_ms = 1;
// The chip sends its data with the '>' that ends a reply, without waiting for the latency timer.
constexpr std::uint16_t kEventAtEnd = 0x0100 | '>';

constexpr std::array<std::uint8_t, 3> kHello = {0x0A, 0x43, 0x0D};
constexpr std::array<std::uint8_t, 4> kHelloBack = {0x0A, 0x44, 0x2C, 0x0D};
constexpr std::uint8_t kRate = 0x41;     // its length defines the baud rate for the boot loader
constexpr std::size_t kChunk = 62;       // a packet without its status bytes
constexpr std::size_t kLongest = 65536;  // images have 7 to 9 kB; a longer file is another one
// An FT232R answers each read within its latency, also without data. So times count, not reads.
constexpr milliseconds kHelloEvery{100};
constexpr milliseconds kHelloPatience{3000};
constexpr milliseconds kProbeEvery{10};
constexpr milliseconds kAnswer{100};
constexpr milliseconds kEcho{500};

void purge(FalconUsb& usb) {
  usb.control(kReset, kPurgeIncoming);
  usb.control(kReset, kPurgeOutgoing);
}

void setLine(FalconUsb& usb, std::uint16_t latency_ms, std::uint16_t baud) {
  usb.control(kLatency, latency_ms);
  usb.control(kBaud, baud);
  usb.control(kFormat, kEightNone);
  usb.control(kFlow, 0);
}

/// Reads until `accept` accepts the bytes received so far. Returns false at `deadline`.
template <class Accept>
bool readUntil(FalconUsb& usb, Bytes& received, Steady::time_point deadline, Accept accept) {
  while (Steady::now() < deadline) {
    (void)usb.read(received, kProbeEvery);
    if (accept(received)) return true;
  }
  return false;
}

bool answersHello(FalconUsb& usb) {
  Bytes received;
  const auto until = Steady::now() + kHelloPatience;
  const auto answered = [](const Bytes& bytes) {  // bytes before the answer are noise
    return std::search(bytes.begin(), bytes.end(), kHelloBack.begin(), kHelloBack.end()) !=
           bytes.end();
  };
  while (Steady::now() < until) {
    usb.write(kHello);
    if (readUntil(usb, received, Steady::now() + kHelloEvery, answered)) return true;
  }
  return false;
}

/// Writes bytes and checks their echo, which arrives in any number of packets.
void writeEchoed(FalconUsb& usb, std::span<const std::uint8_t> bytes) {
  usb.write(bytes);
  Bytes echo;
  const auto begin = Steady::now();
  while (echo.size() < bytes.size()) {
    (void)usb.read(echo, kAnswer);
    if (Steady::now() - begin > kEcho) throw FalconError("its boot loader stopped answering");
  }
  if (!std::equal(echo.begin(), echo.end(), bytes.begin(), bytes.end()))
    throw FalconError("its boot loader received other bytes than the client sent");
}

}  // namespace

Bytes readFalconFirmware(const std::string& file) {
  const std::string what = "--falcon-firmware " + file + ": ";
  std::error_code error;
  std::ifstream in(file, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(file, error))
    throw std::runtime_error(what + "cannot be read");
  const auto size = std::filesystem::file_size(file, error);
  if (error || size > kLongest)
    throw std::runtime_error(what + "is not the firmware of a Falcon: longer than 64 KiB");
  Bytes image{std::istreambuf_iterator<char>(in), {}};
  if (image.empty()) throw std::runtime_error(what + "is empty");
  return image;
}

std::string usualFalconFirmware() {
  namespace fs = std::filesystem;
  const auto variable = [](const char* name) {
    const char* const value = std::getenv(name);
    return std::string(value == nullptr ? "" : value);
  };
  const std::string home = variable("HOME");
  std::string data = variable("XDG_DATA_HOME");
  if (data.empty() && !home.empty()) data = home + "/.local/share";
  std::error_code error;
  const fs::path file = fs::path(data) / "hapticast/falcon.bin";
  return !data.empty() && fs::is_regular_file(file, error) ? file.string() : "";
}

bool falconRuns(FalconUsb& usb, bool event_character, Duration patience) {
  setLine(usb, kRunLatency_ms, kBaudRun);
  purge(usb);
  usb.control(kEventCharacter, event_character ? kEventAtEnd : 0);
  const FalconFrame neutral = encode({});
  FalconParser parser;
  const auto until = Steady::now() + patience;
  while (Steady::now() < until) {
    usb.write(neutral);
    Bytes received;
    std::size_t parsed = 0;
    const auto replied = [&](const Bytes& bytes) {
      while (parsed < bytes.size())
        if (parser.push(bytes[parsed++])) return true;
      return false;
    };
    if (readUntil(usb, received, Steady::now() + kProbeEvery, replied)) return true;
  }
  return false;
}

void loadFalconFirmware(FalconUsb& usb, const Bytes& image,
                        const std::function<void(double share)>& progress) {
  usb.control(kReset, 0);  // also disables event character and flow control
  purge(usb);
  setLine(usb, kHelloLatency_ms, kBaudHello);
  usb.control(kModem, kSendOff);
  usb.control(kModem, kReadyOff);
  usb.control(kModem, kReadyOn);
  if (!answersHello(usb))
    throw FalconError("its boot loader does not answer: switch its power off and on");
  usb.control(kModem, kReadyOff);
  usb.control(kBaud, kBaudLoad);
  usb.control(kReset, kPurgeIncoming);
  writeEchoed(usb, std::array{kRate});
  for (std::size_t at = 0; at < image.size(); at += kChunk) {
    writeEchoed(usb, std::span(image).subspan(at, std::min(kChunk, image.size() - at)));
    progress(static_cast<double>(at) / static_cast<double>(image.size()));
  }
}

}  // namespace hapticast::client

#endif  // HAPTICAST_LIBUSB
