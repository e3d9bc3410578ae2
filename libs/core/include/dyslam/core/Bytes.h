// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace dyslam
{
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
}  // namespace dyslam
