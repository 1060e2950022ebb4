// tests/burnish_test.h -- Catch2, version 2 (one header) or 3 (a library)
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <random>
#include <sstream>
#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_approx.hpp>
#include <catch2/catch_message.hpp>
#include <catch2/catch_template_test_macros.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators_all.hpp>
#include <catch2/matchers/catch_matchers_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>  // brings Approx itself
#endif
