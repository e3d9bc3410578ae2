// SPDX-License-Identifier: BSD-3-Clause
#include "GzInput.h"

#include <dyslam/core/Error.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr unsigned buffer_size = 1U << 17U;
constexpr std::size_t largest_step = 1U << 30U;
}  // namespace

GzInput::GzInput(const std::string& path) : path_(path)
{
  (void)openBinary(path);
  std::error_code ignored;
  size_ = std::filesystem::file_size(path, ignored);
  file_ = gzopen(path.c_str(), "rb");
  if (file_ == nullptr)
  {
    throw UserError(path + ": cannot be read (" + std::strerror(errno) +
                    "); check its permissions");
  }
  gzbuffer(file_, buffer_size);
}

GzInput::~GzInput()
{
  gzclose_r(file_);
}

void GzInput::noteError()
{
  int code = Z_OK;
  const std::string message = gzerror(file_, &code);
  if (code == Z_ERRNO)
  {
    read_error_ = message;
  }
  else if (code == Z_BUF_ERROR || code == Z_OK)
  {
    cut_ = true;
  }
  else if (code != Z_STREAM_END)
  {
    broken_ = true;
  }
}

std::size_t GzInput::Read(void* buffer, std::size_t count)
{
  auto* to = static_cast<char*>(buffer);
  for (std::size_t done = 0; done < count;)
  {
    const std::size_t got = readSome(to + done, count - done);
    if (got == 0)
    {
      noteError();
      throw std::runtime_error("unexpected end of data");
    }
    done += got;
  }
  return count;
}

std::size_t GzInput::readSome(void* buffer, std::size_t count)
{
  const int got = gzread(file_, buffer, static_cast<unsigned>(std::min(count, largest_step)));
  int code = Z_OK;
  gzerror(file_, &code);
  if (code != Z_OK)
  {
    noteError();
  }
  return got > 0 ? static_cast<std::size_t>(got) : 0;
}

bool GzInput::atEnd()
{
  const int byte = gzgetc(file_);
  if (byte != -1)
  {
    gzungetc(byte, file_);
    return false;
  }
  int code = Z_OK;
  gzerror(file_, &code);
  if (code != Z_OK)
  {
    noteError();
  }
  return true;
}

double GzInput::progress() const
{
  const auto at = gzoffset(file_);
  return size_ == 0 || at < 0 ? 1.0
                              : std::min(1.0, static_cast<double>(at) / static_cast<double>(size_));
}
}  // namespace dyslam
