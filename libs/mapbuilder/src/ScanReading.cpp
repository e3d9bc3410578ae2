// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/mapbuilder/ScanReading.h>
#include <dyslam/odometry/ScanClock.h>

#include <optional>
#include <utility>

namespace dyslam
{
std::string readScans(RawlogSource& source,
                      const std::string& purpose,
                      MapListener& listener,
                      const std::function<void(Frame)>& use)
{
  listener.beginReading(purpose);
  ScanClock clock;
  std::optional<Frame> first;  // until the second shows how long a sweep takes
  const auto use_first = [&](double sweep_duration)
  {
    if (first)
    {
      first->sweep_duration = sweep_duration;
      use(std::move(*first));
      first.reset();
    }
  };
  for (bool started = false;; started = true)
  {
    std::optional<Frame> frame;
    try
    {
      frame = source.next();
    }
    catch (const UserError& error)
    {
      use_first(0);
      return error.what();  // the map of the scans before it is kept
    }
    if (!frame)
    {
      use_first(0);
      listener.finish(source.framesRead());
      return {};
    }
    frame->sweep_duration = clock.nextSweep(frame->scan.stamp);
    if (!started)
    {
      first = std::move(frame);
      continue;
    }
    use_first(frame->sweep_duration);
    use(std::move(*frame));
    listener.update(source.progress(), source.framesRead());
  }
}

std::string readScansAndWarn(RawlogSource& source,
                             const std::string& purpose,
                             MapListener& listener,
                             const std::function<void(Frame)>& use)
{
  std::string damage = readScans(source, purpose, listener, use);
  for (const auto& warning : source.warnings())
  {
    listener.warn(warning);
  }
  return damage;
}
}  // namespace dyslam
