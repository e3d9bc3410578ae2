// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/io/GzOutput.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr unsigned buffer_size = 1U << 17U;
constexpr std::size_t largest_step = 1U << 30U;
}  // namespace

GzOutput::GzOutput(const std::string& path, int level) : pending_(path)
{
  const std::string mode = "wb" + std::to_string(std::clamp(level, 0, 9));
  file_ = gzopen(pending_.temporary().c_str(), mode.c_str());
  if (file_ == nullptr)
  {
    throw UserError(path + ": cannot be written: " + std::strerror(errno));
  }
  gzbuffer(file_, buffer_size);
}

GzOutput::~GzOutput()
{
  if (file_ != nullptr)
  {
    gzclose_w(file_);
  }
}

std::size_t GzOutput::Write(const void* buffer, std::size_t count)
{
  const auto* from = static_cast<const char*>(buffer);
  for (std::size_t done = 0; done < count;)
  {
    const std::size_t step = std::min(count - done, largest_step);
    if (!failure_.empty() ||
        gzwrite(file_, from + done, static_cast<unsigned>(step)) != static_cast<int>(step))
    {
      failure_ = failure_.empty() ? std::strerror(errno) : failure_;
      return count;
    }
    done += step;
  }
  return count;
}

void GzOutput::check() const
{
  if (!failure_.empty())
  {
    throw UserError(pending_.path() + ": cannot be written: " + failure_);
  }
}

std::size_t GzOutput::Read(void*, std::size_t)
{
  throw std::logic_error("GzOutput is for writing");
}

void GzOutput::close()
{
  if (file_ == nullptr)
  {
    return;
  }
  const int code = gzclose_w(file_);
  file_ = nullptr;
  check();
  if (code != Z_OK)
  {
    throw UserError(pending_.path() + ": cannot be written to its end: " + std::strerror(errno));
  }
  pending_.commit();
}
}  // namespace dyslam
