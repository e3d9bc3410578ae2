// SPDX-License-Identifier: BSD-3-Clause
#include "GzInput.h"

#include <dyslam/core/Error.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/io/GzOutput.h>
#include <fcntl.h>
#include <libdeflate.h>
#include <unistd.h>

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
constexpr std::size_t largest_content = GzOutput::member_size;
constexpr std::size_t largest_member = largest_content + largest_content / 8;

bool isGzip(const char* bytes, std::size_t count)
{
  return count >= 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
}
}  // namespace

GzInput::GzInput(const std::string& path)
    : path_(path), decompressor_(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor)
{
  (void)openBinary(path);
  std::error_code ignored;
  size_ = std::filesystem::file_size(path, ignored);
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0)
  {
    throw UserError(path + ": cannot be read (" + std::strerror(errno) +
                    "); check its permissions");
  }
}

GzInput::~GzInput()
{
  if (file_ != nullptr)
  {
    gzclose_r(file_);
  }
  if (descriptor_ >= 0)
  {
    ::close(descriptor_);
  }
}

/** Reads on until a whole member of the usual size is there, or the file ends. */
void GzInput::fillPacked()
{
  if (packed_.size() - packed_begin_ >= largest_member)
  {
    return;
  }
  packed_.erase(packed_.begin(), packed_.begin() + static_cast<std::ptrdiff_t>(packed_begin_));
  packed_begin_ = 0;
  std::size_t have = packed_.size();
  const std::uint64_t left = size_ - std::min<std::uint64_t>(size_, offset_);
  packed_.resize(std::max<std::size_t>(have, std::min<std::uint64_t>(left, 2 * largest_member)));
  for (ssize_t got = 1; have < packed_.size() && got > 0; have += static_cast<std::size_t>(got))
  {
    // An error shows again where zlib reads on.
    got = std::max<ssize_t>(0, ::read(descriptor_, &packed_[have], packed_.size() - have));
  }
  packed_.resize(have);
}

bool GzInput::nextMember()
{
  if (file_ != nullptr || !decompressor_)
  {
    return false;
  }
  fillPacked();
  const char* packed = packed_.data() + packed_begin_;
  const std::size_t available = packed_.size() - packed_begin_;
  if (!isGzip(packed, available))
  {
    return false;
  }
  content_.resize(largest_content);
  content_begin_ = 0;
  std::size_t used = 0;
  std::size_t unpacked = 0;
  const bool good =
      libdeflate_gzip_decompress_ex(decompressor_.get(), packed, available, content_.data(),
                                    content_.size(), &used, &unpacked) == LIBDEFLATE_SUCCESS;
  content_.resize(good ? unpacked : 0);
  packed_begin_ += good ? used : 0;
  offset_ += good ? used : 0;
  any_member_ = any_member_ || good;
  return good;
}

bool GzInput::atEndOfMembers()
{
  while (content_begin_ == content_.size())
  {
    if (!nextMember())
    {
      return true;
    }
  }
  return false;
}

void GzInput::startStream()
{
  const std::size_t available = packed_.size() - packed_begin_;
  const bool at_member = isGzip(packed_.data() + packed_begin_, available);
  // As zlib does, what follows the last member and is none is passed over.
  const std::uint64_t from = any_member_ && !at_member ? size_ : offset_;
  if (::lseek(descriptor_, static_cast<off_t>(from), SEEK_SET) < 0 ||
      (file_ = gzdopen(descriptor_, "rb")) == nullptr)
  {
    throw std::runtime_error(path_ + ": " + std::strerror(errno));
  }
  descriptor_ = -1;
  gzbuffer(file_, buffer_size);
  packed_ = {};
  packed_begin_ = 0;
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
  if (atEndOfMembers() && file_ == nullptr)
  {
    startStream();
  }
  if (content_begin_ < content_.size())
  {
    const std::size_t step = std::min(count, content_.size() - content_begin_);
    std::memcpy(buffer, &content_[content_begin_], step);
    content_begin_ += step;
    return step;
  }
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
  if (!atEndOfMembers())
  {
    return false;
  }
  if (file_ == nullptr)
  {
    startStream();
  }
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
  const auto at = file_ == nullptr ? static_cast<std::int64_t>(offset_)
                                   : static_cast<std::int64_t>(gzoffset(file_));
  return size_ == 0 || at < 0 ? 1.0
                              : std::min(1.0, static_cast<double>(at) / static_cast<double>(size_));
}
}  // namespace dyslam
