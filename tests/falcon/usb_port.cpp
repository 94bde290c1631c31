// SPDX-License-Identifier: MIT
#include "tests/falcon/usb_port.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/usb/ch9.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <umockdev.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace hapticast::testing {
namespace {

struct Handler {
  UMockdevIoctlBase base;
  UsbPort* port;
};
struct HandlerClass {
  UMockdevIoctlBaseClass base;
};

gboolean handleIoctl(UMockdevIoctlBase* self, UMockdevIoctlClient* client) {
  return reinterpret_cast<Handler*>(self)->port->answer(client) ? TRUE : FALSE;
}
void clientVanished(UMockdevIoctlBase* self, UMockdevIoctlClient* client) {
  reinterpret_cast<Handler*>(self)->port->vanished(client);
}

GType handlerType() {
  static const GType kType = g_type_register_static_simple(
      UMOCKDEV_TYPE_IOCTL_BASE, "HapticastUsbPort", sizeof(HandlerClass),
      [](gpointer its_class, gpointer) {
        auto* const base = static_cast<UMockdevIoctlBaseClass*>(its_class);
        base->handle_ioctl = handleIoctl;
        base->client_vanished = clientVanished;
      },
      sizeof(Handler), nullptr, GTypeFlags(0));
  return kType;
}

constexpr int kVanished = -ESHUTDOWN;
constexpr std::uint8_t kIn = 0x81;

usbdevfs_urb& urbOf(UMockdevIoctlData* data) {
  return *reinterpret_cast<usbdevfs_urb*>(data->data);
}

std::string hex(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  std::array<char, 3> two{};
  for (const std::uint8_t byte : bytes) {
    (void)std::snprintf(two.data(), two.size(), "%02X", byte);
    text.append(two.data());
  }
  return text;
}

std::vector<std::uint8_t> descriptors() {
  return {// Device: USB 2.0, 64 bytes, 0403:CB48, strings 1, 2, 3, one configuration.
          18, 1, 0x00, 0x02, 0, 0, 0, 64, 0x03, 0x04, 0x48, 0xCB, 0x00, 0x06, 1, 2, 3, 1,
          // Configuration, interface and the two bulk endpoints.
          9, 2, 32, 0, 1, 1, 0, 0x80, 250, 9, 4, 0, 0, 2, 0xFF, 0xFF, 0xFF, 0,  //
          7, 5, 0x81, 2, 64, 0, 0, 7, 5, 0x02, 2, 64, 0, 0};
}

constexpr const char* kSysPath = "/devices/pci0000:00/0000:00:14.0/usb1/1-1";

}  // namespace

bool hasUmockdev() {
  void* const library = dlopen("libumockdev-preload.so.0", RTLD_LAZY | RTLD_NOLOAD);
  if (library != nullptr) dlclose(library);
  return library != nullptr;
}

UsbPort::UsbPort(std::vector<std::uint8_t> firmware, const std::string& serial)
    : model_(std::move(firmware)), serial_(serial), testbed_(umockdev_testbed_new()) {
  if (umockdev_in_mock_environment() == FALSE) throw std::runtime_error("no preload library");
  handler_ = UMOCKDEV_IOCTL_BASE(g_object_new(handlerType(), nullptr));
  reinterpret_cast<Handler*>(handler_)->port = this;
  thread_ = std::thread([this] { run(); });
}

UsbPort::~UsbPort() {
  try {
    unplug();
  } catch (const std::exception& error) {
    (void)std::fprintf(stderr, "the emulated plug: %s\n", error.what());
  }
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
  g_object_unref(handler_);
  g_object_unref(testbed_);
}

std::string UsbPort::node() const {
  std::array<char, 32> name{};
  (void)std::snprintf(name.data(), name.size(), "/dev/bus/usb/001/%03d", number_);
  return name.data();
}

void UsbPort::plugIn() {
  ++number_;
  const std::string dev = node();
  GError* error = nullptr;
  if (umockdev_testbed_attach_ioctl(testbed_, dev.c_str(), handler_, &error) == FALSE)
    throw std::runtime_error("attach_ioctl failed");
  // A pipe stands for the node: where it takes no more bytes, poll() does not see it writable.
  gchar* const root = umockdev_testbed_get_root_dir(testbed_);
  const std::string file = std::string(root) + dev;
  g_free(root);
  std::filesystem::create_directories(std::filesystem::path(file).parent_path());
  if (mkfifo(file.c_str(), 0666) != 0) throw std::runtime_error("mkfifo failed");
  (void)chmod(file.c_str(), 0666);
  {
    const std::lock_guard lock(mutex_);
    pipe_ = open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    (void)fcntl(pipe_, F_SETPIPE_SZ, 4096);
    plugged_ = true;
    ready_ = true;  // a new pipe is empty
    showReady();
  }
  const std::string number = std::to_string(number_);
  const std::string text =
      "P: " + std::string(kSysPath) +
      "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DEVNAME=" + dev +
      "\nE: BUSNUM=001\nE: DEVNUM=00" + number + "\nE: MAJOR=189\nE: MINOR=" + number +
      "\nA: busnum=1\\n\nA: devnum=" + number + "\\n\nA: bConfigurationValue=1\\n\nA: speed=12\\n" +
      "\nA: idVendor=0403\\n\nA: idProduct=cb48\\n\nH: descriptors=" + hex(descriptors()) + "\n";
  if (umockdev_testbed_add_from_string(testbed_, text.c_str(), &error) == FALSE)
    throw std::runtime_error("add_from_string: " + std::string(error->message));
}

void UsbPort::unplug() {
  {
    const std::lock_guard lock(mutex_);
    if (!plugged_) return;
    plugged_ = false;
    for (Urb& urb : urbs_) {
      if (!urb.done) finishUrb(urb, kVanished, 0);
    }
    showReady();
  }
  umockdev_testbed_uevent(testbed_, (std::string("/sys") + kSysPath).c_str(), "remove");
  umockdev_testbed_detach_ioctl(testbed_, node().c_str(), nullptr);
  umockdev_testbed_remove_device(testbed_, (std::string("/sys") + kSysPath).c_str());
  gchar* const root = umockdev_testbed_get_root_dir(testbed_);
  std::filesystem::remove(std::string(root) + node());
  g_free(root);
  const std::lock_guard lock(mutex_);
  close(std::exchange(pipe_, -1));
  model_.powerCycle();
}

void UsbPort::forbid() {
  gchar* const root = umockdev_testbed_get_root_dir(testbed_);
  using std::filesystem::perms;
  // A process that gives up being root keeps its group.
  const perms look =
      perms::group_read | perms::group_exec | perms::others_read | perms::others_exec;
  const perms use = look | perms::group_write | perms::others_write;
  const auto allow = [](const std::filesystem::path& path, perms what) {
    std::filesystem::permissions(path, what, std::filesystem::perm_options::add);
  };
  allow(root, use);
  for (const auto& each : std::filesystem::recursive_directory_iterator(root)) {
    if (!each.is_symlink()) allow(each, each.is_socket() || each.is_directory() ? use : look);
  }
  (void)chmod((std::string(root) + node()).c_str(), 0600);
  g_free(root);
}

/// Writable while there is something to reap, or after the end.
void UsbPort::showReady() {
  const bool ready =
      !plugged_ || std::any_of(urbs_.begin(), urbs_.end(), [](const Urb& urb) { return urb.done; });
  if (pipe_ < 0 || ready == ready_) return;
  ready_ = ready;
  std::array<char, 16> bytes{};
  const auto moved =
      ready ? read(pipe_, bytes.data(), bytes.size()) : write(pipe_, bytes.data(), 1);
  if (moved != 1) throw std::runtime_error("the pipe is not what it was");
}

void UsbPort::finishUrb(Urb& urb, int status, int length) {
  urbOf(urb.urb).status = status;
  urbOf(urb.urb).actual_length = length;
  urb.done = true;
}

void UsbPort::release(Urb& urb) {
  if (urb.buffer != nullptr) umockdev_ioctl_data_unref(urb.buffer);
  umockdev_ioctl_data_unref(urb.urb);
}

bool UsbPort::answer(UMockdevIoctlClient* client) {
  const unsigned long request = umockdev_ioctl_client_get_request(client);
  UMockdevIoctlData* const arg = umockdev_ioctl_client_get_arg(client);
  const std::size_t size = request >> _IOC_SIZESHIFT & ((1U << _IOC_SIZEBITS) - 1U);
  UMockdevIoctlData* data = nullptr;
  if (size > 0) data = umockdev_ioctl_data_resolve(arg, 0, size, nullptr);
  if (size > 0 && data == nullptr) {  // the client was killed in this very request
    umockdev_ioctl_client_complete(client, -1, EFAULT);
    return true;
  }
  std::unique_lock lock(mutex_);
  int error = 0;
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      constexpr std::uint32_t kCan = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                     USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      std::memcpy(data->data, &kCan, sizeof(kCan));
      break;
    }
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_DISCONNECT_CLAIM:
      error = bus_.busy ? EBUSY : 0;
      break;
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_RESET:
      break;
    case USBDEVFS_CLEAR_HALT: {
      unsigned endpoint = 0;
      std::memcpy(&endpoint, data->data, sizeof(endpoint));
      (endpoint == kIn ? bus_.stall_in : bus_.stall_out) = false;
      break;
    }
    case USBDEVFS_GETDRIVER:
    case USBDEVFS_IOCTL:
      error = ENODATA;
      break;
    case USBDEVFS_SUBMITURB:
      error = submit(client, data);
      break;
    case USBDEVFS_DISCARDURB:
      error = discard(client);
      break;
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      if (bus_.hang.count() > 0) {
        const auto time = std::exchange(bus_.hang, std::chrono::milliseconds(0));
        lock.unlock();  // only whoever reaps hangs: others are answered meanwhile
        std::this_thread::sleep_for(time);
        lock.lock();
      }
      error = reap(client, data);
      break;
    default:
      error = ENOTTY;
  }
  showReady();
  lock.unlock();
  changed_.notify_all();
  umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
  if (data != nullptr) umockdev_ioctl_data_unref(data);
  return true;
}

int UsbPort::submit(UMockdevIoctlClient* client, UMockdevIoctlData* data) {
  if (!plugged_) return ENODEV;
  const usbdevfs_urb& asked = urbOf(data);
  Urb urb{.client = client, .urb = umockdev_ioctl_data_ref(data)};
  const auto length = static_cast<std::size_t>(asked.buffer_length);
  if (length > 0)
    urb.buffer = umockdev_ioctl_data_resolve(data, offsetof(usbdevfs_urb, buffer), length, nullptr);
  if (length > 0 && urb.buffer == nullptr) {  // killed meanwhile
    umockdev_ioctl_data_unref(urb.urb);
    return EFAULT;
  }
  if (asked.type == USBDEVFS_URB_TYPE_CONTROL) {
    control(urb);
  } else if (asked.endpoint != kIn) {
    if (bus_.stall_out) {
      finishUrb(urb, -EPIPE, 0);
    } else {
      model_.write(std::span(urb.buffer->data, length), now());
      finishUrb(urb, 0, asked.buffer_length);
    }
  }
  urbs_.push_back(urb);
  giveIncoming(now());
  return 0;
}

void UsbPort::control(Urb& urb) {
  usb_ctrlrequest setup{};
  std::memcpy(&setup, urb.buffer->data, sizeof(setup));
  std::vector<std::uint8_t> back;
  if (setup.bRequestType == 0x40) {
    model_.control(setup.bRequest, setup.wValue);
  } else if (setup.bRequestType == 0x80 && setup.bRequest == USB_REQ_GET_DESCRIPTOR) {
    const bool languages = setup.wValue == 0x0300;
    const std::string text = (setup.wValue & 0xFFU) == 3 ? serial_ : "FALCON HAPTIC";
    back = {0, USB_DT_STRING};
    if (languages) back.insert(back.end(), {0x09, 0x04});
    for (const char c : languages ? std::string() : text)
      back.insert(back.end(), {static_cast<std::uint8_t>(c), 0});
    back[0] = static_cast<std::uint8_t>(back.size());
  } else {
    finishUrb(urb, -EPIPE, 0);
    return;
  }
  const std::size_t length = std::min<std::size_t>(back.size(), setup.wLength);
  std::copy_n(back.begin(), length, urb.buffer->data + sizeof(setup));
  finishUrb(urb, 0, static_cast<int>(length));
}

int UsbPort::discard(UMockdevIoctlClient* client) {
  gulong address = 0;
  std::memcpy(&address, umockdev_ioctl_client_get_arg(client)->data, sizeof(address));
  for (Urb& urb : urbs_) {
    if (urb.client != client || urb.urb->client_addr != address || urb.done) continue;
    finishUrb(urb, -ENOENT, 0);
    return 0;
  }
  return EINVAL;
}

int UsbPort::reap(UMockdevIoctlClient* client, UMockdevIoctlData* data) {
  const auto ready = std::find_if(urbs_.begin(), urbs_.end(), [client](const Urb& urb) {
    return urb.client == client && urb.done;
  });
  if (ready == urbs_.end()) return plugged_ ? EAGAIN : ENODEV;
  umockdev_ioctl_data_set_ptr(data, 0, ready->urb);
  release(*ready);
  urbs_.erase(ready);
  return 0;
}

void UsbPort::vanished(UMockdevIoctlClient* client) {
  const std::lock_guard lock(mutex_);
  for (Urb& urb : urbs_) {
    if (urb.client == client) release(urb);
  }
  std::erase_if(urbs_, [client](const Urb& urb) { return urb.client == client; });
  showReady();
}

/// Returns whether the bus spoils the next packet.
bool UsbPort::failIncoming(Urb& urb) {
  const auto countDown = [](auto& left) { return left > 0 && left-- > 0; };
  const int error = bus_.stall_in                     ? -EPIPE
                    : countDown(bus_.protocol_errors) ? -EPROTO
                    : countDown(bus_.babbles)         ? -EOVERFLOW
                                                      : 0;
  if (error != 0) finishUrb(urb, error, 0);
  return error != 0;
}

void UsbPort::giveIncoming(LocalTime now) {
  for (Urb& urb : urbs_) {
    if (urb.done || urbOf(urb.urb).endpoint != kIn) continue;
    if (failIncoming(urb)) continue;
    const auto packet = model_.packet(now);
    if (!packet) return;
    const auto room = static_cast<std::size_t>(urbOf(urb.urb).buffer_length);
    const std::size_t length = std::min(packet->size(), room);
    std::copy_n(packet->begin(), length, urb.buffer->data);
    finishUrb(urb, 0, static_cast<int>(length));
  }
}

void UsbPort::run() {
  (void)prctl(PR_SET_TIMERSLACK, 1);
  std::unique_lock lock(mutex_);
  while (!stop_) {
    const LocalTime time = now();
    giveIncoming(time);
    showReady();
    const bool waits = std::any_of(urbs_.begin(), urbs_.end(), [](const Urb& urb) {
      return !urb.done && urbOf(urb.urb).endpoint == kIn;
    });
    if (waits)
      changed_.wait_for(lock, std::max(model_.due() - time, Duration{20'000}));
    else
      changed_.wait(lock);
  }
}

}  // namespace hapticast::testing
