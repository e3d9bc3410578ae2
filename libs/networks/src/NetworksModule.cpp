// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/RuntimeModule.h>
#include <dyslam/base/Version.h>
#include <dyslam/dyseg/NetworkSegmenter.h>
#include <dyslam/odometry/Dylo.h>

// The functions of the module `networks`, from which dyseg and odometry get their stages that need
// libtorch.
extern "C"
{
  dyslam::RuntimeModuleVersion dyslam_module_version;
  dyslam::MakeNetworkSegmenter dyslam_make_network_segmenter;
  dyslam::MakeDyloMatcher dyslam_make_dylo_matcher;

  const char* dyslam_module_version()
  {
    return DYSLAM_VERSION;
  }

  dyslam::MovingSegmenter* dyslam_make_network_segmenter(
      const dyslam::NetworkSegmenterOptions& options)
  {
    return new dyslam::NetworkSegmenter(options);
  }

  dyslam::ScanMatcher* dyslam_make_dylo_matcher(const dyslam::DyloOptions& options)
  {
    return dyslam::makeDyloMatcher(options).release();
  }
}
