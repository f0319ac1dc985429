"""Afterimage's rough metal as a material of Mitsuba 3, written from its description.

GGX microfacets with the height-correlated masking of Smith, reflectance after Schlick, and the
compensation of Turquin, "Practical Multiple Scattering Compensation for Microfacet Models", 2019,
for the direction of the two that loses less. Mitsuba's own `roughconductor` has none, and loses up
to half of the light. Directions are chosen by Mitsuba.
"""

import drjit as dr
import mitsuba as mi
import numpy

ENTRIES = 256
FACETS = 4096


def register():
    """Makes the plugin `metal` known, with the parameters `alpha` and `f0`."""
    mi.register_bsdf("metal", Metal)


def scattered_once(alpha):
    """Light that leaves a white surface without meeting a second microfacet, by the root of the
    cosine in even steps from 0 to 1."""
    i = numpy.arange(FACETS)
    u, v = (i + 0.5) / FACETS, (i * 0.6180339887498949 + 0.5) % 1.0
    shares = []
    for root in numpy.maximum(numpy.linspace(0.0, 1.0, ENTRIES), 0.25 / ENTRIES):
        cos = root * root
        out = numpy.array([numpy.sqrt(1.0 - cos * cos), 0.0, cos])
        # Visible normals: a cap of the sphere, as in Dupuy and Benyoub, 2023.
        stretched = out * [alpha, alpha, 1.0]
        stretched /= numpy.linalg.norm(stretched)
        z = (1.0 - u) * (1.0 + stretched[2]) - stretched[2]
        ring = numpy.sqrt(numpy.maximum(0.0, 1.0 - z * z))
        cap = numpy.stack([ring * numpy.cos(2 * numpy.pi * v), ring * numpy.sin(2 * numpy.pi * v), z])
        normal = (cap + stretched[:, None]) * numpy.array([alpha, alpha, 1.0])[:, None]
        normal /= numpy.linalg.norm(normal, axis=0)
        into_z = 2.0 * (out @ normal) * normal[2] - cos
        ratio = masking(numpy, numpy.maximum(into_z, 1e-9), cos, alpha) / masking_of_one(numpy, cos, alpha)
        shares.append(numpy.where(into_z > 0.0, ratio, 0.0).mean())
    return numpy.array(shares, numpy.float32)


def root_term(lib, cos, alpha):
    return lib.sqrt(alpha * alpha + (1.0 - alpha * alpha) * cos * cos)


def masking(lib, a, b, alpha):
    """Share of microfacets that are seen from two directions, by their cosines."""
    return 2.0 * a * b / (b * root_term(lib, a, alpha) + a * root_term(lib, b, alpha))


def masking_of_one(lib, cos, alpha):
    """Share of microfacets that are seen from one direction."""
    return 2.0 * cos / (cos + root_term(lib, cos, alpha))


class Metal(mi.BSDF):
    """The material; see the head of this file."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.alpha, self.f0 = float(props["alpha"]), [float(props[f"f0_{c}"]) for c in "rgb"]
        self.chooser = mi.load_dict(
            {"type": "roughconductor", "distribution": "ggx", "alpha": self.alpha, "material": "none"}
        )
        self.once = mi.Float(scattered_once(self.alpha))
        flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
        self.m_components, self.m_flags = [flags], flags

    def loss(self, cos):
        """What is scattered once at a cosine, between the entries of the table."""
        along = dr.sqrt(dr.clip(cos, 0.0, 1.0)) * (ENTRIES - 1)
        first = dr.minimum(mi.UInt32(along), ENTRIES - 2)
        low, high = dr.gather(mi.Float, self.once, first), dr.gather(mi.Float, self.once, first + 1)
        return dr.lerp(low, high, along - mi.Float(first))

    def value(self, wi, wo):
        """Value times the cosine of the scattered direction."""
        a, b = mi.Frame3f.cos_theta(wi), mi.Frame3f.cos_theta(wo)
        half = dr.normalize(wi + wo)
        density = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha).eval(half)
        once = density * masking(dr, a, b, self.alpha) / (4.0 * a)
        rise = dr.power(dr.clip(1.0 - dr.dot(wi, half), 0.0, 1.0), 5)
        f0 = mi.Color3f(*self.f0)
        again = 1.0 + f0 * (1.0 / dr.maximum(self.loss(a), self.loss(b)) - 1.0)
        return dr.select((a > 0.0) & (b > 0.0), once * (f0 + (1.0 - f0) * rise) * again, 0.0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        chosen, _ = self.chooser.sample(ctx, si, sample1, sample2, active)
        weight = self.value(si.wi, chosen.wo) / chosen.pdf
        return chosen, dr.select(active & (chosen.pdf > 0.0), weight, 0.0)

    def eval(self, ctx, si, wo, active=True):
        return dr.select(active, self.value(si.wi, wo), 0.0)

    def pdf(self, ctx, si, wo, active=True):
        return self.chooser.pdf(ctx, si, wo, active)

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def to_string(self):
        return f"Metal[alpha={self.alpha}]"
