// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/RuntimeModule.h>

#ifndef TEST_MODULE_CPU
#define TEST_MODULE_CPU "any"
#endif

// A module to load in RuntimeModule_unittest.cpp, of the version TEST_MODULE_VERSION.
extern "C"
{
  dyslam::RuntimeModuleVersion dyslam_module_version;
  int dyslam_test_square(int x);
  const char* dyslam_test_cpu();

  const char* dyslam_module_version()
  {
    return TEST_MODULE_VERSION;
  }

  int dyslam_test_square(int x)
  {
    return x * x;
  }

  const char* dyslam_test_cpu()
  {
    return TEST_MODULE_CPU;
  }
}
