// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/SwapFile.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace dyslam
{
namespace
{
/** Slots have few sizes, at most an eighth apart, so that they can be reused. */
std::uint32_t capacityFor(std::size_t size)
{
  constexpr std::size_t least = 64;
  if (size > std::numeric_limits<std::uint32_t>::max() / 2)
  {
    throw std::length_error("SwapFile: more than 2 GiB at a time");
  }
  std::size_t power = least;
  while (2 * power < size)
  {
    power *= 2;
  }
  const std::size_t step = power / 8;
  return static_cast<std::uint32_t>(std::max(least, (size + step - 1) / step * step));
}

int openUnnamed(const std::string& folder)
{
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL))
  {
    return file;
  }
  std::string name = folder + "/.dyslam_memory_XXXXXX";
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0)
  {
    ::unlink(name.c_str());
  }
  return named;
}

/** \return 0, or the errno of the failed write. */
int writeAll(int file, std::string_view bytes, std::uint64_t offset)
{
  while (!bytes.empty())
  {
    const ssize_t count = ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR)
    {
      continue;
    }
    if (count <= 0)
    {
      return count < 0 ? errno : EIO;
    }
    bytes.remove_prefix(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
  return 0;
}
}  // namespace

SwapFile::SwapFile(std::string folder) : folder_(folder.empty() ? "." : std::move(folder)) {}

SwapFile::~SwapFile()
{
  if (file_ >= 0)
  {
    ::close(file_);
  }
}

bool SwapFile::fail(int error)
{
  problem_ = folder_ + ": the temporary file for what exceeds memory.limit cannot be written (" +
             std::strerror(error) + "): from then on everything stayed in memory";
  return false;
}

bool SwapFile::open()
{
  if (file_ < 0 && problem_.empty())
  {
    file_ = openUnnamed(folder_);
    return file_ >= 0 || fail(errno);
  }
  return file_ >= 0 && problem_.empty();
}

bool SwapFile::write(std::string_view bytes, Slot& slot)
{
  if (!open())
  {
    return false;
  }
  Slot to = slot;
  if (bytes.size() > slot.capacity || slot.capacity == 0)
  {
    to.capacity = capacityFor(bytes.size());
    std::vector<std::uint64_t>& unused = unused_[to.capacity];
    to.offset = unused.empty() ? end_ : unused.back();
  }
  to.size = static_cast<std::uint32_t>(bytes.size());
  if (const int error = writeAll(file_, bytes, to.offset); error != 0)
  {
    return fail(error);
  }
  if (to.capacity != slot.capacity || to.offset != slot.offset)
  {
    release(slot);
    if (to.offset == end_)
    {
      end_ += to.capacity;
    }
    else
    {
      unused_[to.capacity].pop_back();
    }
  }
  slot = to;
  return true;
}

std::string SwapFile::read(const Slot& slot) const
{
  std::string bytes(slot.size, '\0');
  std::size_t done = 0;
  while (done < bytes.size())
  {
    const ssize_t count = ::pread(file_, bytes.data() + done, bytes.size() - done,
                                  static_cast<off_t>(slot.offset + done));
    if (count < 0 && errno == EINTR)
    {
      continue;
    }
    if (count <= 0)
    {
      throw UserError(folder_ +
                      ": the temporary file for what exceeds memory.limit cannot be "
                      "read: " +
                      (count < 0 ? std::strerror(errno) : "it was cut"));
    }
    done += static_cast<std::size_t>(count);
  }
  return bytes;
}

void SwapFile::release(Slot& slot)
{
  if (slot.capacity > 0)
  {
    unused_[slot.capacity].push_back(slot.offset);
  }
  slot = Slot();
}

void MemoryOptions::describe(OptionsVisitor& visitor)
{
  visitor.integer(
      "limit", limit, 1, 1000000,
      "memory for map and keyframes, beyond which they are kept in a temporary file [MB]");
}

MemoryLimit::MemoryLimit(const MemoryOptions& options, const std::string& folder)
    : file(std::make_shared<SwapFile>(folder)),
      bytes(static_cast<std::size_t>(options.limit) << 20U)
{
}

MemoryLimit MemoryLimit::part(double share) const
{
  MemoryLimit result = *this;
  if (file != nullptr)
  {
    result.bytes = static_cast<std::size_t>(share * static_cast<double>(bytes));
  }
  return result;
}
}  // namespace dyslam
