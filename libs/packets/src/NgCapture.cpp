// SPDX-License-Identifier: BSD-3-Clause
#include "NgCapture.h"

#include <dyslam/base/Files.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace dyslam
{
namespace
{
enum BlockType : std::uint32_t
{
  interface_block = 1,
  old_packet_block = 2,
  simple_packet_block = 3,
  packet_block = 6,
  section_block = 0x0A0D0D0A
};

constexpr std::size_t head_size = 8;  // type and length of a block
constexpr std::size_t tail_size = 4;  // the length again
constexpr std::uint32_t largest_block = 1U << 24U;
constexpr std::uint32_t order_mark = 0x1A2B3C4D;

template <typename T>
T numberIn(const char* at, bool swapped)
{
  std::array<char, sizeof(T)> bytes{};
  std::copy(at, at + sizeof(T), bytes.begin());
  if (swapped)
  {
    std::reverse(bytes.begin(), bytes.end());
  }
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

/** \param units since the second began, below `per_second` \return [us] */
std::uint64_t microsecondsOf(std::uint64_t units, std::uint64_t per_second)
{
  constexpr std::uint64_t million = 1000000;
  constexpr std::uint64_t largest = std::uint64_t{1} << 42U;  // times a million: still 64 bits
  return per_second <= largest ? units * million / per_second : units / (per_second / million);
}
}  // namespace

bool NgCapture::isOne(const std::string& path)
{
  std::array<char, sizeof(std::uint32_t)> begin{};
  std::ifstream file = openBinary(path);
  return file.read(begin.data(), begin.size()) &&
         numberIn<std::uint32_t>(begin.data(), false) == section_block;
}

NgCapture::NgCapture(const std::string& path) : file_(openBinary(path)) {}

template <typename T>
T NgCapture::number(std::size_t at) const
{
  return numberIn<T>(body_.data() + at, is_swapped_);
}

bool NgCapture::fail(const std::string& reason)
{
  damage_ = "block before byte " + std::to_string(position_) + ": " + reason;
  return false;
}

bool NgCapture::readBlock()
{
  std::array<char, head_size + sizeof(order_mark)> begin{};  // the shortest block is as long
  if (!file_.read(begin.data(), begin.size()))
  {
    position_ += static_cast<std::uint64_t>(file_.gcount());
    return file_.gcount() == 0 ? false : fail("is cut short");
  }
  position_ += begin.size();
  type_ = numberIn<std::uint32_t>(begin.data(), is_swapped_);
  if (type_ == section_block)  // the same in both byte orders; the mark stands behind the length
  {
    const auto mark = numberIn<std::uint32_t>(begin.data() + head_size, false);
    is_swapped_ = mark != order_mark;
    if (numberIn<std::uint32_t>(begin.data() + head_size, is_swapped_) != order_mark)
    {
      return fail("has no mark of the byte order");
    }
  }
  const auto length = numberIn<std::uint32_t>(begin.data() + sizeof(type_), is_swapped_);
  if (length < begin.size() || length % 4 != 0 || length > largest_block)
  {
    return fail("has a length of " + std::to_string(length) + " bytes");
  }
  body_.assign(begin.data() + head_size, begin.size() - head_size);
  body_.resize(length - head_size);
  const std::size_t rest = length - begin.size();
  file_.read(body_.data() + begin.size() - head_size, static_cast<std::streamsize>(rest));
  position_ += static_cast<std::uint64_t>(file_.gcount());
  if (!file_)
  {
    return fail("is cut short");
  }
  body_.resize(body_.size() - tail_size);
  return true;
}

bool NgCapture::beginSection()
{
  constexpr std::size_t least = 16;
  if (body_.size() < least || number<std::uint16_t>(4) != 1)
  {
    return fail("is no section of pcapng 1");
  }
  interfaces_.clear();
  return true;
}

bool NgCapture::fillOption(std::size_t code, std::size_t at, std::size_t size, Interface& to)
{
  constexpr std::size_t resolution = 9;
  constexpr std::size_t offset = 14;
  if (code == resolution && size == 1)
  {
    const auto value = static_cast<unsigned char>(body_[at]);
    const unsigned exponent = value & 0x7fU;
    const bool is_binary = (value & 0x80U) != 0;
    if (exponent > (is_binary ? 63U : 19U))
    {
      return fail("has times of an unknown resolution");
    }
    to.units_per_second = 1;
    for (unsigned i = 0; i < exponent; ++i)
    {
      to.units_per_second *= is_binary ? 2 : 10;
    }
  }
  else if (code == offset && size == sizeof(to.offset))
  {
    to.offset = number<std::int64_t>(at);
  }
  return true;
}

bool NgCapture::addInterface()
{
  constexpr std::size_t options = 8;
  constexpr std::size_t option_head = 4;
  if (body_.size() < options)
  {
    return fail("is too short for an interface");
  }
  Interface added;
  added.link = number<std::uint16_t>(0);
  added.longest = number<std::uint32_t>(4);
  std::size_t at = options;
  while (body_.size() >= at + option_head)
  {
    const std::size_t code = number<std::uint16_t>(at);
    const std::size_t size = number<std::uint16_t>(at + 2);
    at += option_head;
    if (code == 0)
    {
      break;
    }
    if (size > body_.size() - at)
    {
      return fail("has an option of " + std::to_string(size) + " bytes");
    }
    if (!fillOption(code, at, size, added))
    {
      return false;
    }
    at += (size + 3) / 4 * 4;
  }
  interfaces_.push_back(added);
  return true;
}

bool NgCapture::fillFrame(std::size_t interface, CapturedFrame& frame)
{
  constexpr std::size_t data = 20;
  const std::size_t size = number<std::uint32_t>(12);
  if (interface >= interfaces_.size() || size > body_.size() - data)
  {
    return fail("has a packet of interface " + std::to_string(interface) + " with " +
                std::to_string(size) + " bytes");
  }
  const Interface& from = interfaces_[interface];
  const std::uint64_t units =
      static_cast<std::uint64_t>(number<std::uint32_t>(4)) << 32U | number<std::uint32_t>(8);
  const auto seconds = static_cast<double>(units / from.units_per_second);
  const std::uint64_t rest = microsecondsOf(units % from.units_per_second, from.units_per_second);
  frame = {from.link, seconds + static_cast<double>(from.offset) + 1e-6 * static_cast<double>(rest),
           body_.data() + data, size};
  return true;
}

/** Such a packet is of the first interface and has no time. */
bool NgCapture::fillSimpleFrame(CapturedFrame& frame)
{
  constexpr std::size_t data = 4;
  if (interfaces_.empty() || body_.size() < data)
  {
    return fail("has a packet without an interface");
  }
  const Interface& from = interfaces_.front();
  std::size_t size = std::min<std::size_t>(number<std::uint32_t>(0), body_.size() - data);
  size = from.longest > 0 ? std::min<std::size_t>(size, from.longest) : size;
  frame = {from.link, 0, body_.data() + data, size};
  return true;
}

bool NgCapture::next(CapturedFrame& frame)
{
  constexpr std::size_t packet_head = 20;
  while (damage_.empty() && readBlock())
  {
    if (type_ == section_block)
    {
      if (!beginSection())
      {
        return false;
      }
    }
    else if (type_ == interface_block)
    {
      if (!addInterface())
      {
        return false;
      }
    }
    else if (type_ == simple_packet_block)
    {
      return fillSimpleFrame(frame);
    }
    else if (type_ == packet_block || type_ == old_packet_block)
    {
      if (body_.size() < packet_head)
      {
        return fail("is too short for a packet");
      }
      return fillFrame(type_ == packet_block ? number<std::uint32_t>(0) : number<std::uint16_t>(0),
                       frame);
    }
  }
  return false;
}
}  // namespace dyslam
