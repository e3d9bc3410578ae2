// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/GrowingFile.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/io/GzOutput.h>
#include <libdeflate.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>

namespace dyslam
{
GzOutput::GzOutput(const std::string& path, int level, FileName name)
    : path_(path),
      compressor_(libdeflate_alloc_compressor(std::clamp(level, 0, 9)), &libdeflate_free_compressor)
{
  if (name == FileName::at_start)
  {
    const int descriptor = createGrowingFile(path);
    file_ = ::fdopen(descriptor, "wb");
    if (file_ == nullptr)
    {
      ::close(descriptor);
      throw std::bad_alloc();
    }
    begin();
    return;
  }
  pending_.emplace(path);
  open("wb");
}

GzOutput::GzOutput(const std::string& path, int level, StateArchive& saved)
    : path_(path),
      pending_(std::in_place, path),
      compressor_(libdeflate_alloc_compressor(std::clamp(level, 0, 9)), &libdeflate_free_compressor)
{
  pending_->keep();
  exchangeState(saved);
}

void GzOutput::exchangeState(StateArchive& archive)
{
  check();
  std::uint64_t size = archive.isLoading() ? 0 : static_cast<std::uint64_t>(std::ftell(file_));
  archive(size, content_, empty_);
  if (archive.isLoading())
  {
    cutPending(pending_.value(), size);
    open("ab");
    std::fseek(file_, 0, SEEK_END);
  }
}

void GzOutput::open(const char* mode)
{
  file_ = std::fopen(pending_->temporary().c_str(), mode);
  if (file_ == nullptr)
  {
    throw UserError(path_ + ": cannot be written: " + std::strerror(errno));
  }
  begin();
}

void GzOutput::begin()
{
  if (!compressor_)
  {
    throw std::bad_alloc();
  }
  std::setvbuf(file_, nullptr, _IONBF, 0);  // members are large
  content_.reserve(member_size);
  packed_.resize(libdeflate_gzip_compress_bound(compressor_.get(), member_size));
}

GzOutput::~GzOutput()
{
  if (file_ != nullptr)
  {
    std::fclose(file_);
  }
}

void GzOutput::writeMember(const char* content, std::size_t size)
{
  if (!failure_.empty())
  {
    return;
  }
  empty_ = false;
  const auto size_before = std::ftell(file_);
  const std::size_t packed =
      libdeflate_gzip_compress(compressor_.get(), content, size, packed_.data(), packed_.size());
  if (std::fwrite(packed_.data(), 1, packed, file_) != packed)
  {
    failure_ = std::strerror(errno);
    // What a growing file has before stays readable to its end.
    (void)!::ftruncate(::fileno(file_), size_before);
  }
}

std::size_t GzOutput::Write(const void* buffer, std::size_t count)
{
  const auto* from = static_cast<const char*>(buffer);
  for (std::size_t done = 0; done < count;)
  {
    if (content_.empty() && count - done >= member_size)
    {
      writeMember(from + done, member_size);
      done += member_size;
      continue;
    }
    const std::size_t step = std::min(count - done, member_size - content_.size());
    content_.insert(content_.end(), from + done, from + done + step);
    done += step;
    if (content_.size() == member_size)
    {
      writeMember(content_.data(), content_.size());
      content_.clear();
    }
  }
  return count;
}

void GzOutput::check() const
{
  if (!failure_.empty())
  {
    throw UserError(path_ + ": cannot be written: " + failure_);
  }
}

std::size_t GzOutput::Read(void*, std::size_t)
{
  throw std::logic_error("GzOutput is for writing");
}

void GzOutput::flush()
{
  if (!content_.empty())
  {
    writeMember(content_.data(), content_.size());
    content_.clear();
  }
  check();
}

void GzOutput::finish()
{
  if (file_ == nullptr)
  {
    return;
  }
  if (!content_.empty() || empty_)
  {
    writeMember(content_.data(), content_.size());
    content_.clear();
  }
  if (!pending_)
  {
    (void)::fsync(::fileno(file_));  // a PendingFile does this when it is renamed
  }
  const int code = std::fclose(file_);
  file_ = nullptr;
  check();
  if (code != 0)
  {
    throw UserError(path_ + ": cannot be written to its end: " + std::strerror(errno));
  }
  finished_ = true;
}

void GzOutput::close()
{
  finish();
  if (finished_ && pending_)
  {
    finished_ = false;
    pending_->commit();
  }
}
}  // namespace dyslam
