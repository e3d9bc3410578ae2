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
  /** Largest size of one object [bytes]. */
  static constexpr std::size_t largest = std::size_t{1} << 28U;

  /** \param file must outlive the window. */
  explicit ByteWindow(GzInput& file) : file_(file) {}

  /** Drops the bytes passed so far. */
  void begin();
  /** Passes `count` bytes. \throws std::runtime_error if they are missing, or too many. */
  void skip(std::uint64_t count);
  /** Passes `count` elements of `size` bytes each. */
  void skipAll(std::uint64_t count, std::uint64_t size);
  [[nodiscard]] std::uint8_t u8();
  [[nodiscard]] std::uint16_t u16();
  [[nodiscard]] std::uint32_t u32();
  /** Passes a text: length as uint32, then its bytes. */
  [[nodiscard]] std::string_view text();

  /** Present position, in bytes since begin(). */
  [[nodiscard]] std::size_t at() const { return at_ - begin_; }
  /** The bytes from `from` to the present position; valid until the next call. */
  [[nodiscard]] std::string_view since(std::size_t from) const;
  /** Removes the bytes from `from` to the present position. */
  void erase(std::size_t from);
  /** Returns to an earlier position of the object. \param place in bytes since begin() */
  void rewind(std::size_t place) { at_ = begin_ + place; }
  /** Overwrites a byte that was passed. */
  void replace(std::size_t place, std::uint8_t value);
  /** The bytes ahead, at least `wanted` unless the file ends; valid until the next call. */
  [[nodiscard]] std::string_view ahead(std::size_t wanted);
  /** Moves to a position in the bytes ahead and drops those before it. */
  void passAhead(std::size_t count);

 private:
  void makeRoom(std::size_t bytes);

  GzInput& file_;
  std::vector<char> held_;
  std::size_t begin_ = 0;  //!< begin of the object
  std::size_t at_ = 0;
  std::size_t end_ = 0;  //!< end of the bytes that were read
};
}  // namespace dyslam
