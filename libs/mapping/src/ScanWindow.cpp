// SPDX-License-Identifier: BSD-3-Clause
#include "ScanWindow.h"

#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Pose.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "HindsightParameters.h"

namespace dyslam
{
namespace
{
/** Distances from the current scan to the scans used: all near scans, fewer far ones [scans]. */
std::vector<int> scanOffsets(int window)
{
  std::vector<int> offsets;
  for (int o = 1; o <= window; o += std::clamp(o / 2, 1, hindsight::largest_step))
  {
    offsets.push_back(o);
  }
  return offsets;
}
}  // namespace

ScanWindow::WindowScan::WindowScan(const Frame& given, FrameParts kept)
    : index(given.index),
      T_odom_vehicle(given.T_odom_vehicle),
      rays(given.scan, given.cloud),
      lowest(given.cloud.points, T_odom_vehicle.cast<float>())
{
  if (kept != FrameParts::none)
  {
    frame = copyOf(given, kept);
  }
}

void ScanWindow::WindowScan::exchangeState(StateArchive& archive)
{
  archive(frame, index, T_odom_vehicle, rays, lowest);
}

void ScanWindow::LastingTracks::note(int track, bool has_property, std::size_t index)
{
  if (has_property || contain(track))
  {
    last_[track] = index;
  }
}

void ScanWindow::LastingTracks::forgetBefore(std::size_t index)
{
  for (auto track = last_.begin(); track != last_.end();)
  {
    track = track->second < index ? last_.erase(track) : std::next(track);
  }
}

void ScanWindow::LastingTracks::exchangeState(StateArchive& archive)
{
  archive(last_);
}

ScanWindow::ScanWindow(int scans, int history)
    : size_(static_cast<std::size_t>(scans)),
      history_(static_cast<std::size_t>(history)),
      offsets_(scanOffsets(scans))
{
}

void ScanWindow::add(const Frame& frame, FrameParts kept)
{
  for (const TrackedObject& object : frame.objects)
  {
    dynamic_.note(object.id, object.confirmed && object.dynamic, frame.index);
    reported_.note(object.id, object.reported, frame.index);
  }
  scans_.emplace_back(frame, kept);
  ++added_;
}

std::optional<Frame> ScanWindow::takeFrame()
{
  return std::exchange(scans_[current_].frame, std::nullopt);
}

void ScanWindow::advance()
{
  ++current_;
  if (current_ > size_)
  {
    dropOldest();
  }
}

void ScanWindow::dropOldest()
{
  const std::size_t number = added_ - scans_.size();
  if (number % hindsight::earlier_step == 0 && history_ > 0)
  {
    earlier_.push_back({number, scans_.front().T_odom_vehicle, std::move(scans_.front().rays)});
  }
  while (!earlier_.empty() && number - earlier_.front().number > history_)
  {
    earlier_.pop_front();
  }
  scans_.pop_front();
  --current_;
  dynamic_.forgetBefore(scans_.front().index);
  reported_.forgetBefore(scans_.front().index);
}

std::vector<OtherScan> ScanWindow::others() const
{
  const Pose& here = scans_[current_].T_odom_vehicle;
  std::vector<OtherScan> result;
  const auto add = [&](const Pose& there, const ScanVisibility& rays, bool after)
  {
    const Eigen::Isometry3f T_other_this = (there.inverse() * here).cast<float>();
    result.push_back({&rays, T_other_this, after});
  };
  for (const int offset : offsets_)
  {
    for (const int step : {-offset, offset})
    {
      const auto position = static_cast<std::ptrdiff_t>(current_) + step;
      if (position >= 0 && position < static_cast<std::ptrdiff_t>(scans_.size()))
      {
        const WindowScan& other = scans_[static_cast<std::size_t>(position)];
        add(other.T_odom_vehicle, other.rays, step > 0);
      }
    }
  }
  auto farthest = static_cast<double>(offsets_.back());  // distance of the farthest scan so far
  for (auto other = earlier_.rbegin(); other != earlier_.rend(); ++other)
  {
    const auto distance = static_cast<double>(number() - other->number);
    if (distance >= hindsight::earlier_growth * farthest)
    {
      add(other->T_odom_vehicle, other->rays, false);
      farthest = distance;
    }
  }
  return result;
}

std::vector<const LowestReturns*> ScanWindow::lowestReturns() const
{
  std::vector<const LowestReturns*> result;
  for (std::size_t i = current_ % hindsight::ground_step; i < scans_.size();
       i += hindsight::ground_step)
  {
    result.push_back(&scans_[i].lowest);
  }
  return result;
}

void ScanWindow::exchangeState(StateArchive& archive)
{
  archive(scans_, earlier_, current_, added_, dynamic_, reported_);
}
}  // namespace dyslam
