// examples/02_write_a_node.cpp -- a procedural material of one's own, and its numbers found again from a picture
// SPDX-License-Identifier: Apache-2.0
//
// Needs a compiler and nothing else: c++ -std=c++20 -O2 -march=native -I include examples/02_write_a_node.cpp
#include <cstdio>
#include <burnish/fit/adam.h>
#include <burnish/fit/render.h>
#include <burnish/math/noise.h>
#include <burnish/nodes/surface.h>
#include "program.h"
#include "progress.h"

using namespace burnish;

/// Boards that run along u with gaps between them, over uv in metres.
template <class T> struct Planks {
  vec3<T> wood = {0.42f, 0.28f, 0.16f};  // linear RGB albedo
  T width = 0.12f, gap = 0.004f;         // metres
  T wear = 0.04f;                        // metres over which a board darkens towards its edge
  T grain = 0.2f, tone = 0.1f;           // how far the grain darkens, and how far boards differ

  static constexpr auto parameters() {
    return std::tuple{Param{"wood", &Planks::wood, unit},
                      Param{"width", &Planks::width, Range{0.05f, 0.3f}},
                      Param{"gap", &Planks::gap, Range{0.001f, 0.02f}},
                      Param{"wear", &Planks::wear, Range{0.005f, 0.05f}},
                      Param{"grain", &Planks::grain, unit},
                      Param{"tone", &Planks::tone, unit}};
  }

  constexpr Surface<T> operator()(const vec2<T>& uv) const {
    const T board = floor(uv.y / width), across = uv.y - board * width;
    const T inside = min(across, width - across) - 0.5f * gap;  // metres from the gap
    const T fibre = fractal2d(vec2<T>(uv.x * 4.0f + board * 17.3f, uv.y * 90.0f), 3.0f, 2.0f, 0.6f).value;
    const T other = noise2d(vec2<T>(board * 2.7f + 0.4f, T(0.3f))).value;

    Surface<T> s;
    s.base_color = wood * (smoothstep(0.0f, wear, inside) * (1.0f + grain * fibre) * (1.0f + tone * other));
    s.specular_roughness = 0.5f + 0.2f * fibre;
    return s;
  }
};

/// A pixel of the picture that is to be matched.
template <class T> struct Pixel {
  vec2<T> uv;
  vec3<T> color;
  static constexpr auto parameters() { return std::tuple{Param{"uv", &Pixel::uv}, Param{"color", &Pixel::color}}; }
};

void print(const char* title, const Planks<float>& planks) {
  std::printf("%-8s", title);
  for_each_parameter(planks, [](const std::string&, float x, Range) { std::printf("%8.4f", double(x)); });
  std::printf("\n");
}

void run(const std::string& output, int size, int steps) {
  program::make_folder(output);
  const auto uv_of = [size](int x, int y) { return vec2<float>(x + 0.5f, y + 0.5f) * (0.5f / size); };  // half a metre

  // The picture to match is made with numbers that the fit does not know.
  Planks<float> truth;
  truth.wood = {0.29f, 0.13f, 0.06f};
  truth.width = 0.105f, truth.gap = 0.003f, truth.wear = 0.012f, truth.grain = 0.4f, truth.tone = 0.8f;
  Planes<Pixel> pixels(size * size);
  for (int i = 0; i < pixels.size(); ++i) {
    const vec2<float> uv = uv_of(i % size, i / size);
    pixels.set(i, {uv, truth(uv).base_color});
  }

  // How far one pixel is off. The compiler records it, node and all, and makes straight code for value and gradient.
  const auto distance = [](const auto& planks, const auto& pixel) {
    const auto off = planks(pixel.uv).base_color - pixel.color;
    return dot(off, off);
  };

  // The width is found from 0.095 to 0.13; a lattice further off sticks, and wants a better start.
  const Planks<float> before;
  Planks<float> planks = before;
  Adam adam{.rate = 0.02f};
  Progress progress("fit");
  std::string error;
  for (int step = 1; step <= steps; ++step) {
    const auto [sum, d_planks] = sum_and_gradient(pixels, distance, planks);
    adam.step(planks, d_planks);
    error = "rms error " + std::to_string(std::sqrt(sum / (3.0 * pixels.size())));
    progress.show(step, steps, error);
  }
  progress.finish(error);

  std::printf("%8s", "");
  for_each_parameter(planks, [](const std::string& name, float, Range) { std::printf("%8s", name.c_str()); });
  std::printf("\n");
  print("before", before);
  print("target", truth);
  print("after", planks);
  const Planks<float> panels[] = {before, truth, planks};
  program::write_row_png(output + "/planks.png", 3, size, size,
                         [&](int k, int x, int y) { return panels[k](uv_of(x, y)).base_color; });
  std::printf("The picture, before | target | after: %s/planks.png\n", output.c_str());
}

int main(int argc, char** argv) {
  std::string output = "burnish-planks";
  int size = 256, steps = 300;
  return program::main(argc, argv, "Writes a material of wooden planks and finds its numbers again from a picture.",
                       {{"--output", "FOLDER", "where planks.png goes", &output},
                        {"--size", "N", "pixels along the picture's edge", &size, 16, 2048},
                        {"--steps", "N", "of the fit", &steps, 1, 10000}},
                       [&] { run(output, size, steps); });
}
