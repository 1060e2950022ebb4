# tests/reference/bsdf.py -- Fresnel curves, microfacets and BSDFs of Mitsuba 3, with their derivatives
# SPDX-License-Identifier: Apache-2.0
"""<name>_value is what Mitsuba evaluates at 10,000 points, <name>_by_<parameter> the derivative of it, or, if it is a
colour, of x + 2 y + 3 z. BSDFs are f_r times the cosine of the light."""
import drjit as dr
import mitsuba as mi
import numpy as np

from inputs import between, directions

SIDE = 100
COUNT = SIDE * SIDE


def vector(a):
    return mi.Vector3f(np.ascontiguousarray(a.T))


def stored(x):
    """float32: (count,) of numbers, (count, 2 or 3) of vectors and colours."""
    return np.ascontiguousarray(np.array(dr.detach(x), np.float32).T)


def differentiated(out, name, evaluate, parameters, tolerance=1e-4):
    """evaluate(parameters as a dict of Dr.Jit numbers or colours) -> number or colour, and all its derivatives. These
    are differences of large numbers at some points, and get a tolerance ten times as large."""
    parameters = {key: dr.detach(p) for key, p in parameters.items()}  # gradients add up in what is used twice
    for p in parameters.values():
        dr.enable_grad(p)
    y = evaluate(parameters)
    three = isinstance(y, mi.Color3f)
    dr.backward(y.x + 2 * y.y + 3 * y.z if three else y)
    out[f"{name}_value"] = (stored(y), tolerance)
    for key, p in parameters.items():
        out[f"{name}_by_{key}"] = (stored(dr.grad(p)), 10 * tolerance)


def image(channels=1):
    """A parameter that differs from point to point: point i is texel i of a picture, read at its centre (at_texels). A
    parameter that is one number does not take an array in this version."""
    data = mi.TensorXf(np.full((SIDE, SIDE, channels), 0.5, np.float32))
    return {"type": "bitmap", "data": data, "raw": True, "filter_type": "nearest"}


def at_texels():
    i = np.arange(COUNT)
    return mi.Point2f(np.float32((i % SIDE + 0.5) / SIDE), np.float32((i // SIDE + 0.5) / SIDE))


def evaluated(bsdf, v, l):
    """As a function of the parameters that are image()s, by name, and of "specular", which may be an array."""
    params = mi.traverse(bsdf)

    def evaluate(given):
        for key, value in given.items():
            if key in params:
                params[key] = value
            else:
                channels = 3 if isinstance(value, mi.Color3f) else 1
                params[f"{key}.data"] = mi.TensorXf(dr.ravel(value), (SIDE, SIDE, channels))
        params.update()
        si = dr.zeros(mi.SurfaceInteraction3f, COUNT)
        si.wi, si.uv = vector(v), at_texels()
        return bsdf.eval(mi.BSDFContext(), si, vector(l))

    return evaluate


def numbers(stream, **ranges):
    """Parameters from ranges: name = (first number, low, high), a colour where a fourth entry says so."""
    out = {}
    for name, (j, low, high, *color) in ranges.items():
        out[name] = (mi.Color3f if color else mi.Float)(
            *[between(stream, COUNT, j + c, low, high) for c in range(3 if color else 1)])
    return out


def fresnel(out):
    c = numbers(2, c=(0, 0.02, 1), eta=(1, 1.05, 3))
    differentiated(out, "fresnel", lambda p: mi.fresnel(p["c"], p["eta"])[0], c)
    # From the denser side, before total reflection: c^2 is kept 0.02 above 1 - eta^2.
    eta = between(2, COUNT, 2, 0.4, 0.95)
    least = np.sqrt(1 - eta.astype(np.float64)**2 + 0.02)
    c = (least + (1 - least) * between(2, COUNT, 3, 0, 1)).astype(np.float32)
    differentiated(out, "fresnel_inside", lambda p: mi.fresnel(p["c"], p["eta"])[0],
                   {"c": mi.Float(c), "eta": mi.Float(eta)})
    differentiated(out, "fresnel_conductor", lambda p: mi.fresnel_conductor(p["c"], mi.Complex2f(p["eta"], p["k"])),
                   numbers(3, c=(0, 0.02, 1), eta=(1, 0.1, 4), k=(2, 0.2, 8)))


def microfacets(out):
    alpha = between(4, COUNT, 8, 0.01, 1)
    v, l = directions(4, COUNT, alpha)
    h = v.astype(np.float64) + l
    h = (h / np.sqrt(np.sum(h * h, 1))[:, None]).astype(np.float32)
    ggx = lambda p: mi.MicrofacetDistribution(mi.MicrofacetType.GGX, p["alpha"], False)
    differentiated(out, "ggx_d", lambda p: ggx(p).eval(vector(h)), {"alpha": mi.Float(alpha)})
    differentiated(out, "ggx_g1", lambda p: ggx(p).smith_g1(vector(v), vector(h)), {"alpha": mi.Float(alpha)})


def rough_conductors(out):
    def ggx(more):  # anew: load_dict takes the pictures out of the dictionary
        return mi.load_dict({"type": "roughconductor", "distribution": "ggx", "alpha": image()} | more)

    p = numbers(5, alpha=(8, 0.01, 1))
    v, l = directions(5, COUNT, p["alpha"].numpy())
    mirror = evaluated(ggx({}), v, l)  # without a material F is 1
    differentiated(out, "roughconductor_mirror", lambda given: mirror(given).x, p)

    p = numbers(6, alpha=(8, 0.01, 1), eta=(9, 0.1, 4, 3), k=(12, 0.2, 8, 3), specular_reflectance=(15, 0.05, 1, 3))
    v, l = directions(6, COUNT, p["alpha"].numpy())
    bsdf = ggx({"eta": image(3), "k": image(3), "specular_reflectance": image(3)})
    differentiated(out, "roughconductor", evaluated(bsdf, v, l), p)

    metals = []
    for i, name in enumerate(["Au", "Cu", "Al"]):
        bsdf = ggx({"material": name})
        index = mi.traverse(bsdf)
        metals.append([np.ravel(index["eta.value"]), np.ravel(index["k.value"])])
        p = numbers(7 + i, alpha=(8, 0.01, 1))
        v, l = directions(7 + i, COUNT, p["alpha"].numpy())
        y = evaluated(bsdf, v, l)(p)
        out[f"roughconductor_{name}"] = (stored(y)[:2000], 1e-4)
    out["metals"] = (np.array(metals, np.float32), 1e-6)


PRINCIPLED = dict(base_color=(8, 0.05, 0.95, 3), roughness=(11, 0.1, 1), anisotropic=(12, 0.02, 0.98),
                  metallic=(13, 0.02, 0.98), specular=(14, 0.05, 1), spec_tint=(15, 0.02, 0.98), sheen=(16, 0.02, 0.98),
                  sheen_tint=(17, 0.02, 0.98), flatness=(18, 0.02, 0.98), clearcoat=(19, 0.02, 0.98),
                  clearcoat_gloss=(20, 0.02, 0.98))


def principled(out):
    p = numbers(10, **PRINCIPLED)
    # Every second mirrored light is near enough to the mirror direction for the clear coat's lobe.
    v, l = directions(10, COUNT, np.where(np.arange(COUNT) % 4 == 3, 0.02, p["roughness"].numpy().astype(float)**2))
    in_double = {key: x.numpy().T.astype(complex) for key, x in p.items()}
    # A lobe whose parameter is not given is not compiled in.
    lobes = {key: image() for key in p} | {"base_color": image(3), "specular": 0.5}
    bsdf = mi.load_dict({"type": "principled"} | lobes)
    differentiated(out, "principled", evaluated(bsdf, v, l), p)
    # Single precision leaves few digits of the clear coat's 1 + (a^2 - 1) cos^2, and other processors leave others.
    for key, tolerance in {"value": 1e-3, "by_clearcoat": 1e-3, "by_clearcoat_gloss": 1e-2}.items():
        out[f"principled_{key}"] = (out[f"principled_{key}"][0], tolerance)

    # A third path, to decide where two renderers differ: the formulas once more in double, slopes by complex steps.
    mixture = lambda p: principled_in_double(v.astype(float), l.astype(float), p)
    out["principled_exact_value"] = (np.float32(mixture(in_double).real), 1e-6)
    for key in ("clearcoat", "clearcoat_gloss"):
        y = mixture(in_double | {key: in_double[key] + 1e-30j})
        out[f"principled_exact_by_{key}"] = (np.float32(y.imag / 1e-30), 1e-6)


def principled_in_double(v, l, p):
    """x + 2 y + 3 z of the colour, from the published formulas (Burley 2012, 2015) in Mitsuba's variants."""
    def ggx_g1(ax, ay, w):
        return 2 / (1 + np.sqrt(1 + ((ax * w[:, 0])**2 + (ay * w[:, 1])**2) / w[:, 2]**2))

    h = v + l
    h /= np.linalg.norm(h, axis=1)[:, None]
    ci, co, vh = v[:, 2], l[:, 2], np.sum(v * h, 1)
    five = lambda c: (1 - c)**5
    schlick = lambda f0: f0 + (1 - f0) * five(vh)
    mix = lambda a, b, t: a + (b - a) * t
    color, dielectric = p["base_color"].T, 1 - p["metallic"]
    tint = color / (0.212671 * color[0] + 0.715160 * color[1] + 0.072169 * color[2])

    eta = 2 / (1 - np.sqrt(0.08 * p["specular"])) - 1
    ct = np.sqrt(1 - (1 - vh * vh) / eta**2)
    f_dielectric = (((vh - eta * ct) / (vh + eta * ct))**2 + ((eta * vh - ct) / (eta * vh + ct))**2) / 2
    f = (dielectric * (1 - p["spec_tint"]) * f_dielectric + p["metallic"] * schlick(color) +
         dielectric * p["spec_tint"] * schlick(tint * ((eta - 1) / (eta + 1))**2))
    aspect = np.sqrt(1 - 0.9 * p["anisotropic"])
    ax, ay = p["roughness"]**2 / aspect, p["roughness"]**2 * aspect
    d = 1 / (np.pi * ax * ay * ((h[:, 0] / ax)**2 + (h[:, 1] / ay)**2 + h[:, 2]**2)**2)
    y = f * d * ggx_g1(ax, ay, v) * ggx_g1(ax, ay, l) / (4 * ci)

    fi, fo, rr = five(ci), five(co), 2 * p["roughness"] * vh**2
    rough = (1 - fi / 2) * (1 - fo / 2) + rr * (fo + fi + fo * fi * (rr - 1))
    flat = 1.25 * ((1 + (rr / 2 - 1) * fo) * (1 + (rr / 2 - 1) * fi) * (1 / (ci + co) - 0.5) + 0.5)
    y = y + dielectric * color * co / np.pi * mix(rough, flat, p["flatness"])
    y = y + dielectric * p["sheen"] * five(vh) * co * mix(1, tint, p["sheen_tint"])
    a2 = mix(0.1, 0.001, p["clearcoat_gloss"])**2
    gtr1 = (a2 - 1) / (np.pi * np.log(a2) * (1 + (a2 - 1) * h[:, 2]**2))
    y = y + p["clearcoat"] / 4 * schlick(0.04) * gtr1 * ggx_g1(0.25, 0.25, v) * ggx_g1(0.25, 0.25, l) * co
    return y[0] + 2 * y[1] + 3 * y[2]


def diffuse(out):
    v, l = directions(11, COUNT, 0.3)
    bsdf = mi.load_dict({"type": "diffuse", "reflectance": image(3)})
    differentiated(out, "diffuse", evaluated(bsdf, v, l), numbers(11, reflectance=(8, 0.05, 0.95, 3)))
    for key in ("diffuse_value", "diffuse_by_reflectance"):
        out[key] = (out[key][0][:1000], out[key][1])


def arrays():
    out = {"inputs": (np.stack([between(1, 250, j, -3, 0.7) for j in range(4)], 1), 0)}
    for make in (fresnel, microfacets, rough_conductors, principled, diffuse):
        before = len(out)
        make(out)
        print(f"bsdf: {make.__name__}, {len(out) - before} arrays", flush=True)
    return out
