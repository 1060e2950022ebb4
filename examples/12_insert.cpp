// examples/12_insert.cpp -- a twin and a street picture go in; the street with it, and its labels, come out
// SPDX-License-Identifier: Apache-2.0
#include "command.h"
#include "insertion.h"

using namespace burnish;

int main(int argc, char** argv) {
  insertion::Options o;
  std::string output = "burnish-insert";
  CLI::App app{
      "Puts a vehicle into a street picture: shadow, reflections, labels.\n\n"
      "  12_insert --twin burnish-twin --plate street.png --environment light.exr --focal 721 --at 1.5,9\n"
      "  12_insert --plate 000008.png --kitti-calib 000008.txt --kitti-label label_2/000008.txt\n\n"
      "Without arguments: Sweet Home 3D's SUV in the city of Blender's panorama."};
  insertion::add_options(app, o);
  app.add_option("-o,--output", output, "folder for pictures and labels")->capture_default_str();
  return command(app, argc, argv, [&] {
    Progress whole("");
    Progress reading("read");
    const insertion::Street street = insertion::read(o);
    check_writable(output);
    catch_interrupt();
    reading.finish(std::to_string(street.mesh.triangles.size()) + " triangles");
    const PlateLook& look = street.found;
    std::printf("plate          exposure %.3f %.3f %.3f, noise %.4f, blur %.2f pixels\n", double(look.exposure.x),
                double(look.exposure.y), double(look.exposure.z), double(look.noise), double(look.blur));
    Progress tracing("trace");
    const insertion::Shot shot = insertion::shoot(street, street.place, o.edit, o, [&](int done, int of) {
      tracing.show(done, of);
      if (interrupted) throw Error("interrupted: nothing is written");
    });
    tracing.finish(std::to_string(o.preview ? 4 : o.samples) + " paths a pixel");
    if (shot.seen.area == 0) std::printf("  the vehicle is not in the picture\n");
    insertion::write(output, shot);
    std::printf(
        "\nDone after %.1f s. %s/composite.png is the street with the vehicle; mask, boxes and layers lie "
        "beside it.\n",
        whole.seconds(), output.c_str());
    return 0;
  });
}
