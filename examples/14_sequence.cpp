// examples/14_sequence.cpp -- a vehicle moves through a street: frames with labels, frame by frame, on many machines
// SPDX-License-Identifier: Apache-2.0
//
// Each frame depends on the recipe and its number alone. A frame that is there is not made again, so a run goes on
// where the last one stopped, and jobs may share the frames in any way; --collect then makes one data set of them.
#include <burnish/io/exr.h>
#include <burnish/io/report.h>
#include <burnish/street/trajectory.h>
#include "command.h"
#include "insertion.h"

using namespace burnish;
using nlohmann::ordered_json;

namespace {
struct Recipe {
  std::string trajectory = "drive", output = "burnish-sequence";
  int frames = 24, frame = -1;
  float length = 8, angle = 45;
  bool collect = false;
};
std::string at(const Recipe& r, int k, const char* folder, const char* ending) {
  char name[64];
  std::snprintf(name, sizeof name, "/%s/%06d%s", folder, k, ending);
  return r.output + name;
}
/// Everything that decides what the frames show.
std::string recipe_text(const Recipe& r, const insertion::Options& o) {
  ordered_json j;
  j["trajectory"] = r.trajectory, j["frames"] = r.frames, j["length"] = r.length, j["angle"] = r.angle;
  j["twin"] = o.twin, j["vehicle"] = o.vehicle, j["materials"] = o.materials, j["plate"] = o.plate;
  j["environment"] = o.environment, j["lights"] = o.lights, j["depth"] = o.depth, j["kitti_label"] = o.label,
  j["kitti_calib"] = o.calibration;
  j["kitti_line"] = o.line, j["at"] = o.at, j["pixel"] = o.pixel, j["heading"] = o.heading, j["yaw"] = o.yaw;
  j["focal"] = o.focal, j["above"] = o.above, j["pitch"] = o.pitch, j["roll"] = o.roll, j["wet"] = o.wet;
  j["exposure"] = o.exposure, j["noise"] = o.noise, j["blur"] = o.blur, j["width"] = o.width, j["height"] = o.height;
  j["samples"] = o.preview ? 4 : o.samples, j["preview"] = o.preview, j["noisy"] = o.noisy;
  j["six_lights"] = o.six_lights, j["open"] = o.edit.open, j["hide"] = o.edit.hide, j["joints"] = o.edit.joints;
  j["spin"] = o.edit.spin, j["steer"] = o.edit.steer, j["over"] = o.edit.over;
  return j.dump(1) + "\n";
}
/// One frame; its label is written last, so that a frame with a label is whole.
template <class Show>
void make(const Recipe& r, const insertion::Options& o, insertion::Street& s, int k, float radius, Show show) {
  const float time = r.frames > 1 ? float(k) / float(r.frames - (r.trajectory == "rotate" ? 0 : 1)) : 0;
  const float border = 0.5f * float(s.camera.width) / s.camera.fx;
  const float length = r.trajectory == "occluded" ? bounds(s.mesh).size().x * s.place.scale : r.length;
  const Moment m = moment(*trajectory_of(r.trajectory), time, s.place, length, border);
  editing::Options edit = o.edit;
  edit.spin += m.rolled / radius * 57.29578f;
  if (m.opened > 0) edit.open.push_back("doors=" + std::to_string(r.angle * m.opened));
  insertion::light(s, o, m.place);
  const insertion::Shot shot = insertion::shoot(s, m.place, edit, o, show);
  write_png(at(r, k, "frames", ".png"), shot.composite);
  write_png(at(r, k, "masks", ".png"), shot.visible);
  write_exr(at(r, k, "gbuffers", ".exr"), shot.g);
  ordered_json j = coco_file("frames/" + at(r, k, "", ".png").substr(r.output.size() + 2), shot.visible, shot.seen);
  j["moment"] = {{"right", m.place.right},
                 {"ahead", m.place.ahead},
                 {"heading", m.place.heading},
                 {"rolled", m.rolled},
                 {"opened", m.opened}};
  write_text(at(r, k, "coco", ".json"), j.dump() + "\n");
  write_text(at(r, k, "labels", ".txt"), shot.seen.area > 0 ? kitti_line("Car", shot.seen, shot.box) : "");
}
bool there(const Recipe& r, int k) { return std::filesystem::exists(at(r, k, "labels", ".txt")); }

/// One COCO file of all frames, a sheet and how many are missing.
int collect(const Recipe& r) {
  ordered_json all;
  std::vector<Panel> panels;
  int missing = 0, annotation = 0;
  const int step = std::max(1, r.frames / 12);
  for (int k = 0; k < r.frames; ++k) {
    if (!there(r, k)) {
      ++missing;
      continue;
    }
    ordered_json j = parse_json(at(r, k, "coco", ".json"));
    if (all.empty()) all["categories"] = j["categories"];
    j["images"][0]["id"] = k + 1;
    all["images"].push_back(j["images"][0]);
    if (j["annotations"][0]["area"] > 0) {
      j["annotations"][0]["image_id"] = k + 1, j["annotations"][0]["id"] = ++annotation;
      all["annotations"].push_back(j["annotations"][0]);
    }
    if (k % step == 0) {
      const Image frame = read_photo(at(r, k, "frames", ".png"));
      panels.push_back(
          {"frame " + std::to_string(k), resized(frame, 480, std::max(1, 480 * frame.height / frame.width))});
    }
  }
  if (!panels.empty()) {
    write_text(r.output + "/coco.json", all.dump() + "\n");
    write_png(r.output + "/sheet.png", sheet(panels, 4));
  }
  return missing;
}
}  // namespace

int main(int argc, char** argv) {
  insertion::Options o;
  o.width = 960, o.samples = 32, o.at = {-2.0f, 9}, o.heading = 60;
  Recipe r;
  CLI::App app{
      "Moves a vehicle through a street picture: frames, masks, G-buffers, KITTI and COCO labels.\n\n"
      "  14_sequence --twin burnish-twin --plate street.png --trajectory drive --frames 48 --output drive\n"
      "  14_sequence ... --output drive --frame 7        one frame alone, a job of many\n"
      "  14_sequence ... --output drive --collect        one data set of all that is there\n\n"
      "What is there is not made again; Ctrl-C keeps it. examples/cluster has a Slurm array and a Snakefile."};
  insertion::add_options(app, o);
  app.add_option("--trajectory", r.trajectory, "drive, rotate, occluded or doors (shut, then open)")
      ->capture_default_str();
  app.add_option("--frames", r.frames, "of the whole sequence")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--frame", r.frame, "this one alone, from 0");
  app.add_option("--length", r.length, "metres it drives")->capture_default_str();
  app.add_option("--angle", r.angle, "degrees to which doors open")
      ->check(CLI::Range(0.0f, 90.0f))
      ->capture_default_str();
  app.add_flag("--collect", r.collect, "make no frame; join what is there");
  app.add_option("-o,--output", r.output, "folder of the sequence")->capture_default_str();
  return command(app, argc, argv, [&] {
    if (!trajectory_of(r.trajectory))
      throw Error("--trajectory " + r.trajectory + ": expected drive, rotate, occluded or doors");
    if (r.frame >= r.frames)
      throw Error("--frame " + std::to_string(r.frame) + ": the sequence has frames 0 to " +
                  std::to_string(r.frames - 1));
    Progress whole("");
    const std::string recipe = r.output + "/sequence.json";
    if (!r.collect) {
      insertion::Street street = insertion::read(o);
      check_writable(r.output);
      for (const char* folder : {"frames", "masks", "gbuffers", "coco", "labels"})
        std::filesystem::create_directories(r.output + "/" + folder);
      const std::string text = recipe_text(r, o);
      if (std::filesystem::exists(recipe) && read_text(recipe) != text)
        throw Error(recipe + " is another sequence's recipe: choose another --output, or remove it");
      write_text(recipe, text);
      float radius = 0.33f;
      for (const Wheel& w : find_wheels(street.mesh)) radius = w.spare ? radius : w.radius;
      catch_interrupt();
      Progress bar("frames");
      int made = 0;
      const int first = r.frame < 0 ? 0 : r.frame, last = r.frame < 0 ? r.frames : r.frame + 1;
      for (int k = first; k < last && !interrupted; ++k) {
        if (there(r, k)) continue;
        make(r, o, street, k, radius, [&](int done, int of) {
          bar.show((k - first) * 100 + 100 * done / of, 100 * (last - first), "frame " + std::to_string(k));
        });
        ++made;
      }
      bar.finish(std::to_string(made) + " made, " + std::to_string(last - first - made) +
                 (interrupted ? " left or there" : " were there"));
    }
    if (r.frame < 0) {
      const int missing = collect(r);
      if (missing == r.frames) throw Error(r.output + ": no frame of this sequence is there");
      std::printf(
          "\nDone after %.1f s. %s/frames, masks, gbuffers, labels (KITTI), coco.json; sheet.png shows some%s.\n",
          whole.seconds(), r.output.c_str(),
          missing ? (", " + std::to_string(missing) + " frames are missing").c_str() : "");
    }
    return 0;
  });
}
