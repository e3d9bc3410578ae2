// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Environment.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/RuntimeModule.h>
#include <dyslam/ros2/Ros2Domain.h>

namespace dyslam
{
Ros2DomainOptions Ros2DomainOptions::fromEnvironment()
{
  Ros2DomainOptions options;
  if (const std::string id = environmentValue("ROS_DOMAIN_ID"); !id.empty())
  {
    constexpr unsigned last = 232;  // the ports of higher ones are beyond 65535
    constexpr std::size_t most_digits = 3;
    const bool is_number = id.find_first_not_of("0123456789") == std::string::npos;
    options.id =
        is_number && id.size() <= most_digits ? static_cast<unsigned>(std::stoul(id)) : last + 1;
    if (options.id > last)
    {
      throw UserError("ROS_DOMAIN_ID=" + id + ": is no domain of ROS 2, which are 0 to " +
                      std::to_string(last));
    }
  }
  const std::string localhost_only = environmentValue("ROS_LOCALHOST_ONLY");
  options.localhost_only = (!localhost_only.empty() && localhost_only != "0") ||
                           environmentValue("ROS_AUTOMATIC_DISCOVERY_RANGE") == "LOCALHOST";
  return options;
}

std::unique_ptr<Ros2Domain> openRos2Domain(const std::string& needed_by,
                                           const Ros2DomainOptions& options)
{
  auto* open = runtimeModuleFunction<OpenRos2Domain>("ros2", "dyslam_open_ros2_domain", needed_by);
  return std::unique_ptr<Ros2Domain>(open(options));
}
}  // namespace dyslam
