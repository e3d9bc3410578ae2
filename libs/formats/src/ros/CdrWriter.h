// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Bytes.h>
#include <dyslam/base/Error.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace dyslam
{
/** A message of ROS 2 while it is written: plain CDR (XCDR1), little-endian. Numbers stand at
 * multiples of their size, counted from behind the four bytes that name the encoding. */
class CdrWriter
{
 public:
  CdrWriter() : bytes_("\0\1\0\0", head_) {}

  template <typename Number>
  CdrWriter& put(Number value)
  {
    static_assert(std::is_arithmetic_v<Number>);
    const std::size_t over = (bytes_.size() - head_) % sizeof(Number);
    bytes_.append(over == 0 ? 0 : sizeof(Number) - over, '\0');
    appendBytes(bytes_, value);
    return *this;
  }
  /** Length of a sequence, whose elements follow. \throws UserError if it has too many. */
  CdrWriter& count(std::size_t elements)
  {
    if (elements > std::numeric_limits<std::uint32_t>::max())
    {
      throw UserError("a message of ROS 2 holds at most 4294967295 elements or bytes, not " +
                      std::to_string(elements));
    }
    return put(static_cast<std::uint32_t>(elements));
  }
  /** A string: its length counts the final zero. */
  CdrWriter& text(std::string_view value)
  {
    count(value.size() + 1);
    bytes_ += value;
    bytes_ += '\0';
    return *this;
  }
  /** A sequence of bytes. */
  CdrWriter& block(std::string_view bytes)
  {
    count(bytes.size());
    bytes_ += bytes;
    return *this;
  }

  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  /** The serialised message. */
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  static constexpr std::size_t head_ = 4;  // bytes that name the encoding
  std::string bytes_;
};
}  // namespace dyslam
