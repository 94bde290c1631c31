// SPDX-License-Identifier: MIT
#include "common/media/load_media_module.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "common/installed_file.hpp"

namespace hapticast {

const MediaModule& loadMediaModule() {
  return loadMediaModule(findInstalledFile("hapticast-media.so"));
}

const MediaModule& loadMediaModule(const std::string& file) {
  const auto refuse = [&file](const std::string& cause) {
    throw std::runtime_error(file + ": " + cause);
  };
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    refuse("no such file; it belongs into the folder of hapticast-client");
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const reason = dlerror();
    refuse(std::string("cannot be opened: ") + (reason == nullptr ? "unknown reason" : reason) +
           "; install hapticast-client again, or what is missing");
  }
  auto* const function = reinterpret_cast<MediaModuleFunction*>(dlsym(library, "hapticast_media"));
  const MediaModule* const module = function == nullptr ? nullptr : function(kMediaModuleVersion);
  if (module == nullptr)
    refuse("is not the module of this version; install it together with hapticast-client");
  return *module;
}

}  // namespace hapticast
