// burnish/street/trajectory.h -- what a vehicle does from frame to frame
// SPDX-License-Identifier: Apache-2.0
//
// Functions of the time 0 .. 1 alone, so that any frame can be made by itself. Three trajectories as UrbanCAD's scenes
// have them: along a lane, once round, and near, half out of sight; and one that stands and opens its doors.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <burnish/street/place.h>

namespace burnish {

enum class Trajectory { drive, rotate, occluded, doors };
inline constexpr std::array<std::string_view, 4> trajectory_names{"drive", "rotate", "occluded", "doors"};
constexpr std::optional<Trajectory> trajectory_of(std::string_view name) {
  for (std::size_t k = 0; k < trajectory_names.size(); ++k)
    if (trajectory_names[k] == name) return Trajectory(k);
  return {};
}

/// Where it is in one frame.
struct Moment {
  Placement place;
  float rolled = 0;  ///< metres that its wheels have rolled
  float opened = 0;  ///< 0 shut to 1
};
/// time: 0 to 1. start: where and how it stands in the beginning; length: metres.
/// drive: `length` the way it points. rotate: once round on its place, to the left. occluded: near (5.5 m ahead at
/// most) across the picture's left border, which lies `border` m to the side for each metre ahead: its nose comes in,
/// till half of it is seen; `length` is the vehicle's. doors: shut in the first half, open in the second.
inline Moment moment(Trajectory way, float time, const Placement& start, float length, float border = 0.6f) {
  Moment m{start};
  switch (way) {
    case Trajectory::drive: {
      const vec3<float> front = start.turn({1, 0, 0});
      m.rolled = length * time;
      m.place.right += front.x * m.rolled, m.place.ahead -= front.z * m.rolled;
      break;
    }
    case Trajectory::rotate:
      m.place.heading -= 6.2831853f * time;
      break;
    case Trajectory::occluded: {
      m.place.ahead = std::min(start.ahead, 5.5f);
      m.place.right = -border * m.place.ahead - 0.5f * length * (1 - time);
      m.place.heading = 1.5707963f;
      m.rolled = 0.5f * length * time;
      break;
    }
    case Trajectory::doors:
      m.opened = time < 0.5f ? 0.0f : 1.0f;
      break;
  }
  return m;
}

}  // namespace burnish
