// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace dyslam
{
/** Address of IPv6, or of IPv4 in the last four bytes. */
using IpAddress = std::array<std::uint8_t, 16>;

/** A fragment of an IP datagram (RFC 791, RFC 8200). */
struct IpFragment
{
  IpAddress sender{};
  IpAddress receiver{};
  std::uint32_t number = 0;  //!< number of the datagram, the same in all its fragments
  std::size_t offset = 0;    //!< offset of the data in the datagram [bytes]
  bool more = false;         //!< further fragments follow in the datagram
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  //!< size of the data [bytes]
};

/** Reassembles IP datagrams, whose fragments may come in any order. */
class FragmentedDatagrams
{
 public:
  /** Fragments of others that an incomplete datagram outlasts: its number will be used again. */
  static constexpr std::uint64_t longest_wait = 4096;
  static constexpr std::size_t most = 64;  //!< largest number of incomplete datagrams that are kept

  /** \return the data of the datagram, behind its IP header, once all of it is there. */
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> add(const IpFragment& fragment);

 private:
  struct Datagram
  {
    IpAddress sender;
    IpAddress receiver;
    std::uint32_t number;
    std::uint64_t begun;  //!< number of fragments added before its first one
    std::vector<std::uint8_t> data;
    std::vector<bool> units;          //!< received, of eight bytes each
    std::optional<std::size_t> size;  //!< known with the fragment that none follows [bytes]
  };
  [[nodiscard]] std::deque<Datagram>::iterator datagramOf(const IpFragment& fragment);

  std::deque<Datagram> incomplete_;
  std::uint64_t added_ = 0;  //!< number of fragments added
};
}  // namespace dyslam
