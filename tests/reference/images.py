# tests/reference/images.py -- pictures of the car by Mitsuba: what its camera sees, under suns, under a sky
# SPDX-License-Identifier: Apache-2.0
"""All at the pixels' centres: a stratified sampler without jitter, one sample a pixel, a box filter. A picture is
stored for those pixels only that hit the car, in the order of the rows."""
import drjit as dr
import mitsuba as mi
import numpy as np

from car import EYE, FOV, NEAR, PARTS, TARGET, car
import layered  # registers the BSDF

WIDTH, HEIGHT = 96, 64
SMALL_WIDTH, SMALL_HEIGHT = 36, 24  # under the sky
# A sun: the direction that its light takes, and the irradiance of a surface that faces it.
SUNS = [((-0.55, -0.72, -0.43), (2.4, 2.2, 1.9)), ((0.35, -0.5, -0.8), (0.5, 0.8, 1.2))]


def mesh(part, bsdf, name):
    vertices, triangles = car()
    own = triangles[triangles[:, 3] == part, :3]
    used, place = np.unique(own, return_inverse=True)
    return triangle_mesh(name, vertices[used], place.reshape(-1, 3), bsdf)


def triangle_mesh(name, vertices, triangles, bsdf):
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf)
    m = mi.Mesh(name, len(vertices), len(triangles), has_vertex_normals=True, has_vertex_texcoords=True,
                props=properties)
    p = mi.traverse(m)
    for key, columns in [("positions", slice(0, 3)), ("normals", slice(3, 6)), ("texcoords", slice(6, 8))]:
        p["vertex_" + key] = vertices[:, columns].astype(np.float32).ravel()
    p["faces"] = triangles.astype(np.uint32).ravel()
    p.update()
    return m


def camera(width, height):
    return {"type": "perspective", "fov": FOV, "fov_axis": "x", "near_clip": NEAR,
            "to_world": mi.ScalarTransform4f().look_at(EYE, TARGET, (0, 1, 0)),
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"},
                     "pixel_format": "rgb", "component_format": "float32"},
            "sampler": {"type": "stratified", "jitter": False, "sample_count": 1}}


def scene_of(bsdfs, width, height, **more):
    return mi.load_dict({"type": "scene", "embree_use_robust_intersections": True, "sensor": camera(width, height),
                         **{name: mesh(i, bsdfs[i], name) for i, name in enumerate(PARTS)}, **more})


def shot(scene, integrator, **more):
    return mi.render(scene, integrator=mi.load_dict(integrator), spp=1, **more)


def part_ids(scene, shaded=False):
    """Which part each pixel sees, 255 none: Mitsuba's own numbers of its shapes are none that one can foresee. shaded:
    none as well where the interpolated normal looks away from the viewer: Mitsuba is black, burnish bends it."""
    aovs = np.array(shot(scene, {"type": "aov", "aovs": "s:shape_index,n:sh_normal,p:position"}))
    seen, view = aovs[..., 0], np.array(EYE) - aovs[..., 4:7]
    own = {name: dr.reinterpret_array(mi.UInt32, mi.ShapePtr(s))[0] for s in scene.shapes() for name in PARTS
           if s.id() == name}
    ids = np.full(seen.shape, 255, np.uint8)
    for i, name in enumerate(PARTS):
        ids[seen == own[name]] = i
    if shaded:
        ids[(view * aovs[..., 1:4]).sum(-1) < 0.01 * np.linalg.norm(view, axis=-1)] = 255
    return ids


def gbuffer():
    scene = scene_of([{"type": "diffuse"}] * 4, WIDTH, HEIGHT)
    ids = part_ids(scene)
    aovs = np.array(shot(scene, {"type": "aov", "aovs": "p:position,g:geo_normal,n:sh_normal,t:dp_du,uv:uv,d:depth"}))
    # Coverage: 8 x 8 rays a pixel, at the places that raycast.h documents; counted.
    places = [((i + (j + 0.5) / 8) / 8, (j + (i + 0.5) / 8) / 8) for j in range(8) for i in range(8)]
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    covered = np.zeros(WIDTH * HEIGHT, np.uint8)
    for dx, dy in places:
        at = mi.Point2f(((x + dx) / WIDTH).ravel(), ((y + dy) / HEIGHT).ravel())
        covered += np.array(scene.ray_test(scene.sensors()[0].sample_ray(0, 0, at, 0)[0])).astype(np.uint8)
    vertices, triangles = car()
    return {"car_vertices": (vertices, 1e-6), "car_triangles": (triangles, 0), "car_parts": (ids, 0),
            "car_gbuffer": (aovs[ids < 255].astype(np.float32), 1e-4), "car_covered": (covered.reshape(ids.shape), 0)}


def weights(width, height):
    """The loss is the sum of these times the picture: pixel p = y width + x, channel c."""
    p, c = np.arange(width * height)[:, None], np.arange(3)
    return (0.2 + 0.1 * ((7 * p + 3 * c) % 11)).astype(np.float32)


# --- suns: a normal map over a blend of diffuse and GGX metal, and over principled
PAINTS = [dict(color=(0.62, 0.13, 0.08), roughness=0.38, metalness=0.45),
          dict(color=(0.15, 0.2, 0.26), roughness=0.24, metalness=0.7),
          dict(color=(0.22, 0.21, 0.2), roughness=0.62, metalness=0.3),
          dict(color=(0.45, 0.41, 0.36), roughness=0.8, metalness=0.1)]
MAP_WIDTH, MAP_HEIGHT = 16, 8


def normal_map():
    """A normal coded as colour, 0.5 + 0.5 n, before it is made unit; some periods of sines, unlike in u and v."""
    y, x = np.mgrid[0:MAP_HEIGHT, 0:MAP_WIDTH]
    u, v = (x + 0.5) / MAP_WIDTH, (y + 0.5) / MAP_HEIGHT
    return np.stack([0.5 + 0.09 * np.sin(2 * np.pi * (2 * u + v)), 0.5 + 0.07 * np.cos(2 * np.pi * (u - 2 * v) + 0.4),
                     0.95 + 0.04 * np.sin(2 * np.pi * (u + v))], -1).astype(np.float32)


def bumped(bsdf):
    return {"type": "normalmap", "flip_invalid_normals": False, "use_shadowing_function": False, "nested_bsdf": bsdf,
            "normalmap": {"type": "bitmap", "data": mi.TensorXf(normal_map()), "raw": True, "filter_type": "bilinear",
                          "wrap_mode": "repeat"}}


def blend(paint):
    color = {"type": "rgb", "value": paint["color"]}
    return bumped({"type": "blendbsdf", "weight": paint["metalness"],
                   "bsdf_0": {"type": "diffuse", "reflectance": color},
                   "bsdf_1": {"type": "roughconductor", "distribution": "ggx", "alpha": paint["roughness"]**2,
                              "specular_reflectance": color}})


def set_blend(params, id, color, roughness, metalness):
    inside = id + ".bsdf.nested_bsdf."
    params[inside + "bsdf_0.reflectance.value"] = color
    params[inside + "bsdf_1.specular_reflectance.value"] = color
    params[inside + "bsdf_1.alpha.value"] = roughness * roughness
    params[inside + "weight.value"] = metalness


def principled(paint):
    return bumped({"type": "principled", "base_color": {"type": "rgb", "value": paint["color"]},
                   "roughness": paint["roughness"], "metallic": paint["metalness"], "anisotropic": 0.4,
                   "specular": 0.6, "spec_tint": 0.2, "sheen": 0.3, "sheen_tint": 0.4, "flatness": 0.25,
                   "clearcoat": 0.5, "clearcoat_gloss": 0.3})


def set_principled(params, id, color, roughness, metalness):
    inside = id + ".bsdf.nested_bsdf."
    params[inside + "base_color.value"] = color
    params[inside + "roughness.value"] = roughness
    params[inside + "metallic.value"] = metalness


def under_suns(bsdf, set_bsdf):
    """Per sun: the picture, its gradient by parts x (colour, roughness, metalness) and by parts x texels of the map."""
    pictures, slopes, texels = [], [], []
    for direction, irradiance in SUNS:
        scene = scene_of([bsdf(p) for p in PAINTS], WIDTH, HEIGHT, sun={
            "type": "directional", "direction": direction, "irradiance": {"type": "rgb", "value": irradiance}})
        ids = part_ids(scene, shaded=True)
        hit = ids.ravel() < 255
        weigh = (weights(WIDTH, HEIGHT) * hit[:, None]).ravel()
        params = mi.traverse(scene)
        paints, maps = [], []
        for id, paint in zip(PARTS, PAINTS):
            m = mi.TensorXf(normal_map())
            numbers = [mi.Color3f(paint["color"]), mi.Float(paint["roughness"]), mi.Float(paint["metalness"])]
            dr.enable_grad(m, *numbers)
            set_bsdf(params, id, *numbers)
            params[id + ".bsdf.normalmap.data"] = m
            paints.append(numbers)
            maps.append(m)
        params.update()
        picture = shot(scene, {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0}, params=params)
        dr.backward(dr.sum(picture.array * mi.Float(weigh)))
        pictures.append(np.array(picture).reshape(-1, 3)[hit])
        slopes.append([[*np.array(dr.grad(c)).ravel(), dr.grad(r)[0], dr.grad(m)[0]] for c, r, m in paints])
        texels.append([np.array(dr.grad(m)) for m in maps])
    pack = lambda a: np.array(a, np.float32)
    return ids, pack(pictures), pack(slopes), pack(texels)


# --- sky: burnish's own layers, integrated by Mitsuba
SURFACES = [dict(base_color=(0.55, 0.09, 0.06), specular_roughness=0.4, base_metalness=0.5, coat_weight=0.8,
                 coat_roughness=0.25),
            dict(base_color=(0.1, 0.13, 0.16), specular_roughness=0.25, base_metalness=0.2, coat_weight=0.0,
                 coat_roughness=0.3),
            dict(base_color=(0.5, 0.48, 0.45), specular_roughness=0.5, base_metalness=0.9, coat_weight=0.0,
                 coat_roughness=0.3),
            dict(base_color=(0.4, 0.37, 0.33), specular_roughness=0.85, base_metalness=0.05, coat_weight=0.1,
                 coat_roughness=0.35)]
BUMP = (0.48, 0.62, 0.62)  # where the sky is brightest, before it is made unit


def sky(d):
    """Radiance by unit direction (..., 3): blue above, warm below, a bright bump 2.6 degrees wide. As in images.h."""
    y = d[..., 1:2]
    above = 0.5 + 0.5 * np.tanh(6 * y)
    bump = np.exp((d @ (np.array(BUMP) / np.linalg.norm(BUMP)) - 1) / 0.002)[..., None]
    return (above * (0.7 - 0.4 * y) * np.array([0.5, 0.75, 1.2]) + (1 - above) * np.array([0.3, 0.21, 0.12]) +
            bump * np.array([42.0, 36.0, 27.0]))


def panorama(height):
    """As Mitsuba's envmap reads it: columns are texels' centres, the first and the last row are the poles."""
    t = np.pi * np.arange(height) / (height - 1)
    p = 2 * np.pi * (np.arange(2 * (height - 1)) + 0.5) / (2 * (height - 1))
    t, p = np.meshgrid(t, p, indexing="ij")
    return sky(np.stack([np.sin(t) * np.sin(p), np.cos(t), -np.sin(t) * np.cos(p)], -1)).astype(np.float32)


def alone(points, normals, views, parts, bsdfs):
    """A scene in which nothing is in anything's way: for every point a triangle of its own, far from the others, and a
    ray at it along the point's own view."""
    n = len(points)
    side = np.where(np.abs(normals[:, :1]) < 0.6, [[1.0, 0, 0]], [[0, 1.0, 0]])
    x = np.cross(side, normals)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(normals, x)
    place = np.stack([np.arange(n) % 32, np.zeros(n), np.arange(n) // 32], -1) * 10.0
    corners = np.stack([place + 0.01 * (x * np.cos(a) + y * np.sin(a)) for a in 2 * np.pi * np.arange(3) / 3], 1)
    vertices = np.concatenate([corners, np.repeat(normals[:, None], 3, 1), np.zeros((n, 3, 2))], -1)
    meshes = {}
    for i, name in enumerate(PARTS):
        own = vertices[parts == i].reshape(-1, 8)
        meshes[name] = triangle_mesh(name, own, np.arange(len(own)).reshape(-1, 3), bsdfs[i])
    return meshes, mi.Ray3f(mi.Point3f((place + views).T), mi.Vector3f(-views.T))


def under_sky(blocked, runs, samples):
    """Mean over `runs` of picture and gradient by parts x (colour, roughness, metalness, coat weight and roughness),
    and the standard errors of these means."""
    env = {"type": "envmap", "bitmap": mi.Bitmap(panorama(513))}
    bsdfs = [{"type": "layered", **s, "base_color": mi.ScalarColor3f(s["base_color"])} for s in SURFACES]
    seen = scene_of(bsdfs, SMALL_WIDTH, SMALL_HEIGHT, sky=env)
    ids = part_ids(seen, shaded=True)
    hit = ids.ravel() < 255
    n, parts = int(hit.sum()), ids.ravel()[hit]
    y, x = np.mgrid[0:SMALL_HEIGHT, 0:SMALL_WIDTH]
    at = mi.Point2f(((x.ravel()[hit] + 0.5) / SMALL_WIDTH), ((y.ravel()[hit] + 0.5) / SMALL_HEIGHT))
    ray = mi.Ray3f(seen.sensors()[0].sample_ray(0, 0, at, 0)[0])
    if blocked:
        scene = seen
    else:
        si = seen.ray_intersect(ray)
        meshes, ray = alone(np.array(si.p).T, np.array(si.sh_frame.n).T, -np.array(ray.d).T, parts, bsdfs)
        scene = mi.load_dict({"type": "scene", "sky": env, **meshes})
    params = mi.traverse(scene)
    keys = [f"{id}.bsdf.{name}" for id in PARTS for name in layered.Layered.NAMES]
    integrator = mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 1})
    w = weights(SMALL_WIDTH, SMALL_HEIGHT)[hit]
    which = dr.repeat(dr.arange(mi.UInt32, n), samples)
    rays = dr.gather(mi.Ray3f, ray, which)
    weigh = [dr.gather(mi.Float, mi.Float(w[:, c].copy()), which) for c in range(3)]
    pictures, slopes = [], []
    for run in range(runs):
        for key in keys:
            dr.disable_grad(params[key])
            dr.enable_grad(params[key])
        params.update()
        sampler = mi.load_dict({"type": "multijitter", "sample_count": samples})
        sampler.set_samples_per_wavefront(samples)
        sampler.seed(run + (1000 if blocked else 0), n * samples)
        color, _, _ = integrator.sample(scene, sampler, mi.RayDifferential3f(rays))
        dr.backward(dr.sum(sum(color[c] * weigh[c] for c in range(3))) / samples)
        channels = [np.array(dr.block_sum(dr.detach(color[c]), samples)) / samples for c in range(3)]
        pictures.append(np.stack(channels, -1))
        slopes.append(np.concatenate([np.array(dr.grad(params[k])).ravel() for k in keys]).reshape(len(PARTS), -1))
    out = []
    for a in (np.array(pictures, np.float64), np.array(slopes, np.float64)):
        out += [a.mean(0).astype(np.float32), (a.std(0, ddof=1) / np.sqrt(runs)).astype(np.float32)]
    return ids, out


def arrays():
    result = gbuffer()
    for name, bsdf, set_bsdf in [("blend", blend, set_blend), ("principled", principled, set_principled)]:
        ids, picture, slope, texels = under_suns(bsdf, set_bsdf)
        result |= {"car_shaded": (ids, 0), f"car_{name}": (picture, 1e-4), f"car_{name}_slope": (slope, 1e-4),
                   f"car_{name}_texels": (texels, 1e-3)}
    for name, blocked in [("open", False), ("blocked", True)]:
        ids, (picture, error, slope, slope_error) = under_sky(blocked, runs=32, samples=1024)
        result |= {"car_small_shaded": (ids, 0), f"sky_{name}": (picture, 0.02), f"sky_{name}_error": (error, 1),
                   f"sky_{name}_slope": (slope, 0.02), f"sky_{name}_slope_error": (slope_error, 1)}
    return result
