// examples/04_fit_material.cpp -- a street photo, a CAD vehicle and a panorama go in; a fitted car paint comes out
// SPDX-License-Identifier: Apache-2.0
//
// The way of the data: the vehicle is seen through the photo's camera (a G-buffer, once); the panorama's light is
// gathered for every pixel (once); then render, compare with the photo, go back, step, 300 times; at the end pictures
// and files.
#include <CLI/CLI.hpp>
#include <burnish/burnish.h>
#include <burnish/io/exr.h>
#include <burnish/io/model.h>
#include <burnish/io/report.h>
#include <burnish/scene/raycast.h>
#include "fitted.h"
#include "progress.h"
#include "shot.h"
#include "street.h"

using namespace burnish;
using fitted::Fitted, fitted::hold_back;
using parts::Role;
using shot::Shot, shot::World, shot::lit, shot::linear;
using street::Options, street::Photo, street::Inputs, street::both;

namespace {

// ---- what is fitted, and how it looks -------------------------------------------------------------------------------

/// What a camera makes of linear light: a shoulder above 0.8 instead of a hard clip, then the sRGB curve.
inline constexpr auto developed = []<class T>(const vec3<T>& light) {
  const auto film = [](const T& x) {
    const T over = max(x - 0.8f, 0.0f);
    return srgb_from_linear(min(x, 0.8f) + 0.2f * (1.0f - exp(over * -5.0f)));
  };
  return vec3<T>(film(light.x), film(light.y), film(light.z));
};
/// The light that a camera made this of; white itself is taken as 2.6.
float undeveloped(float x) {
  const float y = detail::from_srgb(x);
  return y < 0.8f ? y : 0.8f - 0.2f * std::log(std::max(1 - 5 * (y - 0.8f), 1e-4f));
}

inline constexpr auto painted = [](const auto& paint, const auto& at, const auto& light, const auto& suns,
                                   const auto& strength) {
  return developed(illuminate(paint(at), at, light, suns, strength));
};

/// A pane; the light that comes through it from behind, as a part of the sky's; and what it mirrors, as a part of the
/// panorama's: the real place is another one.
template <class T> struct Window {
  WindowGlass<T> glass;
  vec3<T> behind = {0.1f, 0.1f, 0.1f};
  T mirrored = 0.7f;
  static constexpr auto parameters() {
    return std::tuple{Param{"glass", &Window::glass}, Param{"behind", &Window::behind, unit},
                      Param{"mirrored", &Window::mirrored, unit}};
  }
};
inline constexpr auto glazed = [](const auto& window, const auto& at, const auto& light, const auto& suns,
                                  const auto& strength) {
  const auto surface = window.glass(at);
  const auto through = transmittance(surface, dot(at.normal, at.view)) * window.behind * strength.sky;
  return developed(illuminate(surface, at, light, suns, strength) * window.mirrored + through);
};
/// A look that is recorded when it runs: builds faster and plays slower; for the small parts.
template <class Look> struct AtRunTime {
  const Look* look;
  template <class... X> constexpr auto operator()(const X&... x) const { return (*look)(x...); }
};

struct Vehicle {
  CarPaint<float> paint;
  Window<float> window;
  Rubber<float> rubber;
};

/// Red, so that one sees what the fit does; hardly metallic, as most paints.
CarPaint<float> first_paint() {
  CarPaint<float> paint;
  paint.base_metalness = 0.1f;
  return paint;
}

/// The three fits at their start, or where an earlier one left them.
struct Fits {
  FitState<CarPaint<float>> paint;
  FitState<Window<float>> window;
  FitState<Rubber<float>> rubber;
};
template <class M> void resume(FitState<M>& state, const Options& o, const char* file, bool needed) {
  const std::string path = o.resume + "/" + file;
  if (!o.resume.empty() && (needed || std::filesystem::exists(path))) from_json(parse_json(path), state, path);
}
Fits begin(const Options& o) {
  Fits fits;
  const Vehicle start{first_paint(), {}, {}};
  fits.paint = FitState(start.paint, Adam{.rate = o.rate});
  fits.window = FitState(start.window, Adam{.rate = o.rate});
  fits.rubber = FitState(start.rubber, Adam{.rate = o.rate});
  for (const std::string& f : o.freeze) {
    bool known = false;
    const auto look = [&](const std::string& name, auto&, Range) { known |= name == f || name.rfind(f + ".", 0) == 0; };
    for_each_parameter(start.paint, look), for_each_parameter(start.window, look),
        for_each_parameter(start.rubber, look);
    if (!known) throw Error("--freeze " + f + ": no material has such a parameter");
  }
  resume(fits.paint, o, "paint.state.json", true), resume(fits.window, o, "glass.state.json", false),
      resume(fits.rubber, o, "rubber.state.json", false);
  return fits;
}

// ---- the light ------------------------------------------------------------------------------------------------------

/// Neutral on average, and as strong as a street of middling grey (albedo 0.2) must have been lit to give the photo's
/// mean brightness.
World world_of(const Options& o, const Inputs& in, const Image& panorama, float yaw) {
  World world{EnvironmentLight(panorama, yaw * pi / 180), {}, {}};
  const IrradianceMap irradiance(world.sky);
  vec3<float> mean;
  for (const vec3<float>& n : {vec3<float>{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    const auto e = irradiance(n);
    mean += vec3<float>(e[0], e[1], e[2]) * 0.2f;
    for (const Sun<float>& s : world.sky.suns) mean += s.power * (0.2f * std::max(0.0f, dot(n, s.direction)));
  }
  world.occluded = mean * (0.2f * inverse_pi);
  double brightness = 0;
  const int n = in.photo.image.width * in.photo.image.height;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < n; ++i) brightness += double(undeveloped(in.photo.image.plane(c)[i])) / (3.0 * n);
  const vec3<float> grey = vec3<float>(float(brightness) / (0.2f * inverse_pi)) / mean;
  world.strength.sky = world.strength.sun = o.exposure > 0 ? vec3<float>(o.exposure) : grey;
  return world;
}
/// How many times stronger the light must be for half of the paint's pixels to need no albedo above 0.8, the most that
/// paints have, in any channel; at least 1.
float white_point(const Shot& seen, const World& world, const Photo& photo) {
  const Mask overlap = both(photo.of(Role::paint), seen[Role::paint].frame("coverage"));
  CarPaint<float> white;
  white.base_color = {0.8f, 0.8f, 0.8f}, white.base_metalness = 0;
  const Image image = render(seen[Role::paint], lit(painted, seen, world), white);
  float most = 1;
  for (int c = 0; c < 3; ++c) {
    std::vector<float> ratio;
    for (std::size_t i = 0; i < overlap.values.size(); ++i)
      if (overlap.values[i] > 0.5f)
        ratio.push_back(undeveloped(photo.image.plane(c)[i]) / std::max(undeveloped(image.plane(c)[i]), 1e-4f));
    if (ratio.empty()) break;
    std::nth_element(ratio.begin(), ratio.begin() + std::ptrdiff_t(ratio.size() / 2), ratio.end());
    most = std::max(most, ratio[ratio.size() / 2]);
  }
  return std::min(most, 8.0f);
}

// ---- one part against the photo -------------------------------------------------------------------------------------

struct Weights {
  double aligned, statistics;
};
/// The paint lies on the paint; a wheel or a pane of another model does not lie on the photo's, so there the whole
/// part's mean and variance count more than its pixels, and the tenth that is brightest and the tenth that is darkest
/// do not.
constexpr Weights weights_of(Role r) { return r == Role::paint ? Weights{1, 0.1} : Weights{0.1, 1}; }

/// The panorama's yaw, of eight, under which a few steps on a few of the paint's pixels come closest to the photo.
float best_yaw(const Options& o, const Inputs& in, const GBuffer& g, const std::vector<Role>& roles,
               const Photo& photo) {
  const Mask target = photo.of(Role::paint);
  std::vector<int> all, some;
  for (int i = 0; i < g.size(); ++i)
    if (roles[std::size_t(i)] == Role::paint && target.values[std::size_t(g.pixel[std::size_t(i)])] > 0.5f)
      all.push_back(i);
  for (std::size_t i = 0; i < all.size(); i += 1 + all.size() / 1500) some.push_back(all[i]);
  if (some.empty()) return 0;
  Shot seen;
  seen.parts[0] = g.picked(some);
  const Mask overlap = both(target, seen[Role::paint].frame("coverage"));
  const CarPaint<float> start = first_paint();
  const Image coarse = resized(in.panorama, 256, 128);
  Image image(g.width, g.height), d_image = image;
  float best = 0;
  double least = 1e9;
  for (const float yaw : {0.0f, 45.0f, 90.0f, 135.0f, 180.0f, 225.0f, 270.0f, 315.0f}) {
    World world = world_of(o, in, coarse, yaw);
    seen.light = LightOf<float>(Illumination(world.sky, seen[Role::paint], {}, {.rings = Rings::Size::small}));
    const float up = o.exposure > 0 ? 1 : white_point(seen, world, photo);
    world.strength.sky *= up, world.strength.sun *= up;
    const auto look = lit(painted, seen, world);
    FitState state(start, Adam{.rate = 0.05f});
    fit(
        state,
        [&](const CarPaint<float>& model, CarPaint<float>& d) {
          render(seen[Role::paint], look, model, image);
          std::fill(d_image.values.begin(), d_image.values.end(), 0.0f);
          const double loss = masked_l1(image, photo.image, overlap, 1, d_image);
          backward(seen[Role::paint], look, model, d_image, d);
          return loss + hold_back(model, start, d, o, o.prior);
        },
        Patience{.steps = 50, .window = 0});
    if (state.best_loss < least) least = state.best_loss, best = yaw;
  }
  return best;
}

template <class M, class Look> Fitted<M> fit_part(Role role, const M& start, FitState<M> state, const Look& look,
                                                  const Shot& from, const World& world, const Photo& photo,
                                                  const Options& options) {
  const std::string name = parts::role_names[std::size_t(role)],
                    checkpoint = options.output + "/" + name + ".state.json";
  const GBuffer& g = from[role];
  const Mask target = photo.of(role), cover = g.frame("coverage"), overlap = both(target, cover);
  const Statistics statistics(photo.image,
                              role == Role::paint ? target : street::without_extremes(photo.image, target));
  const auto seen = lit(look, from, world);
  const int n = int(std::count_if(overlap.values.begin(), overlap.values.end(), [](float x) { return x > 0; }));
  Progress progress(name);
  Fitted<M> out{std::move(state), {}, n, 0};
  if (n == 0) {
    progress.finish(g.size() == 0 ? "not seen in the model: left as it is"
                                  : "not where the photo has it: left as it is");
    return out;
  }
  Image image(photo.image.width, photo.image.height), d_image = image;
  const Weights weights = weights_of(role);
  const auto save = [&](const FitState<M>& s) { write_text(checkpoint, to_json(s).dump() + "\n"); };
  fit(
      out.state,
      [&](const M& model, M& d) {
        render(g, seen, model, image);
        std::fill(d_image.values.begin(), d_image.values.end(), 0.0f);
        const double loss = masked_l1(image, photo.image, overlap, weights.aligned, d_image) +
                            part_statistics(image, cover, statistics, weights.statistics, d_image);
        backward(g, seen, model, d_image, d);
        const double pull = hold_back(model, start, d, options, float(options.prior / weights.aligned));
        try {
          out.state.adam.check(d);
        } catch (const Error& e) {
          const auto place = surfel_to_blame(g, seen, model, d_image);
          if (!place) throw;
          const int p = g.pixel[std::size_t(*place)];
          throw Error(std::string(e.what()) + ", pixel (" + std::to_string(p % image.width) + ", " +
                      std::to_string(p / image.width) + ")");
        }
        return loss + pull;
      },
      Patience{.steps = options.steps, .window = options.patience},
      [&](const FitState<M>& s) {
        char note[64];
        std::snprintf(note, sizeof note, "loss %.4f", s.losses.back());
        progress.show(s.step(), options.steps, note);
        if (s.step() % 50 == 0) save(s);
        return !interrupted;
      });
  save(out.state);
  out.seconds = progress.seconds();
  out.deviation = fitted::deviations<M>(
      out.state.best, [&](const M& m) { return render(g, seen, m); }, photo.image, overlap,
      [&](const std::string& parameter) { return !options.frozen(parameter); });
  char note[128];
  std::snprintf(note, sizeof note, "%d pixels, %d steps, loss %.4f -> %.4f", n, out.state.step(),
                out.state.losses.front(), out.state.best_loss);
  progress.finish(note);
  return out;
}

// ---- all of it ------------------------------------------------------------------------------------------------------

int run(const Options& o) {
  if (o.threads > 0) set_threads(o.threads);
  Progress whole("");
  // Everything is read and checked before any work is done and before anything is written.
  Fits fits = begin(o);
  Inputs in = street::read(o);
  std::printf("%s\n", o.vehicle.c_str());
  for (const std::string& line : in.report.lines) std::printf("  %s\n", line.c_str());
  std::printf("read           %s (%.2f s)\n", o.photo.c_str(), whole.seconds());

  // The vehicle in the whole photo; then only the window that it is in, made smaller if it has too many pixels.
  Progress seeing("see");
  const Raycaster scene(std::move(in.mesh));
  const GBuffer frame = scene.trace(in.camera);
  if (frame.size() == 0)
    throw Error(o.camera + ": the vehicle is not in the picture; it stands at the origin, x ahead, y up, metres");
  const Mask seen_part = frame.frame("coverage");
  double shared = 0, either = 0;
  int x0 = frame.width, x1 = 0, y0 = frame.height, y1 = 0;
  for (int i = 0; i < frame.width * frame.height; ++i) {
    const float a = seen_part.values[std::size_t(i)], b = in.photo.vehicle.values[std::size_t(i)];
    shared += double(std::min(a, b)), either += double(std::max(a, b));
    if (a > 0 || b > 0.5f)
      x0 = std::min(x0, i % frame.width), x1 = std::max(x1, i % frame.width), y0 = std::min(y0, i / frame.width),
      y1 = std::max(y1, i / frame.width);
  }
  if (shared == 0)
    throw Error(o.camera + ": the vehicle lies nowhere on the mask, expected it to be seen where the photo's is");
  const int margin = (x1 - x0) / 12 + 4;
  x0 = std::max(x0 - margin, 0), y0 = std::max(y0 - margin, 0);
  const int w = std::min(x1 + margin + 1, frame.width) - x0, h = std::min(y1 + margin + 1, frame.height) - y0;
  const Camera camera =
      in.camera.cropped(x0, y0, w, h).scaled(std::min(1.0f, std::sqrt(float(o.pixels) / float(frame.size()))));
  Photo photo = in.photo.window(x0, y0, w, h, camera);
  const GBuffer g = scene.trace(camera);
  const std::vector<Role> roles = parts::roles_of(g, scene.mesh(), in.roles);
  std::string guess;
  if (photo.label.empty()) {
    Mask paint(camera.width, camera.height);
    for (int i = 0; i < g.size(); ++i)
      if (roles[std::size_t(i)] == Role::paint) paint.values[std::size_t(g.pixel[std::size_t(i)])] = 1;
    guess = street::label_by_color(photo, paint);
  }
  std::map<std::string, std::array<int, 4>> found;  // how many pixels of a material have which role
  for (int i = 0; i < g.size(); ++i)
    ++found[g.parts[std::size_t(g.part[std::size_t(i)])].material][std::size_t(roles[std::size_t(i)])];
  char note[256];
  std::snprintf(note, sizeof note, "%d pixels of the vehicle; it covers the mask with IoU %.3f", g.size(),
                shared / either);
  seeing.finish(note);
  if (!guess.empty()) std::printf("  %s\n", guess.c_str());
  std::vector<std::vector<std::string>> materials{{"material", "taken as", "pixels"}};
  for (const auto& [material, counts] : found)
    for (std::size_t r = 0; r < 4; ++r)
      if (counts[r] > 0) {
        materials.push_back({material, parts::role_names[r], std::to_string(counts[r])});
        std::printf("  %-28s %-6s %6d pixels\n", material.c_str(), parts::role_names[r], counts[r]);
      }

  Progress lighting("light");
  std::vector<int> wanted;  // what is not fitted needs no light yet
  std::vector<Role> wanted_roles;
  for (int i = 0; i < g.size(); ++i)
    if (roles[std::size_t(i)] != Role::other) wanted.push_back(i), wanted_roles.push_back(roles[std::size_t(i)]);
  const float yaw = o.yaw == street::any_yaw ? best_yaw(o, in, g, roles, photo) : o.yaw;
  World world = world_of(o, in, in.panorama, yaw);
  const Shot lit_pixels = shot::gather(world, scene, g.picked(wanted), wanted_roles, Rings::Size::medium);
  const Mask coverage = g.frame("coverage");
  if (o.exposure <= 0) {
    const float up = white_point(lit_pixels, world, photo);
    world.strength.sky *= up, world.strength.sun *= up;
  }
  std::snprintf(note, sizeof note, "turned by %.0f degrees, %zu suns, strength %.2f %.2f %.2f, %.0f MB of tables",
                double(yaw), world.sky.suns.size(), double(world.strength.sky.x), double(world.strength.sky.y),
                double(world.strength.sky.z), double(lit_pixels.light.bytes()) / 1e6);
  lighting.finish(note);

  // The fits. From here on something is written.
  check_writable(o.output);
  const Vehicle before{first_paint(), {}, {}};
  const auto paint = fit_part(Role::paint, before.paint, std::move(fits.paint), painted, lit_pixels, world, photo, o);
  const auto window = fit_part(Role::glass, before.window, std::move(fits.window), AtRunTime<decltype(glazed)>{&glazed},
                               lit_pixels, world, photo, o);
  const auto rubber = fit_part(Role::rubber, before.rubber, std::move(fits.rubber),
                               AtRunTime<decltype(painted)>{&painted}, lit_pixels, world, photo, o);
  const Vehicle after{paint.state.best, window.state.best, rubber.state.best};
  write_model(o.output + "/paint.json", after.paint);
  write_model(o.output + "/glass.json", after.window);
  write_model(o.output + "/rubber.json", after.rubber);
  write_exr(o.output + "/gbuffer.exr", g);

  // The pictures.
  Progress drawing("draw");
  const shot::Compositor compose(photo.image, camera, scene, world, in.roles);
  const auto with_materials = [&](const Vehicle& v) {
    return compose([&](const Shot& s, const auto& others, Image& image) {
      render(s[Role::paint], lit(painted, s, world), v.paint, image);
      render(s[Role::glass], lit(glazed, s, world), v.window, image);
      render(s[Role::rubber], lit(painted, s, world), v.rubber, image);
      render(s[Role::other], lit(painted, s, world), others, image);
    });
  };
  const Image old = with_materials(before), now = with_materials(after);
  const int wide = 640, high = std::max(1, wide * camera.height / camera.width);
  const auto panel = [&](const Image& image) { return resized(image, wide, high); };
  Image shown = now;
  for (float& x : shown.values) x = detail::to_srgb(x);
  write_png(o.output + "/fit.png", sheet({{"photo", panel(linear(photo.image))},
                                          {"before", panel(old)},
                                          {"after", panel(now)},
                                          {"difference, where photo and model overlap",
                                           panel(shot::difference(shown, photo.image, coverage, photo.vehicle))}},
                                         2));
  write_png(o.output + "/after.png", now);
  const auto [normals, kinds] = shot::shown_gbuffer(g, roles);
  write_png(
      o.output + "/gbuffer.png",
      sheet({{"normals", panel(normals)}, {"paint red, glass blue, rubber grey, the rest yellow", panel(kinds)}}, 2));
  std::vector<double> losses = paint.state.losses;
  if (!losses.empty()) write_png(o.output + "/loss.png", curve(losses, "loss of the paint, by step"));

  std::vector<std::vector<std::string>> rows{{"parameter", "before", "fitted", "", "range", ""}};
  if (paint.pixels > 0) fitted::add_rows(rows, "paint", before.paint, paint, o);
  if (window.pixels > 0) fitted::add_rows(rows, "glass", before.window, window, o);
  if (rubber.pixels > 0) fitted::add_rows(rows, "rubber", before.rubber, rubber, o);
  Page page("The paint of a vehicle, fitted to a photo");
  page.text(o.photo + "   |   " + o.vehicle + "   |   " + o.environment + ", turned by " +
            std::to_string(int(std::lround(yaw))) + " degrees");
  page.picture(o.output + "/fit.png",
               "Photo; the model with its first paint; the model with the fitted materials; what is left, where photo "
               "and model overlap.");
  std::snprintf(note, sizeof note,
                "The paint took %d steps on %d pixels: %.2f s on %d threads. Its loss went from %.4f to %.4f.%s",
                paint.state.step(), paint.pixels, paint.seconds, threads(), losses.empty() ? 0 : losses.front(),
                losses.empty() ? 0 : paint.state.best_loss, interrupted ? " It was interrupted." : "");
  page.text(note);
  if (!losses.empty())
    page.picture(
        o.output + "/loss.png",
        "By step: mean difference of the pixels where paint lies on paint, plus 0.1 times that of the parts' means "
        "and variances, in display values. Glass and rubber: 0.1 times the first, plus the second without the "
        "extremes, as "
        "wheels and panes of another model do not lie on the photo's.");
  page.heading("The fitted numbers");
  page.table(rows);
  page.text(
      "Linear colours; lengths in metres. +- is a standard deviation: how much a number could change and the picture "
      "still "
      "fit as well, given the light. How strong the light was one photo does not tell: brightness of light and paint "
      "can be "
      "exchanged. Here the light is neutral and as strong as a street of middling grey needs to give the photo's mean "
      "brightness, or as a paint of albedo 0.8 needs to be as bright as this one.");
  page.heading("What the camera sees");
  page.picture(o.output + "/gbuffer.png", "Normals, and what each surface was taken as. gbuffer.exr holds all of it.");
  page.table(materials);
  if (!guess.empty()) page.text(guess);
  page.heading("What was done to the vehicle's file");
  for (const std::string& line : in.report.lines) page.text(line);
  std::snprintf(note, sizeof note, "%.1f s from start to end.", whole.seconds());
  page.text(note);
  page.write(o.output + "/report.html");
  drawing.finish("pictures");
  for (const auto& row : rows)
    if (!row[3].empty())
      std::printf("  %-28s %8s %-10s %s\n", row[0].c_str(), row[2].c_str(), row[3].c_str(), row[5].c_str());
  std::printf("\n%s after %.1f s. %s/fit.png shows it, %s/report.html tells all; %s/paint.json can be read back.\n",
              interrupted ? "Interrupted" : "Done", whole.seconds(), o.output.c_str(), o.output.c_str(),
              o.output.c_str());
  return interrupted ? 130 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{
      "Fits the paint, glass and rubber of a CAD vehicle to a photo.\n\n"
      "Without arguments: the white pickup of darknet's dog.jpg, a vehicle of sweethome3d-furniture and a panorama of\n"
      "blender-data. For your own:\n\n"
      "  04_fit_material --photo street.jpg --mask car.png --camera street.camera.json \\\n"
      "                  --vehicle car.glb --environment sky.exr --yaw 40 --output fit\n\n"
      "The loss of the paint: the mean difference of the pixels where paint lies on paint, plus 0.1 times that of the\n"
      "parts' means and variances. Glass and rubber: 0.1 times the first plus the second, without the photo's "
      "extremes."};
  street::add_options(app, o);
  try {
    app.parse(argc, argv);
    street::complete(o, BURNISH_EXAMPLES_DATA);  // masks and camera of the default photo
    catch_interrupt();
    return run(o);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::fprintf(stderr, "04_fit_material: %s\n", e.what());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "04_fit_material: %s\n", e.what());
  }
  return 2;
}
