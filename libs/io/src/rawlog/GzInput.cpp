// SPDX-License-Identifier: BSD-3-Clause
#include "GzInput.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/GrowingFile.h>
#include <dyslam/formats/TextFile.h>
#include <fcntl.h>
#include <isa-l/igzip_lib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::size_t packed_size = 1U << 17U;
constexpr std::size_t content_size = 1U << 18U;
constexpr std::chrono::milliseconds growth_check(20);  //!< between two looks at a file that grows
}  // namespace

GzInput::GzInput(const std::string& path, std::function<bool()> stop)
    : path_(path), stop_(std::move(stop)), packed_(packed_size), content_(content_size)
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
  grows_ = isGrowing(descriptor_);
  (void)beginMember();
}

GzInput::~GzInput()
{
  ::close(descriptor_);
}

bool GzInput::fillPacked(std::size_t count)
{
  if (packedSize() >= count)
  {
    return true;
  }
  std::copy(packed_.begin() + static_cast<std::ptrdiff_t>(packed_begin_),
            packed_.begin() + static_cast<std::ptrdiff_t>(packed_end_), packed_.begin());
  packed_end_ -= packed_begin_;
  packed_begin_ = 0;
  while (packed_end_ < count && read_error_.empty())
  {
    const ssize_t got =
        ::read(descriptor_, packed_.data() + packed_end_, packed_.size() - packed_end_);
    if (got < 0 && errno != EINTR)
    {
      read_error_ = std::strerror(errno);
    }
    if (got == 0)
    {
      if (waitForMore())
      {
        continue;
      }
      return false;
    }
    packed_end_ += static_cast<std::size_t>(std::max<ssize_t>(0, got));
    offset_ += static_cast<std::uint64_t>(std::max<ssize_t>(0, got));
  }
  return read_error_.empty();
}

std::uint64_t GzInput::presentSize() const
{
  struct stat state = {};
  return grows_ && ::fstat(descriptor_, &state) == 0 ? static_cast<std::uint64_t>(state.st_size)
                                                     : size_;
}

bool GzInput::waitForMore()
{
  while (grows_)
  {
    // Before the size: the last data come before the end.
    const bool grows = isGrowing(descriptor_);
    size_ = presentSize();
    grows_ = grows;
    if (size_ > offset_)
    {
      return true;
    }
    if (grows_ && stop_ && stop_())
    {
      grows_ = false;
      is_stopped_ = true;
    }
    if (grows_)
    {
      std::this_thread::sleep_for(growth_check);
    }
  }
  return false;
}

bool GzInput::beginMember()
{
  if (!fillPacked(2) || packed_[packed_begin_] != 0x1f || packed_[packed_begin_ + 1] != 0x8b)
  {
    return false;
  }
  if (inflate_ == nullptr)
  {
    inflate_ = std::make_unique<inflate_state>();
    isal_inflate_init(inflate_.get());
  }
  isal_inflate_reset(inflate_.get());
  inflate_->crc_flag = ISAL_GZIP;
  ++members_;
  return true;
}

void GzInput::unpackSome()
{
  inflate_->next_in = packed_.data() + packed_begin_;
  inflate_->avail_in = static_cast<std::uint32_t>(packedSize());
  inflate_->next_out = content_.data();
  inflate_->avail_out = static_cast<std::uint32_t>(content_.size());
  const int result = isal_inflate(inflate_.get());
  packed_begin_ = packed_end_ - inflate_->avail_in;
  content_end_ = content_.size() - inflate_->avail_out;
  is_full_ = inflate_->avail_out == 0;
  if (result < 0)
  {
    broken_ = true;
    ended_ = true;
  }
  is_between_ = result >= 0 && inflate_->block_state == ISAL_BLOCK_FINISH;
}

/** Zeros behind the last member are padding, as of tapes. */
void GzInput::lookForRest()
{
  for (; fillPacked(1); ++packed_begin_)
  {
    if (packed_[packed_begin_] != 0)
    {
      rest_at_ = offset_ - packedSize();
      return;
    }
  }
}

void GzInput::noteCut()
{
  (rest_at_ ? broken_ : cut_) = true;
}

std::string GzInput::whyIncomplete() const
{
  return broken_ || rest_at_    ? "the compressed data are damaged"
         : cut_                 ? "the file is cut short"
         : !read_error_.empty() ? "the file cannot be read to its end: " + read_error_
                                : "";
}

void GzInput::fillContent()
{
  while (content_begin_ == content_end_ && !ended_)
  {
    content_begin_ = 0;
    content_end_ = 0;
    if (is_between_)  // only now: the next member of a file that grows may be long in coming
    {
      is_between_ = false;
      ended_ = !beginMember();
      if (ended_)
      {
        lookForRest();
      }
      continue;
    }
    const bool more = is_full_ || fillPacked(1);
    if (inflate_ == nullptr)
    {
      content_end_ = packedSize();
      std::copy_n(packed_.begin() + static_cast<std::ptrdiff_t>(packed_begin_), content_end_,
                  content_.begin());
      packed_begin_ = packed_end_;
      ended_ = !more;
      continue;
    }
    unpackSome();
    if (!more && content_end_ == 0 && !ended_ && !is_between_)
    {
      ended_ = true;
      cut_ = cut_ || read_error_.empty();
    }
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
      if (!broken_ && read_error_.empty())
      {
        noteCut();
      }
      throw std::runtime_error("unexpected end of data");
    }
    done += got;
  }
  return count;
}

std::size_t GzInput::readSome(void* buffer, std::size_t count)
{
  fillContent();
  const std::size_t step = std::min(count, content_end_ - content_begin_);
  std::memcpy(buffer, content_.data() + content_begin_, step);
  content_begin_ += step;
  return step;
}

bool GzInput::atEnd()
{
  fillContent();
  return content_begin_ == content_end_;
}

bool GzInput::checkMember()
{
  const bool was_cut = cut_;
  for (const std::size_t member = members_;
       !ended_ && !is_between_ && member > 0 && members_ == member;)
  {
    content_begin_ = content_end_;
    fillContent();
  }
  cut_ = was_cut;
  content_begin_ = content_end_;
  ended_ = true;
  return broken_;
}

double GzInput::progress() const
{
  const std::uint64_t at = offset_ - packedSize();
  const std::uint64_t size = presentSize();
  return size == 0 ? 1.0 : std::min(1.0, static_cast<double>(at) / static_cast<double>(size));
}
}  // namespace dyslam
