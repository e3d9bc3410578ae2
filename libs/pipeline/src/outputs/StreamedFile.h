// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Error.h>

#include <fstream>
#include <string>

namespace dyslam
{
/** A text file that grows, readable, while a run goes on. */
class StreamedFile
{
 public:
  /** \throws UserError. */
  void open(const std::string& path, const std::string& header = "")
  {
    path_ = path;
    file_.open(path);
    if (!file_)
    {
      throw UserError(path + ": cannot be written; choose another --output or fix its permissions");
    }
    write(header);
  }
  /** Only close() tells whether it could be written. */
  void write(const std::string& text) { file_ << text << std::flush; }
  /** \throws UserError if not all could be written. */
  void close()
  {
    file_.close();
    if (!file_)
    {
      throw UserError(path_ + ": not everything could be written; is the disk full?");
    }
  }

 private:
  std::string path_;
  std::ofstream file_;
};
}  // namespace dyslam
