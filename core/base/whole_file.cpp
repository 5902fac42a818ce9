// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/whole_file.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/error.h"

namespace kestrel {
namespace {

std::string part_of(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  return fmt::format("{}.{}-{}.part", path, getpid(), counter++);
}

std::string reason() {
  return errno ? std::generic_category().message(errno) : "writing failed";
}

}  // namespace

WholeFile::WholeFile(std::string path) : path_(std::move(path)), part_(part_of(path_)) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path folder = fs::absolute(path_, ignored).parent_path();
  if (!fs::is_directory(folder, ignored)) {
    fail(ErrorCode::file,
         "'{}' cannot be written: there is no folder '{}'. Create it, or choose another.", path_,
         folder.string());
  }
  if (fs::is_directory(path_, ignored)) {
    fail(ErrorCode::file, "'{}' cannot be written: it is a folder. Choose the name of a file.",
         path_);
  }
  errno = 0;
  stream_.open(part_, std::ios::binary | std::ios::trunc);
  if (!stream_) {
    fail(ErrorCode::file,
         "'{}' cannot be written: {}. Choose a folder in which you may create files.", path_,
         reason());
  }
}

WholeFile::~WholeFile() {
  if (published_) return;
  stream_.close();
  std::remove(part_.c_str());
}

void WholeFile::write(const void* data, size_t byte_count) {
  errno = 0;
  stream_.write(static_cast<const char*>(data), static_cast<std::streamsize>(byte_count));
  if (!stream_) fail_writing();
}

void WholeFile::close() {
  errno = 0;
  stream_.close();
  if (!stream_) fail_writing();
}

void WholeFile::publish() {
  errno = 0;
  if (std::rename(part_.c_str(), path_.c_str()) != 0) fail_writing();
  published_ = true;
}

void WholeFile::fail_writing() {
  fail(ErrorCode::file,
       "'{}' cannot be written: {}. See that the disk has room, or choose another folder.", path_,
       reason());
}

}  // namespace kestrel
