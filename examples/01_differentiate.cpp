// examples/01_differentiate.cpp -- the derivative of any templated function, and whether it is right
// SPDX-License-Identifier: Apache-2.0
//
// Needs a compiler and nothing else: c++ -std=c++20 -O1 -I include examples/01_differentiate.cpp
#include <iomanip>
#include <iostream>
#include <string_view>
#include <burnish/ad/check.h>
#include <burnish/ad/dual.h>
#include <burnish/math/color.h>

using namespace burnish;

/// Any struct of numbers that names its members is something to differentiate by.
template <class T> struct Varnish {
  vec3<T> stain = {0.6f, 0.3f, 0.1f};  // what one millimetre lets through, linear RGB
  T thickness = 2.0f;                  // millimetres
  static constexpr auto parameters() {
    return std::tuple{Param{"stain", &Varnish::stain, unit}, Param{"thickness", &Varnish::thickness, Range{0, 5}}};
  }
  T brightness() const {
    return luminance(vec3<T>(pow(stain.x, thickness), pow(stain.y, thickness), pow(stain.z, thickness)));
  }
};

/// An operation of one's own: its value, and what an adjoint d becomes on its way back. y is the value, x the input.
struct Softplus : Operation<1> {
  template <class T> static constexpr T value(T x) { return log(1.0f + exp(x)); }
  template <class T> static constexpr Back<T, 1> back(T d, T, T x) { return {d / (1.0f + exp(-x))}; }
};

int run() {
  std::cout << std::setprecision(6);

  // A function: its value, then its derivative by every argument.
  const auto [z, dz_dx, dz_dy] = differentiate([](auto x, auto y) { return sin(x) * exp(x * y); }, 0.5, 2.0);
  std::cout << "sin(x) exp(x y) at (0.5, 2) " << z << ", by x " << dz_dx << ", by y " << dz_dy << "\n";

  // A struct: its derivative is a struct of the same type.
  const Varnish<double> varnish;
  const auto brightness = [](const auto& v) { return v.brightness(); };
  const auto [light, d] = differentiate(brightness, varnish);
  std::cout << "varnish lets through        " << light << ", by thickness " << d.thickness << ", by stain ("
            << d.stain.x << ", " << d.stain.y << ", " << d.stain.z << ")\n";

  // The operation above; every way of differentiating knows it from here on.
  const auto softplus = [](auto x) { return apply<Softplus>(x); };
  const auto [s, ds_dx] = differentiate(softplus, 0.5);
  std::cout << "softplus at 0.5             " << s << ", slope " << ds_dx << "\n";

  // Few inputs, many outputs: duals carry the slopes forward. Here red, green and blue by hue, saturation and value.
  using D = Dual<double, 3>;
  const vec3<D> rgb = hsvtorgb(vec3<D>{D(0.1, 0), D(0.8, 1), D(0.9, 2)});
  std::cout << "hsv (0.1, 0.8, 0.9) as rgb, each with its slopes by h, s, v\n";
  for (const D& c : {rgb.x, rgb.y, rgb.z}) {
    std::cout << std::setw(14) << c.value << "  |";
    for (const double slope : c.slope) std::cout << std::setw(10) << slope;
    std::cout << "\n";
  }

  // Is it right? Differences in double say, or say that they cannot: here the edge of max lies within their steps.
  const auto hinge = [](auto x) { return max(x, 0) * 3.0f; };
  std::cout << "checked: the varnish is " << check_gradient(brightness, varnish).text() << "\n"
            << "checked: softplus is " << check_gradient(softplus, 0.5).text() << "\n"
            << "checked: max(x, 0) near its edge is " << check_gradient(hinge, 1e-5).text() << "\n";
  return 0;
}

int main(int argc, char** argv) {
  if (argc == 1) return run();
  const bool help = argc == 2 && std::string_view(argv[1]) == "--help";
  if (help) std::cout << "Derivatives of functions and structs, and a checker of them.\n\nusage: 01_differentiate\n";
  else std::cerr << "01_differentiate: takes no arguments but --help\n";
  return help ? 0 : 2;
}
