// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Registry.h>
#include <dyslam/base/RuntimeModule.h>
#include <dyslam/odometry/Dylo.h>
#include <dyslam/odometry/ScanMatcher.h>

#include "ConstantMotion.h"
#include "GicpMatcher.h"
#include "IcpMatcher.h"
#include "LoamMatcher.h"

namespace dyslam
{
namespace
{
using Matcher = std::unique_ptr<ScanMatcher>;
using Factory = Registry<ScanMatcher>::Factory;

Factory simple(ConstantMotion::Kind kind)
{
  return [kind](ThreadPool&) -> Matcher { return std::make_unique<ConstantMotion>(kind); };
}

template <typename IcpSectionOptions>
Factory icp(const IcpSectionOptions& options, IcpMatcher::Residual residual)
{
  return [=](ThreadPool& pool) -> Matcher
  { return std::make_unique<IcpMatcher>(residual, options, pool); };
}

Factory loam(const LoamOptions& options, bool mapping)
{
  return [=](ThreadPool& pool) -> Matcher
  { return std::make_unique<LoamMatcher>(mapping, options, pool); };
}

Factory gicp(const GicpOptions& options)
{
  return [=](ThreadPool& pool) -> Matcher { return std::make_unique<GicpMatcher>(options, pool); };
}

Factory dylo(const DyloOptions& given)
{
  return [=](ThreadPool& pool) -> Matcher
  {
    DyloOptions options = given;
    options.threads = given.threads > 0 ? given.threads : pool.size();
    auto* make = runtimeModuleFunction<MakeDyloMatcher>("networks", "dyslam_make_dylo_matcher",
                                                        "odometry.method: dylo");
    return Matcher(make(options));
  };
}

/** One row per matcher. */
Registry<ScanMatcher> matchers()
{
  using Simple = ConstantMotion::Kind;
  using Residual = IcpMatcher::Residual;
  return Registry<ScanMatcher>({
      {"constant_velocity", [](ConfigLoader&) { return simple(Simple::constant_velocity); }},
      {"zero_motion", [](ConfigLoader&) { return simple(Simple::zero_motion); }},
      {"icp_po2po", [](ConfigLoader& c)
       { return icp(c.get<IcpPointToPointOptions>("icp_po2po"), Residual::point_to_point); }},
      {"icp_po2pl", [](ConfigLoader& c)
       { return icp(c.get<IcpOptions>("icp_po2pl"), Residual::point_to_plane); }},
      {"gicp", [](ConfigLoader& c) { return gicp(c.get<GicpOptions>("gicp")); }},
      {"loam_no_mapping",
       [](ConfigLoader& c) { return loam(c.get<LoamNoMappingOptions>("loam_no_mapping"), false); }},
      {"loam", [](ConfigLoader& c) { return loam(c.get<LoamOptions>("loam"), true); }},
      {"dylo", [](ConfigLoader& c) { return dylo(c.get<DyloOptions>("dylo")); },
       /*needs_networks=*/true},
  });
}
}  // namespace

std::vector<std::string> scanMatcherNames()
{
  return matchers().names();
}

bool scanMatcherNeedsNetworks(const std::string& name)
{
  return matchers().needsNetworks(name);
}

std::unique_ptr<ScanMatcher> makeScanMatcher(const std::string& name,
                                             ConfigLoader& config,
                                             ThreadPool& pool)
{
  return matchers().make(name, "odometry.method", config, pool);
}
}  // namespace dyslam
