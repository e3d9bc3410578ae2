// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace dyslam
{
/** A plain value as bytes. */
template <typename Value>
void appendBytes(std::string& bytes, const Value& value)
{
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/** Plain values one after the other, as bytes. */
template <typename Value>
void appendBytes(std::string& bytes, const std::vector<Value>& values)
{
  static_assert(std::is_trivially_copyable_v<Value>);
  const std::uint64_t count = values.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(values.data()), count * sizeof(Value));
}
}  // namespace dyslam
