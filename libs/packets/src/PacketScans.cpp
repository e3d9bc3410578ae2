// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/packets/PacketScans.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double whole_tolerance = 3.0 / 360;  //!< part that a complete revolution may lack [turns]
constexpr int turn = 36000;                    //!< a revolution [0.01 deg]
constexpr int largest_jitter = 100;            //!< of azimuths, against the rotation [0.01 deg]
constexpr double longest_turn = 0.2;           //!< of the slowest lidars [s]
constexpr double longest_delay = 0.02;         //!< of packets that others overtake [s]

bool near(double a, double b)
{
  return std::abs(a - b) <= whole_tolerance;
}
}  // namespace

std::vector<std::uint16_t> ringsByElevation(const std::vector<double>& elevations)
{
  std::vector<std::size_t> order(elevations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&elevations](std::size_t a, std::size_t b)
                   { return elevations[a] < elevations[b]; });
  std::vector<std::uint16_t> rings(elevations.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank)
  {
    rings[order[rank]] = static_cast<std::uint16_t>(rank);
  }
  return rings;
}

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

RevolutionCutter::RevolutionCutter(double cut_azimuth, bool keep_partial)
    : cut_(static_cast<int>(std::lround(cut_azimuth * 18000 / M_PI)) % turn), queue_(keep_partial)
{
}

bool RevolutionCutter::isLate(int onward, double stamp) const
{
  const double age = last_stamp_ - stamp;
  return age > 0 && age < longest_delay && onward > turn / 2;
}

Scan& RevolutionCutter::scanOf(int azimuth, double stamp)
{
  const int from_cut = (azimuth + turn - cut_) % turn;
  const int last = last_azimuth_.value_or(from_cut);
  const int clockwise = (from_cut - last + turn) % turn;
  steps_ += clockwise == 0 ? 0 : clockwise < turn / 2 ? 1 : -1;
  const int onward = isClockwise() ? clockwise : (turn - clockwise) % turn;
  if (onward > turn - largest_jitter || isLate(onward, stamp))
  {
    return scan_;
  }
  // A lidar may leave out most of the turn, so a step of any size leads on.
  const bool passes_cut = isClockwise() ? from_cut < last : from_cut > last;
  if (passes_cut || stamp - last_stamp_ > longest_turn)
  {
    push();
  }
  if (!begun_)
  {
    begun_ = true;
    scan_.stamp = stamp;
    first_azimuth_ = from_cut;
  }
  last_azimuth_ = from_cut;
  last_stamp_ = stamp;
  return scan_;
}

void RevolutionCutter::push()
{
  if (begun_)
  {
    queue_.push(std::exchange(scan_, Scan{}), static_cast<double>(first_azimuth_) / turn,
                static_cast<double>(*last_azimuth_) / turn);
  }
  begun_ = false;
}

void RevolutionCutter::finish()
{
  push();
  queue_.finish();
}
}  // namespace dyslam
