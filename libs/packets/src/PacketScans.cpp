// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/packets/PacketScans.h>

#include <cmath>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double whole_tolerance = 3.0 / 360;  //!< that a whole revolution may lack [turns]

bool near(double a, double b)
{
  return std::abs(a - b) <= whole_tolerance;
}
}  // namespace

void RevolutionQueue::push(Scan scan, double begin, double end)
{
  if (++pushed_ == 2)
  {
    usual_begin_ = begin;
  }
  waiting_.push_back({std::move(scan), begin, end});
}

bool RevolutionQueue::isWhole(const Revolution& revolution, bool first, bool last) const
{
  return keep_partial_ || ((!first || near(revolution.begin, usual_begin_)) &&
                           (!last || near(revolution.end, usual_end_)));
}

std::optional<Scan> RevolutionQueue::take()
{
  while (waiting_.size() > 1 || (finished_ && !waiting_.empty()))
  {
    Revolution revolution = std::move(waiting_.front());
    waiting_.pop_front();
    const bool first = taken_++ == 0;
    const bool last = waiting_.empty();
    const bool whole = isWhole(revolution, first, last);
    if (!first && !last)
    {
      usual_end_ = revolution.end;
    }
    if (whole)
    {
      return std::move(revolution.scan);
    }
  }
  return std::nullopt;
}
}  // namespace dyslam
