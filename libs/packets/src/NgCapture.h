// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace dyslam
{
/** A frame of a network capture, as it was received. */
struct CapturedFrame
{
  int link = 0;           //!< type of the link layer (DLT_ of libpcap)
  double captured = 0;    //!< time of reception, UNIX time, to the microsecond [s]
  const char* data = "";  //!< valid until the next frame
  std::size_t size = 0;   //!< [bytes]
};

/** The frames of a .pcapng one by one, of all interfaces; libpcap reads those of interfaces like
 * the first one only.
 *
 * Format: https://www.ietf.org/archive/id/draft-ietf-opsawg-pcapng-02.html */
class NgCapture
{
 public:
  /** Whether a file begins as a .pcapng. \throws UserError if it can't be read. */
  [[nodiscard]] static bool isOne(const std::string& path);

  /** \throws UserError if the file can't be read. */
  explicit NgCapture(const std::string& path);

  /** Reads the next frame; false at the end of the file and at damage, see damage(). */
  [[nodiscard]] bool next(CapturedFrame& frame);
  /** Reason why the file cannot be read further; empty if it can, or has ended. */
  [[nodiscard]] const std::string& damage() const { return damage_; }
  /** Number of bytes that were read. */
  [[nodiscard]] std::uint64_t position() const { return position_; }

 private:
  struct Interface
  {
    int link = 0;
    std::uint32_t longest = 0;  //!< longest part of a frame that is kept; 0: all [bytes]
    std::uint64_t units_per_second = 1000000;
    std::int64_t offset = 0;  //!< of its clock from UNIX time [s]
  };

  [[nodiscard]] bool readBlock();
  [[nodiscard]] bool beginSection();
  [[nodiscard]] bool addInterface();
  [[nodiscard]] bool fillOption(std::size_t code, std::size_t at, std::size_t size, Interface& to);
  [[nodiscard]] bool fillFrame(std::size_t interface, CapturedFrame& frame);
  [[nodiscard]] bool fillSimpleFrame(CapturedFrame& frame);
  [[nodiscard]] bool fail(const std::string& reason);
  /** A number of the block's body. \pre the body has it */
  template <typename T>
  [[nodiscard]] T number(std::size_t at) const;

  std::ifstream file_;
  std::uint64_t position_ = 0;
  std::uint32_t type_ = 0;             //!< of the block
  std::string body_;                   //!< of the block
  bool is_swapped_ = false;            //!< the section has the other byte order
  std::vector<Interface> interfaces_;  //!< of the section
  std::string damage_;
};
}  // namespace dyslam
