// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
class GzInput;

/** The bytes of one object of a file: read on demand, kept until the end of the object. Memory
 * grows with the data of the file, not with the sizes that it states. */
class ByteWindow
{
 public:
  /** Bytes of one object, at most. */
  static constexpr std::size_t largest = std::size_t{1} << 28U;

  /** \param file must outlive the window. */
  explicit ByteWindow(GzInput& file) : file_(file) {}

  /** Forgets the bytes passed so far. */
  void begin();
  /** Moves on over `count` bytes. \throws std::runtime_error if they are not there, or too many. */
  void skip(std::uint64_t count);
  /** `count` elements of `size` bytes each. */
  void skipAll(std::uint64_t count, std::uint64_t size);
  [[nodiscard]] std::uint8_t u8();
  [[nodiscard]] std::uint16_t u16();
  [[nodiscard]] std::uint32_t u32();
  /** Length as uint32, then that many bytes. */
  [[nodiscard]] std::string_view text();

  /** Where the window stands, in bytes since begin(). */
  [[nodiscard]] std::size_t at() const { return at_ - begin_; }
  /** The bytes from `from` up to the present place; valid until the next call. */
  [[nodiscard]] std::string_view since(std::size_t from) const;
  /** Takes the bytes from `from` up to the present place out. */
  void erase(std::size_t from);
  /** Back to an earlier place of the object. \param place in bytes since begin() */
  void rewind(std::size_t place) { at_ = begin_ + place; }
  /** Another value for a byte that was passed. */
  void replace(std::size_t place, std::uint8_t value);
  /** The bytes ahead, at least `wanted` unless the file ends; valid until the next call. */
  [[nodiscard]] std::string_view ahead(std::size_t wanted);
  /** Moves to a place among the bytes ahead and forgets those before it. */
  void passAhead(std::size_t count);

 private:
  void makeRoom(std::size_t bytes);

  GzInput& file_;
  std::vector<char> held_;
  std::size_t begin_ = 0;  //!< of the object
  std::size_t at_ = 0;
  std::size_t end_ = 0;  //!< of what was read
};
}  // namespace dyslam
