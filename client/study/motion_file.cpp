// SPDX-License-Identifier: MIT
#include "client/study/motion_file.hpp"

#include <fmt/format.h>

#include <iterator>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace hapticast::client {

namespace {

/// Returns the size of the complete rows of `file`; 0 if it does not exist.
std::uintmax_t measureComplete(const std::filesystem::path& file, std::uintmax_t size_bytes) {
  std::ifstream in(file, std::ios::binary);
  const std::uintmax_t tail_bytes = std::min<std::uintmax_t>(size_bytes, 2 * kMotionRow_bytes);
  in.seekg(static_cast<std::streamoff>(size_bytes - tail_bytes));
  const std::string tail{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const std::size_t end = tail.rfind('\n');
  return end == std::string::npos ? size_bytes - tail_bytes : size_bytes - tail.size() + end + 1;
}

}  // namespace

MotionFile::MotionFile(const std::filesystem::path& file) : file_(file) {
  std::error_code error;
  const std::uintmax_t size_bytes = std::filesystem::file_size(file, error);
  if (!error) std::filesystem::resize_file(file, measureComplete(file, size_bytes), error);
  out_.open(file, std::ios::binary | std::ios::app);
  flush();
}

void MotionFile::append(const TickReport& report, double time_s) {
  fmt::memory_buffer row;
  const auto add = [&row](double value) {
    fmt::format_to(std::back_inserter(row), "\t{:.4f}", value);
  };
  fmt::format_to(std::back_inserter(row), "{:.6f}", time_s);
  for (const Vec3* vector :
       {&report.hip_mm, &report.force_N, &report.static_force_N, &report.dynamic_force_N})
    for (const double value : *vector) add(value);
  add(report.penetration_mm);
  fmt::format_to(std::back_inserter(row), "\t{}\n", report.contact ? 1 : 0);
  out_.write(row.data(), static_cast<std::streamsize>(row.size()));
}

void MotionFile::flush() {
  if (out_.flush() || std::exchange(is_reported_, true)) return;
  throw std::runtime_error(file_.string() +
                           ": cannot be written; is the disk full? Free some space, then continue "
                           "with --resume");
}

}  // namespace hapticast::client
