// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/nets/Devices.h>
#include <torch/torch.h>

namespace dyslam
{
torch::Device deviceNamed(const std::string& name, const std::string& setting)
{
  if (name != "cpu" && name != "cuda")
  {
    throw UserError(setting + " " + name + ": choose cpu or cuda");
  }
  if (name == "cuda" && !torch::cuda::is_available())
  {
    throw UserError(setting + " cuda: this machine or this libtorch has no CUDA; use cpu");
  }
  return name == "cuda" ? torch::kCUDA : torch::kCPU;
}
}  // namespace dyslam
