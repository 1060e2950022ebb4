// burnish/io/build_library.h -- folders of vehicle files become a library, each file once
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdlib>
#include <functional>
#include <burnish/io/children.h>
#include <burnish/io/library.h>
#include <burnish/io/vehicle_files.h>
#include <burnish/twin/describe.h>
#include <burnish/twin/preview.h>
#include <burnish/twin/usable.h>

namespace burnish {

struct LibraryOptions {
  int workers = 0;              // processes at a time; 0: as many as cores
  ChildLimits limits;           // of each file
  ViewOptions views;            // a vehicle is described from
  double save_every = 10;       // seconds, at least; and never for more than a twentieth of the time
};
struct LibraryBuild {
  Library vehicles;
  std::vector<std::string> notes;  // of the search for files
  int found = 0, done = 0, left = 0, gone = 0;
  double seconds = 0;              // of the work on files
};

namespace detail {
/// What tells apart descriptions that do not go together.
inline std::string descriptor_of(const ViewOptions& v) {
  return "burnish views 1, " + std::to_string(view_numbers) + " numbers, " + std::to_string(v.azimuths) + " x " +
         std::to_string(v.elevations.size()) + " views";
}

/// A file read, judged and, if it is of use, described. rule: what the user says of it, or null. Never throws but for
/// want of memory.
inline Library described(LibraryEntry e, const LibraryRule* rule, const LibraryOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  Library out;
  e.status = LibraryStatus::failed, e.reason.clear(), e.by_hand = false, e.shape.clear();
  const bool wanted = rule && rule->accept;
  try {
    const std::string odd_by_name = odd_name(e.name);
    if (!odd_by_name.empty() && !wanted) {
      e.status = LibraryStatus::refused, e.reason = odd_by_name;
      out.entries = {std::move(e)};
      return out;
    }
    Mesh mesh = read_vehicle(e.path);
    const Box box = bounds(mesh);
    e.size = box.size(), e.parts = int(mesh.parts.size()), e.materials = materials_of(mesh);
    e.triangles = int(mesh.triangles.size());
    e.shape = fingerprint(mesh);
    if (!finite(e.size)) throw Error("its size is not finite");
    if (!std::all_of(e.shape.begin(), e.shape.end(), [](float x) { return finite(x); })) e.shape.clear();
    std::string odd = odd_by_name.empty() ? odd_proportions(mesh) : odd_by_name;
    e.status = LibraryStatus::refused;
    if (odd.empty() || wanted) {
      const Raycaster scene(std::move(mesh));
      if (odd.empty()) odd = inseparable(scene.mesh(), SeenParts(scene));
      if (odd.empty() || wanted) {
        e.status = LibraryStatus::indexed;
        DescribedViews views = describe_views(scene, options.views);
        LibrarySpace& s = out.spaces["views"];
        s.columns = view_numbers, s.entry.assign(views.azimuth.size(), 0);
        s.azimuth = std::move(views.azimuth), s.elevation = std::move(views.elevation),
        s.values = std::move(views.rows);
        const Image small = preview(
            scene, burnish::framed(box, 0.6f, 0.22f, Library::thumbnail_width, Library::thumbnail_height).camera(), 24);
        out.thumbnail_of = {0};
        for (std::size_t i = 0; i < std::size_t(small.width) * std::size_t(small.height); ++i)
          for (int c = 0; c < 3; ++c)
            out.thumbnails.push_back(
                std::uint8_t(std::lround(255 * to_srgb(std::clamp(small.plane(c)[i], 0.0f, 1.0f)))));
      }
    }
    if (wanted && !odd.empty()) odd = "accepted by hand though: " + odd;
    e.by_hand = wanted, e.reason = odd;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& x) {
    e.reason = x.what();
    std::replace(e.reason.begin(), e.reason.end(), '\n', ' ');
    if (e.reason.rfind(e.path + ": ", 0) == 0) e.reason.erase(0, e.path.size() + 2);
    if (e.reason.find("bad_alloc") != std::string::npos)  // as Assimp hands it on
      e.reason = "too large for memory: more than " + std::to_string(options.limits.megabytes) + " MB";
    e.status = LibraryStatus::failed, e.by_hand = false;
    out.spaces.clear(), out.thumbnails.clear(), out.thumbnail_of.clear();
  }
  e.seconds = std::chrono::duration<float>(std::chrono::steady_clock::now() - start).count();
  out.entries = {std::move(e)};
  return out;
}

/// A folder for what children leave, removed with it.
class Scratch {
public:
  Scratch() : path_((std::filesystem::temp_directory_path() / "burnish-XXXXXX").string()) {
    if (!mkdtemp(path_.data())) throw Error(path_ + ": cannot be made: " + std::strerror(errno));
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string file(int i) const { return path_ + "/" + std::to_string(i); }

private:
  std::string path_;
};
/// Whether a path is one of the folders or below one.
inline bool below(const std::string& path, const std::vector<std::string>& folders) {
  return std::any_of(folders.begin(), folders.end(), [&](const std::string& f) {
    std::error_code failed;
    std::string top = std::filesystem::absolute(f, failed).lexically_normal().string();
    while (top.size() > 1 && top.back() == '/') top.pop_back();
    return path.rfind(top, 0) == 0 &&
           (path.size() == top.size() || top == "/" || path[top.size()] == '/' || path[top.size()] == ':');
  });
}
}  // namespace detail

/// Brings the index at a path up to date with the folders, and makes it where there is none. What is new, has changed
/// (in size or time of writing) or falls under another rule is read and described, each file in a process of its own
/// (children.h); what is gone from the folders is dropped; entries from elsewhere stay. rules: added to the index's.
/// progress(done, of, seconds that one took) is told; when stop() is true the work ends early: what is done is kept,
/// and the next call goes on. Where nothing is new the index is not written. Error for a folder that is not there and
/// for a damaged index.
template <class Progress, class Stop>
LibraryBuild build_library(const std::string& index, const std::vector<std::string>& folders,
                           const std::vector<LibraryRule>& rules, const LibraryOptions& options, Progress progress,
                           Stop stop) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); };
  LibraryBuild out;
  Library known;
  if (std::filesystem::exists(index)) known = read_library(index);
  const VehicleFiles found = find_vehicle_files(folders);
  out.notes = found.notes, out.found = int(found.files.size());
  for (const LibraryRule& r : rules) {
    known.rules.erase(std::remove_if(known.rules.begin(), known.rules.end(),
                                     [&](const LibraryRule& k) { return k.pattern == r.pattern; }),
                      known.rules.end());
    known.rules.push_back(r);
  }
  const bool other_descriptor = known.descriptor != detail::descriptor_of(options.views);
  known.descriptor = detail::descriptor_of(options.views);

  std::vector<LibraryEntry> files = found.files;  // to be done, if need be
  {  // Entries from elsewhere are done again with another descriptor, or when they fall under another rule.
    std::vector<bool> listed(known.entries.size());
    for (const LibraryEntry& f : files)
      if (const int i = known.find(f.path); i >= 0) listed[std::size_t(i)] = true;
    for (std::size_t i = 0; i < known.entries.size(); ++i)
      if (!listed[i] && !detail::below(known.entries[i].path, folders)) files.push_back(known.entries[i]);
  }
  std::set<std::string> there;
  for (const LibraryEntry& f : files) there.insert(f.path);
  Library kept = merged({&known}, [&](const LibraryEntry& e) { return !there.count(e.path); });
  out.gone = int(known.entries.size() - kept.entries.size());
  bool news = other_descriptor || out.gone > 0 || !rules.empty();  // that the index has not
  std::vector<LibraryEntry> jobs;
  std::vector<const LibraryRule*> ruled;
  std::vector<LibraryEntry> by_rule;  // refused without a look
  for (const LibraryEntry& f : files) {
    const LibraryRule* const rule = rule_for(known, f);
    const int i = kept.find(f.path);
    LibraryEntry* const e = i >= 0 ? &kept.entries[std::size_t(i)] : nullptr;
    const bool changed = !e || e->bytes != f.bytes || e->modified != f.modified;
    if (rule && !rule->accept) {
      LibraryEntry no = e && !changed ? *e : f;
      const std::string reason = "refused by hand: " + rule->pattern;
      news = news || changed || no.status != LibraryStatus::refused || no.reason != reason;
      no.status = LibraryStatus::refused, no.by_hand = true, no.reason = reason;
      by_rule.push_back(no);
      continue;
    }
    const bool stale = other_descriptor && e && e->status == LibraryStatus::indexed;
    const bool overruled = !changed && (rule ? e->status != LibraryStatus::indexed : e->by_hand);
    if (changed || stale || overruled) jobs.push_back(f), ruled.push_back(rule);
    else e->by_hand = rule != nullptr;
  }
  // A duplicate counts as long as what it is the same as does.
  std::set<std::string> undecided;
  for (const std::vector<LibraryEntry>* l : {&jobs, &by_rule})
    for (const LibraryEntry& e : *l) undecided.insert(e.path);
  for (const LibraryEntry& e : kept.entries) {
    if (e.status != LibraryStatus::duplicate || undecided.count(e.path)) continue;
    const std::string original = e.reason.substr(std::min(e.reason.size(), detail::same_as.size()));
    const int o = kept.find(original);
    if (o < 0 || kept.entries[std::size_t(o)].status != LibraryStatus::indexed || undecided.count(original))
      jobs.push_back(e), ruled.push_back(nullptr);
  }

  std::vector<Library> fresh(1);
  fresh[0].entries = by_rule;
  const auto all = [&] {
    std::vector<const Library*> parts{&kept};
    for (const Library& f : fresh) parts.push_back(&f);
    Library l = merged(parts, [](const LibraryEntry&) { return false; });
    mark_duplicates(l);
    return merged({&l}, [](const LibraryEntry&) { return false; });
  };
  const detail::Scratch scratch;
  const Clock::time_point start = Clock::now();
  Clock::time_point saved = start;
  double saving = 0;
  const auto save = [&] {
    const Clock::time_point t = Clock::now();
    out.vehicles = all();
    write_library(index, out.vehicles);
    saving = since(t), saved = Clock::now();
  };
  const int workers = options.workers > 0 ? options.workers : int(std::max(1u, std::thread::hardware_concurrency()));
  in_children(
      int(jobs.size()), workers, options.limits,
      [&](int i) {
        write_library(scratch.file(i), detail::described(jobs[std::size_t(i)], ruled[std::size_t(i)], options));
      },
      [&](int i, const ChildEnd& end) {
        LibraryEntry e = jobs[std::size_t(i)];
        e.status = LibraryStatus::failed, e.reason = end.text, e.seconds = float(end.seconds);
        Library one;
        one.entries = {e};
        if (end.done) try {
            one = read_library(scratch.file(i));
            if (one.entries.size() != 1 || one.entries[0].path != e.path) throw Error("its path is not UTF-8");
          } catch (const std::exception& x) {
            one = Library();
            e.reason = std::string("its description cannot be read: ") + x.what();
            one.entries = {e};
          }
        std::error_code ignored;
        std::filesystem::remove(scratch.file(i), ignored);
        fresh.push_back(std::move(one));
        progress(++out.done, int(jobs.size()), end.seconds);
        if (since(saved) > std::max(options.save_every, 20 * saving)) save();
      },
      [&] { return !stop(); });
  out.left = int(jobs.size()) - out.done;
  out.seconds = since(start);
  if (news || out.done > 0) save();
  else out.vehicles = all();
  return out;
}

}  // namespace burnish
