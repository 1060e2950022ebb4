// examples/fit_report.h -- what a fit of a vehicle's materials leaves behind: files, pictures, a page, and lines
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/io/report.h>
#include "fit_parts.h"

namespace report {
using namespace burnish;
using fitting::Seen, fitting::Lit, fitting::Materials;
using Rows = std::vector<std::vector<std::string>>;

/// Which material of the file was taken as what, and how many pixels of it are seen.
Rows materials_of(const Seen& seen);
void print_materials(const Seen& seen);

void write_materials(const std::string& folder, const Materials& found, const Seen& seen);

/// A picture as wide as the others on a sheet.
Image panel(const Image& image);
Image difference_to_photo(const Seen& seen, Image drawn);
/// fit.png, after.png, gbuffer.png. before, after: linear light.
void write_pictures(const std::string& folder, const Seen& seen, const Image& before, const Image& after);

/// Every fitted number.
Rows numbers(const Materials& found, const fitting::Settings& settings);
void print(const Rows& rows);

/// report.html, and loss.png in it; the pictures are read from the folder. loss: a sentence on what the curve shows.
void write_page(const street::Options& o, const MeshReport& mesh, const Seen& seen, const Lit& lit,
                const Materials& found, const std::string& loss, double seconds);

}  // namespace report
