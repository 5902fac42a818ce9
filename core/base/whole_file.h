// SPDX-License-Identifier: GPL-3.0-or-later
// A file that appears whole or not at all.
#pragma once

#include <cstddef>
#include <fstream>
#include <string>

namespace kestrel {

/// Gathers beside `path`, in a file of another name, which goes unless publish() was called.
/// Every member throws Error(file) with the reason and a remedy.
class WholeFile {
 public:
  explicit WholeFile(std::string path);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(const void* data, size_t byte_count);
  /// Nothing is written any more, and all of it is on its way to the disk.
  void close();
  /// After close(): takes the place of `path`.
  void publish();

 private:
  [[noreturn]] void fail_writing();

  std::string path_;
  std::string part_;
  std::ofstream stream_;
  bool published_ = false;
};

}  // namespace kestrel
