// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/StateArchive.h>

#include <cstring>

namespace dyslam
{
void StateArchive::fail()
{
  throw UserError("the state of the run is damaged, or of another program");
}

void StateArchive::raw(void* data, std::size_t size)
{
  if (size == 0)
  {
    return;
  }
  if (!loading_)
  {
    saved_.append(static_cast<const char*>(data), size);
    return;
  }
  if (size > given_.size() - position_)
  {
    fail();
  }
  std::memcpy(data, given_.data() + position_, size);
  position_ += size;
}

std::size_t StateArchive::count(std::size_t size, std::size_t bytes_each)
{
  std::uint64_t number = size;
  raw(&number, sizeof number);
  if (loading_ && number > (given_.size() - position_) / bytes_each)
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

void StateArchive::mark(std::uint32_t expected)
{
  std::uint32_t found = expected;
  raw(&found, sizeof found);
  if (found != expected)
  {
    fail();
  }
}

void StateArchive::requireEnd() const
{
  if (position_ != given_.size())
  {
    fail();
  }
}
}  // namespace dyslam
