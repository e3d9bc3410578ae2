// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <future>
#include <string>

namespace dyslam
{
/** A function of a runtime module, lib/dyslam/libdyslam-<module>.so, which is loaded when first
 * needed and stays loaded. A program that needs no network thus does not spend the time that
 * libtorch takes to load.
 *
 * The library is looked for in $DYSLAM_MODULES, then, for a program of the build folder, there; for
 * any other in the library folder beside the program's folder (an installed tree), then in the
 * prefix that DySLAM was configured to be installed in, then in that of $DYSLAM_SHARE. On a machine
 * with AVX2, FMA and BMI2 a build for these, in the folder `x86-64-v3` there, comes first, unless
 * $DYSLAM_CPU is `baseline`.
 * \param needed_by the setting that asks for it, for the message, e.g. "dyseg.method: network"
 * \throws UserError if there is no such library, if it cannot be loaded, or if it is of another
 * version than the program. */
[[nodiscard]] void* runtimeModuleFunction(const std::string& module,
                                          const std::string& function,
                                          const std::string& needed_by);

/** The file that runtimeModuleFunction() would load on this machine; empty if there is none. */
[[nodiscard]] std::string runtimeModuleFile(const std::string& module);

/** As runtimeModuleFunction(), as a pointer to a function of type F. */
template <typename F>
[[nodiscard]] F* runtimeModuleFunction(const std::string& module,
                                       const std::string& function,
                                       const std::string& needed_by)
{
  return reinterpret_cast<F*>(runtimeModuleFunction(module, function, needed_by));
}

/** Starts loading a module in another thread, so that a later runtimeModuleFunction() finds it
 * loaded; that call reports the errors. \return future to be kept until that call: its destructor
 * waits for the thread. */
[[nodiscard]] std::future<void> loadRuntimeModuleAhead(const std::string& module);

/** Version that every module exports as dyslam_module_version(). */
using RuntimeModuleVersion = const char*();
}  // namespace dyslam
