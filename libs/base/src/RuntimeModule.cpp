// SPDX-License-Identifier: BSD-3-Clause
#include <dlfcn.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Parallel.h>
#include <dyslam/base/RuntimeModule.h>
#include <dyslam/base/Version.h>
#include <dyslam/base/Words.h>

#include <vector>

#include "ProgramFolders.h"

namespace dyslam
{
namespace
{
/** Message of dlerror() without the path, which every message of ours has already. */
std::string loadError(const std::string& path)
{
  const char* said = dlerror();
  std::string text = said != nullptr ? said : "cannot be loaded";
  if (text.rfind(path + ": ", 0) == 0)
  {
    text.erase(0, path.size() + 2);
  }
  return text;
}

std::string fileOf(const std::string& module)
{
  return "libdyslam-" + module + ".so";
}

std::vector<std::filesystem::path> moduleFolders()
{
  std::vector<std::filesystem::path> folders =
      ProgramFolders{"DYSLAM_MODULES", DYSLAM_BUILD_MODULES, DYSLAM_RELATIVE_MODULES,
                     DYSLAM_INSTALLED_MODULES}
          .candidates();
  if (const std::string share = environmentValue("DYSLAM_SHARE"); !share.empty())
  {
    // For programs outside an installation whose prefix is not the configured one.
    const auto prefix = std::filesystem::absolute(share) / ".." / "..";
    folders.push_back((prefix / DYSLAM_RELATIVE_MODULES).lexically_normal());
  }
  return folders;
}

/** Whether this machine has AVX2, FMA and BMI2, unless $DYSLAM_CPU is `baseline`. */
bool usesV3()
{
#ifdef __x86_64__
  return environmentValue("DYSLAM_CPU") != "baseline" && __builtin_cpu_supports("avx2") != 0 &&
         __builtin_cpu_supports("fma") != 0 && __builtin_cpu_supports("bmi2") != 0;
#else
  return false;
#endif
}

/** Runs TBB's first loop, which loads a library of TBB's: later it would wait until the module is
 * loaded. */
void startThreadPools()
{
  ThreadPool pool(0);
  pool.forChunks(static_cast<std::size_t>(pool.size()), 1,
                 [](std::size_t, std::size_t, std::size_t) {});
}

std::string notFound(const std::string& module, const std::string& needed_by)
{
  std::string tried;
  for (const auto& folder : moduleFolders())
  {
    appendWord(tried, folder.string());
  }
  const std::string origin = module == "networks" ? "which a build with libtorch has"
                             : module == "ros2"
                                 ? "which a build with Fast DDS (package libfastrtps-dev) has"
                                 : "which is installed with the programs";
  return needed_by + " needs " + fileOf(module) + ", " + origin + ", and which is not in " + tried;
}
}  // namespace

std::string runtimeModuleFile(const std::string& module)
{
  const std::vector<std::string> variants =
      usesV3() ? std::vector<std::string>{"x86-64-v3", ""} : std::vector<std::string>{""};
  for (const auto& folder : moduleFolders())
  {
    for (const std::string& variant : variants)
    {
      const auto file = folder / variant / fileOf(module);
      if (std::filesystem::is_regular_file(file))
      {
        return file.string();
      }
    }
  }
  return "";
}

void* runtimeModuleFunction(const std::string& module,
                            const std::string& function,
                            const std::string& needed_by)
{
  const std::string path = runtimeModuleFile(module);
  if (path.empty())
  {
    throw UserError(notFound(module, needed_by));
  }
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
  {
    throw UserError(path + ": " + loadError(path));
  }
  auto* version = reinterpret_cast<RuntimeModuleVersion*>(dlsym(library, "dyslam_module_version"));
  const std::string found = version != nullptr ? version() : "unknown";
  if (found != DYSLAM_VERSION)
  {
    throw UserError(path + ": is of version " + found + ", the program of " + DYSLAM_VERSION +
                    "; install both from one build");
  }
  void* address = dlsym(library, function.c_str());
  if (address == nullptr)
  {
    throw UserError(path + ": has no function " + function);
  }
  return address;
}

std::future<void> loadRuntimeModuleAhead(const std::string& module)
{
  startThreadPools();
  return std::async(std::launch::async,
                    [path = runtimeModuleFile(module)]
                    {
                      if (!path.empty())
                      {
                        (void)dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
                      }
                    });
}
}  // namespace dyslam
