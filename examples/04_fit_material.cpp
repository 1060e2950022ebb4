// examples/04_fit_material.cpp -- a street photo, a CAD vehicle and a panorama go in; a fitted car paint comes out
// SPDX-License-Identifier: Apache-2.0
//
// The way of the data: the vehicle is seen through the photo's camera (a G-buffer, once); the panorama's light is gathered
// for every pixel (once); then render, compare with the photo, go back, step, 300 times; at the end pictures and files.
#include <CLI/CLI.hpp>
#include <burnish/burnish.h>
#include <burnish/io/camera.h>
#include <burnish/io/exr.h>
#include <burnish/io/mesh.h>
#include <burnish/io/model.h>
#include <burnish/io/report.h>
#include <burnish/scene/raycast.h>
#include "progress.h"

using namespace burnish;

namespace {

// ---- what is fitted, and how it looks --------------------------------------------------------------------------------

/// What a camera makes of linear light: a shoulder above 0.8 instead of a hard clip, then the sRGB curve.
inline constexpr auto developed = []<class T>(const vec3<T>& light) {
  const auto film = [](const T& x) {
    const T over = max(x - 0.8f, 0.0f);
    return srgb_from_linear(min(x, 0.8f) + 0.2f * (1.0f - exp(over * -5.0f)));
  };
  return vec3<T>(film(light.x), film(light.y), film(light.z));
};
inline constexpr auto painted = [](const auto& paint, const auto& at, const auto& light, const auto& suns, const auto& strength) {
  return developed(illuminate(paint(at), at, light, suns, strength));
};

/// A pane and the light that comes through it from behind, as a part of the sky's.
template <class T> struct Window {
  WindowGlass<T> glass;
  vec3<T> behind = {0.1f, 0.1f, 0.1f};
  static constexpr auto parameters() {
    return std::tuple{Param{"glass", &Window::glass}, Param{"behind", &Window::behind, Range{0, 1}}};
  }
};
inline constexpr auto glazed = [](const auto& window, const auto& at, const auto& light, const auto& suns, const auto& strength) {
  const auto surface = window.glass(at);
  const auto through = transmittance(surface, dot(at.normal, at.view)) * window.behind * strength.sky;
  return developed(illuminate(surface, at, light, suns, strength) + through);
};
/// What is not fitted keeps the file's colour.
template <class T> struct FileColor {
  vec3<T> base_color;
  static constexpr auto parameters() { return std::tuple{Param{"base_color", &FileColor::base_color, unit}}; }
};
inline constexpr auto plain = [](const auto& part, const auto& at, const auto& light, const auto& suns, const auto& strength) {
  Surface<std::remove_cvref_t<decltype(part.base_color.x)>> surface;
  surface.base_color = part.base_color;
  surface.specular_roughness = 0.5f;
  return developed(illuminate(surface, at, light, suns, strength));
};

// ---- which part is what ----------------------------------------------------------------------------------------------

enum class Role { paint, glass, rubber, other };
constexpr std::array<const char*, 4> role_names{"paint", "glass", "rubber", "other"};

std::string lower(std::string s) {
  for (char& c : s) c = char(std::tolower(static_cast<unsigned char>(c)));
  return s;
}
bool any_of(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* w : words)
    if (text.find(w) != std::string::npos) return true;
  return false;
}
/// By the words in a part's names and by its opacity; the paint is the material of the largest seen area among the rest.
/// `given`: "material=role", which outweighs all guesses.
std::vector<Role> roles_of(const GBuffer& g, const std::vector<std::string>& given) {
  std::vector<int> area(g.parts.size());
  for (const int p : g.part) ++area[std::size_t(p)];
  std::vector<Role> roles(g.parts.size(), Role::other);
  std::vector<bool> open(g.parts.size(), true);
  std::vector<double> by_material;
  for (std::size_t i = 0; i < g.parts.size(); ++i) {
    const Part& p = g.parts[i];
    const std::string words = lower(p.name + " " + p.material), material = lower(p.material);
    if (any_of(words, {"glass", "window", "windsh", "vitre", "verre", "glas"}) || p.opacity < 0.75f) roles[i] = Role::glass, open[i] = false;
    if (any_of(words, {"tire", "tyre", "rubber", "pneu", "wheel", "wheek"})) roles[i] = Role::rubber, open[i] = false;
    if (any_of(words, {"chrome", "light", "lamp", "optic", "interior", "seat", "plate", "mirror", "black", "grill", "door_line", "doorline", "rim"}))
      roles[i] = roles[i] == Role::glass || roles[i] == Role::rubber ? roles[i] : Role::other, open[i] = false;
    for (const std::string& g_ : given) {
      const std::size_t eq = g_.find('=');
      if (eq == std::string::npos || lower(g_.substr(0, eq)) != material) continue;
      const auto found = std::find(role_names.begin(), role_names.end(), g_.substr(eq + 1));
      if (found == role_names.end()) throw Error("--role " + g_ + ": expected material=paint, glass, rubber or other");
      roles[i] = Role(found - role_names.begin()), open[i] = false;
    }
    by_material.resize(std::max(by_material.size(), std::size_t(p.material_index) + 1));
    if (open[i]) by_material[std::size_t(p.material_index)] += area[i];
  }
  if (std::find(roles.begin(), roles.end(), Role::paint) == roles.end()) {
    const auto largest = std::max_element(by_material.begin(), by_material.end());
    for (std::size_t i = 0; i < g.parts.size(); ++i)
      if (open[i] && g.parts[i].material_index == int(largest - by_material.begin())) roles[i] = Role::paint;
  }
  return roles;
}

// ---- the photo, the light, and one part against it -------------------------------------------------------------------

struct Photo {
  Image image;            // as the camera developed it: sRGB values 0 to 1
  Mask vehicle;           // 0 to 1
  std::vector<int> label; // of each pixel: 1 paint, 2 glass, 3 rubber, 4 other, 0 not the vehicle; empty: not known

  /// The window that the vehicle is in.
  Photo cropped(int x, int y, int w, int h) const {
    Photo p{burnish::cropped(image, x, y, w, h), burnish::cropped(vehicle, x, y, w, h), {}};
    if (label.empty()) return p;
    p.label.assign(std::size_t(w) * std::size_t(h), 0);
    for (int j = std::max(0, -y); j < std::min(h, image.height - y); ++j)
      for (int i = std::max(0, -x); i < std::min(w, image.width - x); ++i)
        p.label[std::size_t(j) * std::size_t(w) + std::size_t(i)] = label[std::size_t(y + j) * std::size_t(image.width) + std::size_t(x + i)];
    return p;
  }
  Mask of(Role role) const {
    if (label.empty()) return role == Role::paint ? vehicle : Mask(vehicle.width, vehicle.height);
    Mask m = vehicle;
    for (std::size_t i = 0; i < label.size(); ++i) m.values[i] *= label[i] == int(role) + 1 ? 1.0f : 0.0f;
    return m;
  }
};
struct Lit {
  GBuffer pixels;
  LightOf<float> light;
};
struct World {
  EnvironmentLight sky;
  LightStrength<float> strength;
  vec3<float> occluded;  // radiance of what hides the sky: the vehicle itself, taken as a rough grey
};
Lit gather(const World& world, const Raycaster& scene, GBuffer g) {
  const auto blocked = [&](int i, std::span<const vec3<float>> directions, std::span<std::uint8_t> out) {
    static thread_local std::vector<vec3<float>> origins;
    origins.assign(directions.size(), scene.lift(g.at(i).position, g.geometric_normal(i)));
    scene.occluded(origins, directions, out);
  };
  Illumination light(world.sky, g, blocked, {.rings = Rings::Size::medium, .occluded = world.occluded});
  return {std::move(g), LightOf<float>(std::move(light))};
}
template <class Look> auto lit_look(const Look& look, const Lit& lit, const World& world) {
  return with(look, lit.light, world.sky.suns, world.strength);
}

struct Options {
  std::string photo = "/usr/share/darknet/data/dog.jpg", mask, parts, camera;
  std::string vehicle = "/usr/share/sweethome3d/furniture/Scopia.sh3f:scopia/suv/suv.obj";
  std::string environment = "/usr/share/blender/datafiles/studiolights/world/city.exr";
  std::string output = "burnish-fit", resume;
  std::vector<std::string> roles, freeze = {"tint", "coat_ior", "mottle.size", "flakes.size", "flakes.resolved",
                                            "glass.base_color", "glass.specular_roughness", "glass.specular_ior", "specular_ior"};
  float yaw = 106, exposure = 0, rate = 0.02f, prior = 0.02f;
  int steps = 300, threads = 0;
  bool defaults = false;
};

bool named(const std::string& parameter, const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& n) { return parameter == n || parameter.rfind(n + ".", 0) == 0; });
}
/// What the photo does not tell stays near where it began: a parabola over every parameter's range but a colour's, added to
/// the loss and to d. Frozen parameters lose their derivative.
template <class M> double hold_back(const M& model, const M& start, M& d, const Options& options) {
  double loss = 0;
  std::vector<std::tuple<std::string, Range>> names;
  for_each_parameter(d, [&](const std::string& name, auto&, Range r) { names.push_back({name, r}); });
  std::size_t i = 0;
  each([&](float& slope, const float& x, const float& x0) {
    const auto& [name, range] = names[i++];
    if (named(name, options.freeze)) slope = 0;
    else if (name.find("color") == std::string::npos && name.find("behind") == std::string::npos) {
      const float width = range.high - range.low, off = (x - x0) / width;
      loss += double(options.prior * off * off);
      slope += 2 * options.prior * off / width;
    }
  }, d, model, start);
  return loss;
}

/// Fits one part's model to the photo; gives what was found.
template <class M, class Look>
FitState<M> fit_part(const char* name, const M& start, const Look& look, const Lit& lit, const World& world, const Photo& photo,
                     Role role, const Options& options, const std::string& checkpoint) {
  const Mask target = photo.of(role), cover = lit.pixels.frame("coverage");
  Mask overlap = target;
  for (std::size_t i = 0; i < overlap.values.size(); ++i) overlap.values[i] *= cover.values[i];
  const Statistics statistics(photo.image, target);
  const auto seen = lit_look(look, lit, world);
  FitState<M> state(start, Adam(options.rate));
  if (!options.resume.empty() && std::filesystem::exists(options.resume + "/" + checkpoint))
    from_json(parse_json(options.resume + "/" + checkpoint), state, options.resume + "/" + checkpoint);
  const int n = int(std::count_if(overlap.values.begin(), overlap.values.end(), [](float x) { return x > 0; }));
  Progress progress(name);
  if (lit.pixels.size() == 0 || statistics.area == 0 || n == 0) {
    progress.finish(lit.pixels.size() == 0 ? "not seen in the model: left as it is" : "no such part in the photo: left as it is");
    return state;
  }
  Image image(photo.image.width, photo.image.height), d_image = image;
  const Patience patience{.steps = options.steps};
  fit(state, [&](const M& model, M& d) {
    render(lit.pixels, seen, model, image);
    std::fill(d_image.values.begin(), d_image.values.end(), 0.0f);
    const double loss = masked_l1(image, photo.image, overlap, 1, d_image) + part_statistics(image, cover, statistics, 0.1, d_image);
    backward(lit.pixels, seen, model, d_image, d);
    const double pull = hold_back(model, start, d, options);
    try {
      state.adam.check(d);
    } catch (const Error& e) {
      const auto place = surfel_to_blame(lit.pixels, seen, model, d_image);
      if (!place) throw;
      const int p = lit.pixels.pixel[std::size_t(*place)];
      throw Error(std::string(e.what()) + ", pixel (" + std::to_string(p % image.width) + ", " + std::to_string(p / image.width) + ")");
    }
    return loss + pull;
  }, patience, [&](const FitState<M>& s) {
    char note[64];
    std::snprintf(note, sizeof note, "loss %.4f", s.losses.back());
    progress.show(s.step(), options.steps, note);
    if (s.step() % 50 == 0) write_text(options.output + "/" + checkpoint, to_json(s).dump() + "\n");
    return !interrupted;
  });
  write_text(options.output + "/" + checkpoint, to_json(state).dump() + "\n");
  char note[128];
  std::snprintf(note, sizeof note, "%d pixels, %d steps, loss %.4f -> %.4f", n, state.step(), state.losses.front(), state.best_loss);
  progress.finish(note);
  return state;
}

// ---- pictures --------------------------------------------------------------------------------------------------------

/// Linear pictures from display values, and the other way round.
Image map(const Image& image, float (*f)(float)) {
  Image out = image;
  for (float& x : out.values) x = f(x);
  return out;
}
struct Vehicle {
  CarPaint<float> paint;
  Window<float> window;
  Rubber<float> rubber;
};

/// The vehicle over the photo, `fine` x `fine` samples a pixel; linear light, as the page's pictures are.
class Compositor {
public:
  static constexpr int fine = 3;
  Compositor(const Photo& photo, const Camera& camera, const Raycaster& scene, const World& w, const std::vector<Role>& roles)
      : world(w), background(map(photo.image, detail::from_srgb)), full(scene.trace(camera.scaled(fine), 1)) {
    for (int r = 0; r < 4; ++r)
      parts[std::size_t(r)] = gather(world, scene, full.only([&](int part) { return roles[std::size_t(part)] == Role(r); }));
  }
  Image operator()(const Vehicle& v) const {
    Image image(full.width, full.height);
    const auto draw = [&](Role r, const auto& look, const auto& model) {
      const Lit& lit = parts[std::size_t(r)];
      if (lit.pixels.size()) render(lit.pixels, lit_look(look, lit, world), model, image);
    };
    draw(Role::paint, painted, v.paint);
    draw(Role::glass, glazed, v.window);
    draw(Role::rubber, painted, v.rubber);
    const Lit& other = parts[std::size_t(Role::other)];
    if (other.pixels.size()) {
      Planes<FileColor> colors(other.pixels.size());
      for (int i = 0; i < other.pixels.size(); ++i)
        colors.set(i, {full.parts[std::size_t(other.pixels.part[std::size_t(i)])].base_color});
      render(other.pixels, lit_look(plain, other, world), colors, image);
    }
    Image out = background;
    std::vector<int> hits(std::size_t(out.width) * std::size_t(out.height));
    std::vector<vec3<float>> sum(hits.size());
    for (const int p : full.pixel) {
      const int x = p % full.width, y = p / full.width;
      const std::size_t to = std::size_t(std::min(y / fine, out.height - 1)) * std::size_t(out.width) + std::size_t(std::min(x / fine, out.width - 1));
      const vec3<float> c = image.at(x, y);
      sum[to] += vec3<float>(detail::from_srgb(c.x), detail::from_srgb(c.y), detail::from_srgb(c.z));
      ++hits[to];
    }
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (!hits[i]) continue;
      const int x = int(i) % out.width, y = int(i) / out.width;
      const float a = std::min(1.0f, float(hits[i]) / (fine * fine));
      out.set(x, y, out.at(x, y) * (1 - a) + sum[i] * (a / float(hits[i])));
    }
    return out;
  }

private:
  const World& world;
  Image background;
  GBuffer full;
  std::array<Lit, 4> parts;
};

std::vector<std::vector<std::string>> parameter_rows(const CarPaint<float>& before, const CarPaint<float>& after, const std::vector<std::string>& frozen) {
  std::vector<std::vector<std::string>> rows{{"parameter", "before", "fitted", "range", ""}};
  const nlohmann::ordered_json b = to_json(before);
  for_each_parameter(after, [&]<class X>(const std::string& name, const X& x, Range r) {
    char value[32], old[32], range[48];
    std::snprintf(value, sizeof value, "%.4g", double(x));
    std::snprintf(old, sizeof old, "%.4g", b[name].get<double>());
    std::snprintf(range, sizeof range, "%g to %g", double(r.low), double(r.high));
    rows.push_back({name, old, value, range, named(name, frozen) ? "held" : x <= r.low || x >= r.high ? "at its bound" : ""});
  });
  return rows;
}

int run(const Options& o) {
  if (o.threads > 0) set_threads(o.threads);
  check_writable(o.output);
  Progress whole("");

  // Everything is read and checked before any work.
  Photo photo{map(read_photo(o.photo), detail::to_srgb), {}, {}};
  photo.vehicle = read_mask(o.mask, photo.image.width, photo.image.height);
  if (!o.parts.empty()) photo.label = read_labels(o.parts, photo.image.width, photo.image.height);
  Camera camera = read_camera(o.camera);
  if (camera.width != photo.image.width || camera.height != photo.image.height)
    throw Error(o.camera + ": camera " + std::to_string(camera.width) + " x " + std::to_string(camera.height) + ", photo " +
                std::to_string(photo.image.width) + " x " + std::to_string(photo.image.height) + ": they must agree");
  const Image panorama = read_photo(o.environment);
  MeshReport report;
  const Raycaster scene(read_vehicle(o.vehicle, &report));
  std::printf("%s\n", o.vehicle.c_str());
  for (const std::string& line : report.lines) std::printf("  %s\n", line.c_str());

  Progress seeing("see");
  const GBuffer frame = scene.trace(camera);
  if (frame.size() == 0) throw Error(o.camera + ": the vehicle is not in the picture; it stands at the origin, x ahead, y up, metres");
  const std::vector<Role> roles = roles_of(frame, o.roles);
  write_exr(o.output + "/gbuffer.exr", frame);
  const Mask seen_part = frame.frame("coverage");
  double both = 0, either = 0;
  int x0 = frame.width, x1 = 0, y0 = frame.height, y1 = 0;
  for (int i = 0; i < frame.width * frame.height; ++i) {
    const float a = seen_part.values[std::size_t(i)], b = photo.vehicle.values[std::size_t(i)];
    both += double(std::min(a, b)), either += double(std::max(a, b));
    if (a > 0 || b > 0.5f) x0 = std::min(x0, i % frame.width), x1 = std::max(x1, i % frame.width), y0 = std::min(y0, i / frame.width), y1 = std::max(y1, i / frame.width);
  }
  double brightness = 0;  // mean linear value of the whole photo
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < frame.width * frame.height; ++i) brightness += double(detail::from_srgb(photo.image.plane(c)[i])) / (3.0 * frame.width * frame.height);
  // From here on only the window that the vehicle is in.
  const int margin = (x1 - x0) / 12 + 4, w = x1 - x0 + 1 + 2 * margin, h = y1 - y0 + 1 + 2 * margin;
  photo = photo.cropped(x0 - margin, y0 - margin, w, h);
  camera = camera.cropped(x0 - margin, y0 - margin, w, h);
  const GBuffer g = scene.trace(camera);
  const Mask coverage = g.frame("coverage");
  char note[160];
  std::snprintf(note, sizeof note, "%d pixels of the vehicle; it covers the mask with IoU %.3f", g.size(), both / std::max(1.0, either));
  seeing.finish(note);
  for (std::size_t p = 0; p < g.parts.size(); ++p)
    if (const auto n = std::count(g.part.begin(), g.part.end(), int(p)))
      std::printf("  %-28s %-6s %6d pixels\n", g.parts[p].material.c_str(), role_names[std::size_t(roles[p])], int(n));

  // The light: neutral on average, and as strong as a street of middling grey (albedo 0.2) must have been lit to give the
  // photo's mean brightness; raised where the paint would have to be whiter than 0.8.
  Progress lighting("light");
  World world{EnvironmentLight(panorama, o.yaw * pi / 180), {}, {}};
  const IrradianceMap irradiance(world.sky);
  vec3<float> mean_irradiance;
  for (const vec3<float>& n : {vec3<float>{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    const auto e = irradiance(n);
    mean_irradiance += vec3<float>(e[0], e[1], e[2]) * 0.2f;
    for (const Sun<float>& s : world.sky.suns) mean_irradiance += s.power * (0.2f * std::max(0.0f, dot(n, s.direction)));
  }
  world.occluded = mean_irradiance * (0.2f * inverse_pi);
  const vec3<float> grey = vec3<float>(float(brightness) / (0.2f * inverse_pi)) / mean_irradiance;
  world.strength.sky = world.strength.sun = o.exposure > 0 ? vec3<float>(o.exposure) : grey;
  const auto select_role = [&](Role r) { return g.only([&](int part) { return roles[std::size_t(part)] == r; }); };
  const Lit body = gather(world, scene, select_role(Role::paint)), glass = gather(world, scene, select_role(Role::glass)),
            tyres = gather(world, scene, select_role(Role::rubber));
  if (o.exposure <= 0) {
    CarPaint<float> white;
    white.base_color = {0.8f, 0.8f, 0.8f}, white.base_metalness = 0;
    const Image image = render(body.pixels, lit_look(painted, body, world), white);
    const Statistics ours(image, body.pixels.frame("coverage")), theirs(photo.image, photo.of(Role::paint));
    const double linear_ours = double(detail::from_srgb(float(ours.mean[1]))), linear_theirs = double(detail::from_srgb(float(theirs.mean[1])));
    if (theirs.area > 0 && linear_ours > 0 && linear_theirs > linear_ours) {
      const float up = float(std::min(8.0, linear_theirs / linear_ours));
      world.strength.sky *= up, world.strength.sun *= up;
    }
  }
  std::snprintf(note, sizeof note, "%zu suns, strength %.2f %.2f %.2f, %.0f MB of tables", world.sky.suns.size(),
                double(world.strength.sky.x), double(world.strength.sky.y), double(world.strength.sky.z),
                double(body.light.bytes() + glass.light.bytes() + tyres.light.bytes()) / 1e6);
  lighting.finish(note);

  // The fits.
  Vehicle before, after;
  before.paint.base_metalness = 0.1f;
  const double fit_start = whole.seconds();
  const auto paint = fit_part("paint", before.paint, painted, body, world, photo, Role::paint, o, "paint.state.json");
  const double paint_seconds = whole.seconds() - fit_start;
  after.paint = paint.best;
  if (!interrupted) after.window = fit_part("glass", before.window, glazed, glass, world, photo, Role::glass, o, "glass.state.json").best;
  if (!interrupted) after.rubber = fit_part("rubber", before.rubber, painted, tyres, world, photo, Role::rubber, o, "rubber.state.json").best;

  // The pictures.
  Progress drawing("draw");
  write_model(o.output + "/paint.json", after.paint);
  write_model(o.output + "/glass.json", after.window);
  write_model(o.output + "/rubber.json", after.rubber);
  const Compositor compose(photo, camera, scene, world, roles);
  const Image old = compose(before), now = compose(after);
  const Image linear = map(photo.image, detail::from_srgb), shown = map(now, detail::to_srgb);
  const int wide = 640, high = std::max(1, wide * h / w);
  const auto panel = [&](const Image& image) { return resized(image, wide, high); };
  Image difference(linear.width, linear.height);
  for (int y = 0; y < linear.height; ++y)
    for (int x = 0; x < linear.width; ++x) {
      const vec3<float> d = shown.at(x, y) - photo.image.at(x, y);
      const float inside = std::min(coverage.at(x, y), photo.vehicle.at(x, y));
      difference.set(x, y, vec3<float>(detail::from_srgb(std::abs(d.x)), detail::from_srgb(std::abs(d.y)), detail::from_srgb(std::abs(d.z))) * inside);
    }
  write_png(o.output + "/fit.png", sheet({{"photo", panel(linear)}, {"before", panel(old)}, {"after", panel(now)},
                                          {"difference, where photo and model overlap", panel(difference)}}, 2));
  write_png(o.output + "/after.png", now);
  if (!paint.losses.empty()) write_png(o.output + "/loss.png", curve(paint.losses, "loss of the paint, by step"));

  Page page("The paint of a vehicle, fitted to a photo");
  page.text(o.photo + "   |   " + o.vehicle + "   |   " + o.environment);
  page.picture(o.output + "/fit.png", "Photo; the model with its first paint; the model with the fitted materials; what is left, where photo and model overlap.");
  std::snprintf(note, sizeof note, "%d steps on %d pixels in %.2f s on %d threads; the loss went from %.4f to %.4f.", paint.step(), body.pixels.size(),
                paint_seconds, threads(), paint.losses.empty() ? 0 : paint.losses.front(), paint.best_loss);
  page.text(note);
  if (!paint.losses.empty()) page.picture(o.output + "/loss.png", "Masked L1 on the overlap + 0.1 x difference of the parts' means and variances, in display values.");
  page.heading("The fitted paint");
  page.table(parameter_rows(before.paint, after.paint, o.freeze));
  page.text("One photo does not tell how strong the light was: brightness of light and paint can be exchanged. Here the light is neutral and as "
            "strong as a street of middling grey needs to give the photo's mean brightness, or as a paint of albedo 0.8 needs to be as bright as this one.");
  page.heading("What was done to the vehicle's file");
  for (const std::string& line : report.lines) page.text(line);
  page.write(o.output + "/report.html");
  drawing.finish("pictures");
  std::printf("\nThe paint was fitted in %.2f s. %s/fit.png shows it, %s/report.html tells all; %s/paint.json can be read back.\n", paint_seconds,
              o.output.c_str(), o.output.c_str(), o.output.c_str());
  return interrupted ? 130 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{"Fits the paint, glass and rubber of a CAD vehicle to a photo.\n\n"
               "Without arguments: the white pickup of darknet's dog.jpg, a vehicle of sweethome3d-furniture and a panorama of\n"
               "blender-data. For your own:\n\n"
               "  04_fit_material --photo street.jpg --mask car.png --camera street.camera.json \\\n"
               "                  --vehicle car.glb --environment sky.exr --yaw 40 --output fit"};
  app.add_option("--photo", o.photo, "the photo: any format OpenImageIO reads");
  app.add_option("--mask", o.mask, "the vehicle in the photo: white, same size");
  app.add_option("--parts", o.parts, "labels, same size: 1 paint, 2 glass, 3 rubber, 4 other, 0 not the vehicle");
  app.add_option("--camera", o.camera, "JSON: width height fx fy cx cy position look_at up; the vehicle stands at the origin, x ahead, y up, metres");
  app.add_option("--vehicle", o.vehicle, "any format Assimp reads; archive.zip:inner/path for a file in a zip archive");
  app.add_option("--role", o.roles, "material=paint|glass|rubber|other, as often as needed; the rest is guessed");
  app.add_option("--environment", o.environment, "lat-long panorama, EXR or HDR");
  app.add_option("--yaw", o.yaw, "degrees the panorama is turned about +y")->capture_default_str();
  app.add_option("--exposure", o.exposure, "strength of the light; 0: found from the photo's brightness")->capture_default_str();
  app.add_option("--steps", o.steps, "at most")->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--rate", o.rate, "of Adam, in parts of every parameter's range")->check(CLI::Range(1e-6f, 1.0f))->capture_default_str();
  app.add_option("--prior", o.prior, "how strongly what the photo does not tell is held where it began")->check(CLI::Range(0.0f, 10.0f))->capture_default_str();
  app.add_option("--freeze", o.freeze, "parameters that stay as they are")->delimiter(',')->capture_default_str();
  app.add_option("--resume", o.resume, "go on from the states in this folder");
  app.add_option("--threads", o.threads, "0: all cores")->check(CLI::Range(0, 1024))->capture_default_str();
  app.add_option("-o,--output", o.output, "folder for pictures and files")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const int code = app.exit(e);
    return code == 0 ? 0 : 2;
  }
  // The masks and the camera of the default photo lie beside this program's source.
  const std::string data = BURNISH_EXAMPLES_DATA;
  if (o.photo == Options{}.photo) {
    if (o.mask.empty()) o.mask = data + "/dog_pickup.mask.png", o.parts = o.parts.empty() ? data + "/dog_pickup.parts.png" : o.parts;
    if (o.camera.empty()) o.camera = data + "/dog_pickup.camera.json";
  }
  catch_interrupt();
  try {
    if (o.mask.empty()) throw Error("--mask is missing: which pixels of " + o.photo + " are the vehicle?");
    if (o.camera.empty()) throw Error("--camera is missing: how was " + o.photo + " taken?");
    return run(o);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "04_fit_material: %s\n", e.what());
    return 2;
  }
}
