// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/StateArchive.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace dyslam
{
/** The bytes of numbers or Eigen vectors, as in files of them alone. Valid as long as the values.
 */
template <typename Value>
[[nodiscard]] std::string_view bytesOf(const std::vector<Value>& values)
{
  static_assert(state::IsPlain<Value>::value);
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

/** Appends the bytes of a trivially copyable value. */
template <typename Value>
void appendBytes(std::string& bytes, const Value& value)
{
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/** Appends the number of values (8 bytes), then the bytes of the values. */
template <typename Value>
void appendBytes(std::string& bytes, const std::vector<Value>& values)
{
  static_assert(std::is_trivially_copyable_v<Value>);
  const std::uint64_t count = values.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(values.data()), count * sizeof(Value));
}

/** Takes a plain value off the front of `bytes`. \throws UserError if they are too few. */
template <typename Value>
void takeBytes(std::string_view& bytes, Value& value)
{
  static_assert(std::is_trivially_copyable_v<Value>);
  if (bytes.size() < sizeof value)
  {
    StateArchive::fail();
  }
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
}

/** Takes what appendBytes() wrote off the front of `bytes`. \throws UserError if they are too few.
 */
template <typename Value>
void takeBytes(std::string_view& bytes, std::vector<Value>& values)
{
  std::uint64_t count = 0;
  takeBytes(bytes, count);
  if (count > bytes.size() / sizeof(Value))
  {
    StateArchive::fail();
  }
  values.resize(count);
  if (count > 0)
  {
    std::memcpy(values.data(), bytes.data(), count * sizeof(Value));
  }
  bytes.remove_prefix(count * sizeof(Value));
}
}  // namespace dyslam
