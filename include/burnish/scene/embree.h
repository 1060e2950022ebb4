// burnish/scene/embree.h -- one way to call Embree 3 and Embree 4
// SPDX-License-Identifier: Apache-2.0
//
// The only file that names Embree.
#pragma once
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <burnish/math/vec.h>

namespace burnish {
namespace detail {
/// One call for both Embrees; coherent: the 16 rays go nearly the same way.
struct Query {
#if RTC_VERSION_MAJOR >= 4
  static void intersect(RTCScene scene, const int* valid, RTCRayHit16& r, bool coherent) {
    RTCIntersectArguments a;
    rtcInitIntersectArguments(&a);
    a.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcIntersect16(valid, scene, &r, &a);
  }
  static void occluded(RTCScene scene, const int* valid, RTCRay16& r, bool coherent) {
    RTCOccludedArguments a;
    rtcInitOccludedArguments(&a);
    a.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcOccluded16(valid, scene, &r, &a);
  }
  static void intersect(RTCScene scene, RTCRayHit& r) { rtcIntersect1(scene, &r); }
  static void occluded(RTCScene scene, RTCRay& r) { rtcOccluded1(scene, &r); }
#else
  static RTCIntersectContext context(bool coherent) {
    RTCIntersectContext c;
    rtcInitIntersectContext(&c);
    c.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return c;
  }
  static void intersect(RTCScene scene, const int* valid, RTCRayHit16& r, bool coherent) {
    RTCIntersectContext c = context(coherent);
    rtcIntersect16(valid, scene, &c, &r);
  }
  static void occluded(RTCScene scene, const int* valid, RTCRay16& r, bool coherent) {
    RTCIntersectContext c = context(coherent);
    rtcOccluded16(valid, scene, &c, &r);
  }
  static void intersect(RTCScene scene, RTCRayHit& r) {
    RTCIntersectContext c = context(false);
    rtcIntersect1(scene, &c, &r);
  }
  static void occluded(RTCScene scene, RTCRay& r) {
    RTCIntersectContext c = context(false);
    rtcOccluded1(scene, &c, &r);
  }
#endif
};
inline void set_ray(RTCRay16& r, int k, const vec3<float>& o, const vec3<float>& d, float far) {
  r.org_x[k] = o.x, r.org_y[k] = o.y, r.org_z[k] = o.z;
  r.dir_x[k] = d.x, r.dir_y[k] = d.y, r.dir_z[k] = d.z;
  r.tnear[k] = 0, r.tfar[k] = far, r.time[k] = 0, r.mask[k] = ~0u, r.id[k] = 0, r.flags[k] = 0;
}
inline RTCRay one_ray(const vec3<float>& o, const vec3<float>& d, float far) {
  RTCRay r;
  r.org_x = o.x, r.org_y = o.y, r.org_z = o.z, r.dir_x = d.x, r.dir_y = d.y, r.dir_z = d.z;
  r.tnear = 0, r.tfar = far, r.time = 0, r.mask = ~0u, r.id = 0, r.flags = 0;
  return r;
}
struct ReleaseEmbree {
  void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
};
}  // namespace detail

}  // namespace burnish
