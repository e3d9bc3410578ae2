// SPDX-License-Identifier: BSD-3-Clause
#include "FragmentedDatagrams.h"

#include <algorithm>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::size_t largest_datagram = 65535;  // [bytes]
constexpr std::size_t unit = 8;                  // of the offsets of fragments [bytes]
}  // namespace

std::deque<FragmentedDatagrams::Datagram>::iterator FragmentedDatagrams::datagramOf(
    const IpFragment& fragment)
{
  while (!incomplete_.empty() &&
         (added_ - incomplete_.front().begun > longest_wait || incomplete_.size() > most))
  {
    incomplete_.pop_front();
  }
  const auto found = std::find_if(incomplete_.begin(), incomplete_.end(),
                                  [&fragment](const Datagram& datagram)
                                  {
                                    return datagram.number == fragment.number &&
                                           datagram.sender == fragment.sender &&
                                           datagram.receiver == fragment.receiver;
                                  });
  if (found != incomplete_.end())
  {
    return found;
  }
  incomplete_.push_back({fragment.sender, fragment.receiver, fragment.number, added_, {}, {}, {}});
  return std::prev(incomplete_.end());
}

std::optional<std::vector<std::uint8_t>> FragmentedDatagrams::add(const IpFragment& fragment)
{
  const std::size_t end = fragment.offset + fragment.size;
  if (end > largest_datagram)
  {
    return std::nullopt;
  }
  ++added_;
  const auto datagram = datagramOf(fragment);
  datagram->data.resize(std::max(datagram->data.size(), end));
  std::copy(fragment.data, fragment.data + fragment.size,
            datagram->data.begin() + static_cast<std::ptrdiff_t>(fragment.offset));
  datagram->units.resize((datagram->data.size() + unit - 1) / unit);
  std::fill(datagram->units.begin() + static_cast<std::ptrdiff_t>(fragment.offset / unit),
            datagram->units.begin() + static_cast<std::ptrdiff_t>((end + unit - 1) / unit), true);
  if (!fragment.more)
  {
    datagram->size = end;
  }
  const auto& units = datagram->units;
  if (!datagram->size || std::find(units.begin(), units.end(), false) != units.end())
  {
    return std::nullopt;
  }
  std::vector<std::uint8_t> whole = std::move(datagram->data);
  incomplete_.erase(datagram);
  return whole;
}
}  // namespace dyslam
