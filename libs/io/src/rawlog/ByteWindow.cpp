// SPDX-License-Identifier: BSD-3-Clause
#include "ByteWindow.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "GzInput.h"

namespace dyslam
{
namespace
{
constexpr std::size_t block = std::size_t{1} << 22U;  //!< read at once [bytes]
}  // namespace

void ByteWindow::begin()
{
  begin_ = at_;
}

/** Behind what was read; what was forgotten makes way first. */
void ByteWindow::makeRoom(std::size_t bytes)
{
  if (begin_ > 0)
  {
    std::memmove(held_.data(), held_.data() + begin_, end_ - begin_);
    at_ -= begin_;
    end_ -= begin_;
    begin_ = 0;
  }
  if (held_.size() < end_ + bytes)
  {
    held_.resize(std::max(end_ + bytes, held_.size() + held_.size() / 2));
  }
}

void ByteWindow::skip(std::uint64_t count)
{
  if (count > largest - at())
  {
    throw std::runtime_error("an object of more than " + std::to_string(largest >> 20U) + " MB");
  }
  while (end_ - at_ < count)
  {
    const std::size_t step = std::min<std::size_t>(count - (end_ - at_), block);
    makeRoom(step);
    (void)file_.Read(held_.data() + end_, step);
    end_ += step;
  }
  at_ += count;
}

void ByteWindow::skipAll(std::uint64_t count, std::uint64_t size)
{
  // Counts have 32 bits: the product fits.
  skip(count * size);
}

std::uint8_t ByteWindow::u8()
{
  skip(1);
  return static_cast<std::uint8_t>(held_[at_ - 1]);
}

std::uint16_t ByteWindow::u16()
{
  std::uint16_t value = 0;
  skip(sizeof value);
  std::memcpy(&value, held_.data() + at_ - sizeof value, sizeof value);
  return value;
}

std::uint32_t ByteWindow::u32()
{
  std::uint32_t value = 0;
  skip(sizeof value);
  std::memcpy(&value, held_.data() + at_ - sizeof value, sizeof value);
  return value;
}

std::string_view ByteWindow::text()
{
  const std::uint32_t size = u32();
  skip(size);
  return {held_.data() + at_ - size, size};
}

std::string_view ByteWindow::since(std::size_t from) const
{
  return {held_.data() + begin_ + from, at() - from};
}

void ByteWindow::erase(std::size_t from)
{
  const std::size_t place = begin_ + from;
  std::memmove(held_.data() + place, held_.data() + at_, end_ - at_);
  end_ -= at_ - place;
  at_ = place;
}

void ByteWindow::replace(std::size_t place, std::uint8_t value)
{
  held_[begin_ + place] = static_cast<char>(value);
}

std::string_view ByteWindow::ahead(std::size_t wanted)
{
  while (end_ - at_ < wanted)
  {
    const std::size_t step = std::max(wanted - (end_ - at_), std::size_t{1} << 16U);
    makeRoom(step);
    const std::size_t got = file_.readSome(held_.data() + end_, step);
    if (got == 0)
    {
      break;
    }
    end_ += got;
  }
  return {held_.data() + at_, end_ - at_};
}

void ByteWindow::passAhead(std::size_t count)
{
  at_ += count;
  begin_ = at_;
}
}  // namespace dyslam
