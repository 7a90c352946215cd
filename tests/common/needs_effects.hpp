#pragma once

#include <gtest/gtest.h>

#include "libsim/scene/effects.hpp"

/// Skips the rest of a test if the program was built without effects.
#define NEEDS_EFFECTS \
  if (!sim::has_effects()) GTEST_SKIP() << "built with -DVIP_EFFECTS=OFF"
