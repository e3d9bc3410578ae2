// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>

#include <cstring>
#include <utility>

namespace dyslam
{
void StateArchive::fail()
{
  throw UserError("the state of the run is damaged, or of another program");
}

StateArchive::StateArchive(std::string_view bytes)
    : StateArchive(
          [bytes](void* data, std::size_t size) mutable
          {
            std::memcpy(data, bytes.data(), size);
            bytes.remove_prefix(size);
            return true;
          },
          bytes.size())
{
}

StateArchive::StateArchive(Source source, std::uint64_t size)
    : source_(std::move(source)), left_(size)
{
}

void StateArchive::flush()
{
  if (sink_ && !saved_.empty())
  {
    sink_(saved_);
    saved_.clear();
  }
}

void StateArchive::raw(void* data, std::size_t size)
{
  constexpr std::size_t piece = 1 << 20;  // [bytes]
  if (size == 0)
  {
    return;
  }
  if (!isLoading())
  {
    saved_.append(static_cast<const char*>(data), size);
    if (sink_ && saved_.size() >= piece)
    {
      flush();
    }
    return;
  }
  if (size > left_ || !source_(data, size))
  {
    fail();
  }
  left_ -= size;
}

std::size_t StateArchive::count(std::size_t size, std::size_t bytes_each)
{
  std::uint64_t number = size;
  raw(&number, sizeof number);
  if (isLoading() && number > left_ / bytes_each)
  {
    fail();
  }
  return static_cast<std::size_t>(number);
}

void StateArchive::exchange(bool& value)
{
  std::uint8_t byte = value ? 1 : 0;
  raw(&byte, 1);
  if (byte > 1)
  {
    fail();
  }
  value = byte == 1;
}

void StateArchive::exchange(std::string& value)
{
  value.resize(count(value.size(), 1));
  raw(value.data(), value.size());
}

void StateArchive::exchange(std::vector<bool>& values)
{
  std::vector<std::uint8_t> bytes(values.begin(), values.end());
  exchange(bytes);
  values.assign(bytes.begin(), bytes.end());
}

void StateArchive::requireEnd() const
{
  if (left_ != 0)
  {
    fail();
  }
}
}  // namespace dyslam
