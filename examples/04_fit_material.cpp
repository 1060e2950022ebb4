// examples/04_fit_material.cpp -- a street photo, a CAD vehicle and a panorama go in; a fitted car paint comes out
// SPDX-License-Identifier: Apache-2.0
//
// The way of the data: the vehicle is seen through the photo's camera (a G-buffer, once); the panorama's light is
// gathered for every pixel (once); then render, compare with the photo, go back, step, 300 times; at the end pictures
// and files.
#include <burnish/io/model.h>
#include "command.h"
#include "fit_parts.h"
#include "fit_report.h"

using namespace burnish;
using street::Options, street::Inputs;

namespace {

template <class M> void resume(FitState<M>& state, const Options& o, const char* file, bool needed) {
  const std::string path = o.resume + "/" + file;
  if (!o.resume.empty() && (needed || std::filesystem::exists(path))) from_json(parse_json(path), state, path);
}

int run(Options o) {
  if (o.threads > 0) set_threads(o.threads);
  const Progress whole("");
  // Everything is read and checked before any work is done and before anything is written.
  fitting::Fits fits(o);
  resume(fits.paint, o, "paint.state.json", true), resume(fits.window, o, "glass.state.json", false),
      resume(fits.rubber, o, "rubber.state.json", false);
  Inputs in = street::read(o);
  std::printf("%s\n", o.vehicle.c_str());
  for (const std::string& line : in.report.lines) std::printf("  %s\n", line.c_str());
  std::printf("read           %s (%.2f s)\n", o.photo.c_str(), whole.seconds());

  const Raycaster scene(std::move(in.mesh));
  const parts::RolesOf roles_of = parts::roles_by_parts(scene, in.roles);
  const fitting::Watch watch = fitting::on_terminal();
  const fitting::Seen seen = fitting::see(scene, in.photo, in.camera, roles_of, o, watch, o.camera);
  report::print_materials(seen);
  const fitting::Lit lit = fitting::light(scene, seen, in.photo.image, in.panorama, o, watch);

  // From here on something is written.
  check_writable(o.output);
  o.checkpoints = o.output;
  const fitting::Materials found = fitting::fit_materials(seen, lit, o, std::move(fits), {}, watch);
  report::write_materials(o.output, found, seen);
  const auto pictures =
      fitting::draw(scene, seen, lit, roles_of, {{looks::first_paint(), {}, {}}, found.best()}, watch);
  report::write_pictures(o.output, seen, pictures[0], pictures[1]);
  report::write_page(o, in.report, seen, lit, found,
                     "By step: mean difference of the pixels where paint lies on paint, plus 0.1 times that of the "
                     "parts' means and variances, in display values. Glass and rubber: 0.1 times the first, plus the "
                     "second without the extremes, as wheels and panes of another model do not lie on the photo's.",
                     whole.seconds());
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
  return command(app, argc, argv, [&] {
    street::complete(o, BURNISH_EXAMPLES_DATA);  // masks and camera of the default photo
    catch_interrupt();
    return run(o);
  });
}
