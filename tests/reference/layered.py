# tests/reference/layered.py -- burnish's Surface under one normal as a Mitsuba BSDF
# SPDX-License-Identifier: Apache-2.0
"""Written from the comments of shade/brdf.h, coat.h, ggx.h and fresnel.h and from the papers that they name, so that
Mitsuba's integrators and its derivatives can be asked about the same reflection. Of the Surface: base_color,
specular_roughness, base_metalness, coat_weight, coat_roughness; the rest as burnish has it by default."""
import drjit as dr
import mitsuba as mi

IOR, COAT_IOR, LEAST = 1.5, 1.6, 0.02


def f0_of(ior):
    return ((ior - 1) / (ior + 1)) ** 2


def schlick(c, f0, f90):
    return f0 + (f90 - f0) * (1 - c) ** 5


def mix(a, b, t):
    return a * (1 - t) + b * t


def f90_of(f0):
    """The smoothstep of fresnel.h between 0 and 0.02: 1 for both interfaces here."""
    t = min(f0 / 0.02, 1)
    return t * t * (3 - 2 * t)


def average_fresnel(ior):
    x = ior - 1
    return x * (0.32306 + 1.11142 * x) / (1 + x * (7.18273 + 0.75438 * x))


class Layered(mi.BSDF):
    NAMES = ["base_color", "specular_roughness", "base_metalness", "coat_weight", "coat_roughness"]

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.base_color = mi.Color3f(props["base_color"])
        for name in self.NAMES[1:]:
            setattr(self, name, mi.Float(props[name]))
        self.m_flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
        self.m_components = [self.m_flags]

    def traverse(self, callback):
        for name in self.NAMES:
            callback.put(name, getattr(self, name), mi.ParamFlags.Differentiable)

    def parameters_changed(self, keys):
        pass

    def roughnesses(self):
        """Of the base as seen through the coat, and of the coat."""
        base, coat = dr.maximum(LEAST, self.specular_roughness), dr.maximum(LEAST, self.coat_roughness)
        return mix(base, dr.minimum(base**4 + 2 * coat**4, 1) ** 0.25, self.coat_weight), coat

    def reflected(self, wi, wo):
        """f_r times the cosine of wo; both above the horizon."""
        h = dr.normalize(wi + wo)
        nl, nv, vh = wo.z, wi.z, dr.dot(wi, h)
        base, coat = self.roughnesses()

        def ggx(roughness):  # D times the height-correlated visibility
            a2 = roughness**4
            d = a2 / (dr.pi * (h.z * h.z * a2 + h.x * h.x + h.y * h.y) ** 2)
            root = lambda c: dr.sqrt(a2 + (1 - a2) * c * c)
            return d * 0.5 / (nl * root(nv) + nv * root(nl))

        f0, f0c = f0_of(IOR), f0_of(COAT_IOR)
        f90, f90c = f90_of(f0), f90_of(f0c)
        inner = 1 - (1 - average_fresnel(COAT_IOR)) / COAT_IOR**2
        k = mix(f0c, inner, mix(1, self.specular_roughness, self.base_metalness))
        darkening = mix(1, (1 - k) / (1 - self.base_color * k), self.coat_weight)
        in_and_out = (1 - self.coat_weight * schlick(nl, f0c, f90c)) * (1 - self.coat_weight * schlick(nv, f0c, f90c))
        f0_base = mix(mi.Color3f(f0), self.base_color, self.base_metalness)
        fresnel = schlick(vh, f0_base, mix(f90, 1, self.base_metalness))
        diffuse = ((1 - self.base_metalness) * self.base_color / dr.pi *
                   (1 - schlick(nl, f0, f90)) * (1 - schlick(nv, f0, f90)))
        return nl * ((fresnel * ggx(base) + diffuse) * darkening * in_and_out +
                     self.coat_weight * schlick(vh, f0c, f90c) * ggx(coat))

    def eval(self, ctx, si, wo, active=True):
        active &= (si.wi.z > 0) & (wo.z > 0)
        return self.reflected(si.wi, wo) & active

    # Where to look is no function of the parameters, as in Mitsuba's own detached estimators.
    def lobes(self):
        return [mi.MicrofacetDistribution(mi.MicrofacetType.GGX, dr.detach(r) ** 2, True) for r in self.roughnesses()]

    def pdf(self, ctx, si, wo, active=True):
        h = dr.normalize(si.wi + wo)
        p = 0.4 * mi.warp.square_to_cosine_hemisphere_pdf(wo)
        for lobe in self.lobes():
            p += 0.3 * lobe.pdf(si.wi, h) / (4 * dr.dot(wo, h))
        return dr.select(active & (si.wi.z > 0) & (wo.z > 0), p, 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        bs = mi.BSDFSample3f()
        base, coat = [lobe.sample(si.wi, sample2)[0] for lobe in self.lobes()]
        bs.wo = dr.select(sample1 < 0.4, mi.warp.square_to_cosine_hemisphere(sample2),
                          mi.reflect(si.wi, dr.select(sample1 < 0.7, base, coat)))
        bs.pdf = self.pdf(ctx, si, bs.wo, active)
        bs.eta, bs.sampled_component, bs.sampled_type = 1, 0, +mi.BSDFFlags.GlossyReflection
        active &= bs.pdf > 0
        return bs, (self.eval(ctx, si, bs.wo, active) / bs.pdf) & active

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def to_string(self):
        return "Layered[]"


mi.register_bsdf("layered", Layered)
