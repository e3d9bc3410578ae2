// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Error.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace dyslam
{
/** Reads numbers and strings from a block of bytes, never past its end. */
class ByteReader
{
 public:
  /** \param place for messages: the file and the byte that the block begins at. */
  ByteReader(std::string_view bytes, std::string place) : bytes_(bytes), place_(std::move(place)) {}

  /** CDR: numbers stand at multiples of their size, counted from here, at most of `largest`. */
  void alignFromHere(std::size_t largest)
  {
    origin_ = at_;
    largest_alignment_ = largest;
  }
  void setBigEndian(bool big) { big_endian_ = big; }

  template <typename T>
  [[nodiscard]] T number()
  {
    align(sizeof(T));
    const std::string_view from = take(sizeof(T));
    std::array<char, sizeof(T)> bytes{};
    std::copy(from.begin(), from.end(), bytes.begin());
    if (big_endian_)
    {
      std::reverse(bytes.begin(), bytes.end());
    }
    T value;
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  std::uint8_t u8() { return number<std::uint8_t>(); }
  std::uint16_t u16() { return number<std::uint16_t>(); }
  std::uint32_t u32() { return number<std::uint32_t>(); }
  std::uint64_t u64() { return number<std::uint64_t>(); }
  double f64() { return number<double>(); }

  /** Seconds and nanoseconds as uint32 each, ROS's `time` [s]. */
  double rosTime()
  {
    const std::uint32_t seconds = u32();
    return static_cast<double>(seconds) + 1e-9 * static_cast<double>(u32());
  }

  /** View of the next `count` bytes. */
  std::string_view take(std::uint64_t count)
  {
    if (count > left())
    {
      fail("ends " + std::to_string(count - left()) + " bytes short");
    }
    const std::string_view part = bytes_.substr(at_, count);
    at_ += count;
    return part;
  }
  /** A text: length as uint32, then its bytes. */
  std::string_view block() { return take(u32()); }
  void align(std::size_t size)
  {
    const std::size_t step = std::min(size, largest_alignment_);
    if (step > 1)
    {
      (void)take((step - (at_ - origin_) % step) % step);
    }
  }

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] const std::string& place() const { return place_; }
  [[noreturn]] void fail(const std::string& what) const { throw UserError(place_ + ": " + what); }

 private:
  std::string_view bytes_;
  std::string place_;
  std::size_t at_ = 0;
  std::size_t origin_ = 0;
  std::size_t largest_alignment_ = 1;
  bool big_endian_ = false;
};
}  // namespace dyslam
