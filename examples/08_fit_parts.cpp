// examples/08_fit_parts.cpp -- the parts of a posed vehicle against a photo's, by colour, statistics and pattern
// SPDX-License-Identifier: Apache-2.0
//
// As 04_fit_material, with a third loss: the pattern of every part, as Gram matrices of features (fit/gram.h), which
// need not lie on the photo's pixels. The features are a bank of filters, or a network's of VGG's kind from a file.
#include <burnish/fit/vgg.h>
#include <burnish/io/computed.h>
#include <burnish/io/model.h>
#include "command.h"
#include "fit_parts.h"
#include "fit_report.h"
#include "pattern.h"

using namespace burnish;
using parts::Role;
using street::Inputs;

namespace {

struct Options : street::Options {
  std::string features = "bank", pooling = "max", model_parts;
  double gram = 1, statistics = 0.1, pixels_weight = 1;
  std::string known;
  float known_turn = 1;
  int every = 0;
  bool compare = false;
};

fitting::MoreLoss pattern_of(const Options& o) {
  if (o.gram == 0) return {};
  if (o.features == "bank") return fitting::pattern(FilterBank{}, o.gram, std::max(1, o.every));
  const Pooling pooling = o.pooling == "max" ? Pooling::max : Pooling::average;
  return fitting::pattern(Vgg(read_tensors(o.features), o.features, pooling), o.gram, o.every > 0 ? o.every : 10);
}

/// By labels as --parts has them, of the model as the photo's camera sees it; what lies on no label is other.
parts::RolesOf roles_by_labels(std::vector<int> labels, const Camera& camera) {
  return [labels = std::move(labels), camera](const GBuffer& g) {
    std::vector<Role> roles(std::size_t(g.size()), Role::other);
    for (int i = 0; i < g.size(); ++i) {
      const vec3<float> at = camera.project(g.at(i).position);
      const int x = std::clamp(int(at.x), 0, camera.width - 1), y = std::clamp(int(at.y), 0, camera.height - 1);
      const int label = labels[std::size_t(y) * std::size_t(camera.width) + std::size_t(x)];
      if (label >= 1 && label <= 4) roles[std::size_t(i)] = Role(label - 1);
    }
    return roles;
  };
}

/// A test of the method: the photo becomes a picture of the vehicle with a known paint, over the same street, seen by a
/// camera that is turned about the vehicle's upright by some degrees; its labels are the model's. Gives its light.
fitting::Lit draw_known(Inputs& in, const CarPaint<float>& paint, float degrees, const Raycaster& scene,
                        const parts::RolesOf& roles_of, const Options& o, const fitting::Watch& watch) {
  const float angle = degrees * pi / 180, c = std::cos(angle), s = std::sin(angle);
  fitting::Seen whole;
  whole.camera = in.camera;
  for (vec3<float>* v : {&whole.camera.position, &whole.camera.right, &whole.camera.down, &whole.camera.forward})
    *v = {c * v->x + s * v->z, v->y, c * v->z - s * v->x};
  whole.photo = in.photo;
  whole.g = scene.trace(whole.camera);
  whole.roles = roles_of(whole.g);
  whole.photo.label.assign(std::size_t(in.camera.width) * std::size_t(in.camera.height), 0);
  for (int i = 0; i < whole.g.size(); ++i)
    whole.photo.label[std::size_t(whole.g.pixel[std::size_t(i)])] = int(whole.roles[std::size_t(i)]) + 1;
  whole.photo.vehicle = whole.g.frame("coverage");
  fitting::Lit lit = fitting::light(scene, whole, in.photo.image, in.panorama, o, watch);
  in.photo = whole.photo;
  in.photo.image = fitting::draw(scene, whole, lit, roles_of, {{paint, {}, {}}}, watch)[0];
  for (float& x : in.photo.image.values) x = detail::to_srgb(std::clamp(x, 0.0f, 1.0f));
  return lit;
}

/// Both fits side by side; the numbers by which they differ, and those that are known.
void compare(const Options& o, const fitting::Seen& seen, const Image& without, const Image& with,
             const fitting::Materials& plain, const fitting::Materials& found, const CarPaint<float>* known) {
  using report::panel;
  write_png(o.output + "/compare.png",
            sheet({{"photo", panel(shot::linear(seen.photo.image))},
                   {"without the pattern", panel(without)},
                   {"with the pattern", panel(with)},
                   {"difference of the last to the photo", panel(report::difference_to_photo(seen, with))}},
                  2));
  const report::Rows a = report::numbers(plain, o), b = report::numbers(found, o);
  std::vector<float> numbers;
  if (known) each([&](const float& x) { numbers.push_back(x); }, *known);
  std::printf("  %-28s %10s %10s %10s\n", "", known ? "known" : "", "without", "with");
  for (std::size_t i = 1; i < std::min(a.size(), b.size()); ++i) {
    if (a[i][5] == "held") continue;
    char text[32] = "";
    if (i <= numbers.size()) std::snprintf(text, sizeof text, "%.3g", double(numbers[i - 1]));
    std::printf("  %-28s %10s %10s %10s\n", a[i][0].c_str(), text, a[i][2].c_str(), b[i][2].c_str());
  }
}

int run(Options o) {
  if (o.threads > 0) set_threads(o.threads);
  const Progress whole("");
  // Everything is read and checked before any work is done and before anything is written.
  looks::Vehicle first{looks::first_paint(), {}, {}};
  std::optional<CarPaint<float>> known;
  if (!o.known.empty()) {
    known = read_model<CarPaint<float>>(o.known);
    std::vector<std::string> names;  // what is held is known to the fit, too
    for_each_parameter(*known, [&](const std::string& name, auto&, Range) { names.push_back(name); });
    std::size_t i = 0;
    each([&](float& x, const float& y) { if (o.frozen(names[i++])) x = y; }, first.paint, *known);
  }
  const fitting::Fits fits(o, first);
  const fitting::MoreLoss pattern = pattern_of(o);
  Inputs in = street::read(o);
  std::vector<int> model_labels;
  if (!o.model_parts.empty()) model_labels = read_labels(o.model_parts, in.camera.width, in.camera.height);
  o.weights = {o.pixels_weight, o.statistics};
  std::printf("%s\n", o.vehicle.c_str());
  for (const std::string& line : in.report.lines) std::printf("  %s\n", line.c_str());

  const Raycaster scene(std::move(in.mesh));
  const parts::RolesOf roles_of = model_labels.empty() ? parts::roles_by_parts(scene, in.roles)
                                                       : roles_by_labels(std::move(model_labels), in.camera);
  const fitting::Watch watch = fitting::on_terminal();
  std::optional<fitting::Lit> light;
  if (known) light = draw_known(in, *known, o.known_turn, scene, roles_of, o, watch), o.yaw = light->yaw;
  const fitting::Seen seen = fitting::see(scene, in.photo, in.camera, roles_of, o, watch, o.camera);
  report::print_materials(seen);
  fitting::Lit lit = fitting::light(scene, seen, in.photo.image, in.panorama, o, watch);
  if (light) lit.world.strength = light->world.strength;

  check_writable(o.output);
  std::optional<fitting::Materials> plain;
  if (o.compare) plain = fitting::fit_materials(seen, lit, o, fits, {}, watch, first);
  o.checkpoints = o.output;
  const fitting::Materials found = fitting::fit_materials(seen, lit, o, fits, pattern, watch, first);
  report::write_materials(o.output, found, seen);
  std::vector<looks::Vehicle> vehicles{first, found.best()};
  if (plain) vehicles.push_back(plain->best());
  const auto pictures = fitting::draw(scene, seen, lit, roles_of, vehicles, watch);
  report::write_pictures(o.output, seen, pictures[0], pictures[1]);
  report::write_page(o, in.report, seen, lit, found,
                     "By step: mean difference of the pixels where part lies on part, that of the parts' means and "
                     "variances, and that of the Gram matrices of their features, each by its weight.",
                     whole.seconds());
  if (plain) compare(o, seen, pictures[2], pictures[1], *plain, found, known ? &*known : nullptr);
  std::printf("\n%s after %.1f s. %s/fit.png shows it, %s/report.html tells all; %s/paint.json can be read back.\n",
              interrupted ? "Interrupted" : "Done", whole.seconds(), o.output.c_str(), o.output.c_str(),
              o.output.c_str());
  return interrupted ? 130 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  o.output = "burnish-parts";
  CLI::App app{
      "Fits the paint, glass and rubber of a posed CAD vehicle to those of a photo, their patterns among it.\n\n"
      "Without arguments: the white pickup of darknet's dog.jpg, a vehicle of sweethome3d-furniture and a panorama of\n"
      "blender-data. For your own:\n\n"
      "  08_fit_parts --photo street.jpg --mask car.png --parts car.parts.png --camera street.camera.json \\\n"
      "               --vehicle car.glb --environment sky.exr --features vgg16.safetensors --output parts\n\n"
      "The loss of a part: 1 times the mean difference of the pixels where it lies on the photo's, plus 0.1 times\n"
      "that of the parts' means and variances, plus 1 times that of the Gram matrices of their features.\n\n"
      "What the pattern is good for, tried on a paint that is known, seen by a camera that is 2 degrees off:\n\n"
      "  08_fit_parts --known spotted.json --known-turn 2 --compare"};
  street::add_options(app, o);
  app.add_option("--features", o.features,
                 "bank: filters at four octaves; or a network's weights, .safetensors or .npz, by torchvision's names")
      ->capture_default_str();
  app.add_option("--pooling", o.pooling, "of the network")
      ->check(CLI::IsMember({"max", "average"}))
      ->capture_default_str();
  const auto weight = CLI::Range(0.0, 1e6);
  app.add_option("--gram", o.gram, "weight of the pattern; 0: none")->check(weight)->capture_default_str();
  app.add_option("--statistics", o.statistics, "weight of means and variances")->check(weight)->capture_default_str();
  app.add_option("--aligned", o.pixels_weight, "weight of the pixels where part lies on part")
      ->check(weight)
      ->capture_default_str();
  app.add_option("--gram-every", o.every, "steps between two looks at the pattern; 0: 1 for the bank, 10 for a network")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  app.add_option("--model-parts", o.model_parts,
                 "labels as --parts has them, of the model as the camera sees it; if not given, found from the model");
  app.add_option("--known", o.known,
                 "a test: the photo's vehicle is drawn, with the paint of this file, and its numbers are to be found");
  app.add_option("--known-turn", o.known_turn, "by how many degrees its camera is turned about the vehicle")
      ->capture_default_str();
  app.add_flag("--compare", o.compare, "fit without the pattern, too, and show both");
  return command(app, argc, argv, [&] {
    street::complete(o, BURNISH_EXAMPLES_DATA);  // masks and camera of the default photo
    catch_interrupt();
    return run(o);
  });
}
