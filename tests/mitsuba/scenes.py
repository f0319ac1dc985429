"""Three purely diffuse scenes and one with rough metal, each as an OBJ model with its MTL and sidecar for afterimage and as
a dictionary for Mitsuba 3.

Lengths are metres, +Y is up, colours are linear Rec. 709. Radiances have the same unit in both
programs; the irradiance of the sun is that of a surface which faces it. Lamps are parallelograms
set into an opening of a wall with nothing behind them, because afterimage's lamps emit from both
sides and Mitsuba's from one.
"""

import math
from dataclasses import dataclass, field


@dataclass
class Material:
    """A diffuse reflectance and an emitted radiance, or a metal of some roughness, whose reflectance
    at normal incidence is `albedo`."""

    albedo: tuple
    emission: tuple = (0.0, 0.0, 0.0)
    roughness: float = None

    def is_lamp(self):
        return max(self.emission) > 0.0


@dataclass
class Sky:
    """The sky of afterimage: radiances at the zenith, at the horizon and below it."""

    zenith: tuple
    horizon: tuple
    ground: tuple

    def is_constant(self):
        return self.zenith == self.horizon == self.ground

    def radiance(self, up):
        """Radiance from a direction whose sine of elevation is `up`."""
        if up >= 0.0:
            return mix(self.horizon, self.zenith, math.sqrt(up))
        return mix(self.horizon, self.ground, min(-up / 0.08, 1.0))


@dataclass
class Scene:
    """Quads by material, daylight and one camera."""

    name: str
    eye: tuple
    at: tuple
    fov_y_deg: float
    size: tuple
    materials: dict
    sky: Sky = None
    # Direction towards the sun, and its irradiance.
    sun: tuple = None
    quads: list = field(default_factory=list)

    def quad(self, material, corner, u, v):
        """Adds a parallelogram whose front is `u` x `v`."""
        self.quads.append((material, corner, u, v))

    def box(self, material, low, high, turn_deg=0.0):
        """Adds a closed box, turned about the vertical through its middle."""
        d = [h - l for l, h in zip(low, high)]
        middle = [(l + h) / 2 for l, h in zip(low, high)]
        c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))

        def vector(x, y, z):
            return (c * x + s * z, y, c * z - s * x)

        def corner(p):
            x, y, z = vector(*(a - m for a, m in zip(p, middle)))
            return (x + middle[0], y + middle[1], z + middle[2])

        x, y, z = vector(d[0], 0, 0), vector(0, d[1], 0), vector(0, 0, d[2])
        for at, u, v in [(low, y, x), (low, z, y), (low, x, z)]:
            self.quad(material, corner(at), u, v)
        for u, v in [(x, y), (y, z), (z, x)]:
            self.quad(material, corner(high), minus(u), minus(v))

    def frame(self, material, low, u, v, hole):
        """Adds a parallelogram with a hole, whose edges are shares of `u` and of `v`."""
        (u0, u1), (v0, v1) = hole
        for (a, b), (c, d) in [((0, 1), (0, v0)), ((0, 1), (v1, 1)), ((0, u0), (v0, v1)), ((u1, 1), (v0, v1))]:
            self.quad(material, along(low, u, v, a, c), times(u, b - a), times(v, d - c))


def mix(a, b, share):
    return tuple(x + (y - x) * share for x, y in zip(a, b))


def minus(a):
    return tuple(-x for x in a)


def times(a, factor):
    return tuple(x * factor for x in a)


def along(corner, u, v, a, b):
    """The point at shares `a` and `b` of the edges of a parallelogram."""
    return tuple(p + x * a + y * b for p, x, y in zip(corner, u, v))


def cornell():
    """The Cornell box: a lamp in the ceiling, two blocks, coloured walls; one side is open."""
    white, lamp = (0.73, 0.71, 0.68), (18.4, 15.6, 8.0)
    s = Scene("cornell", (2.78, 2.73, -8.0), (2.78, 2.73, 0.0), 39.3, (160, 160), {
        "white": Material(white), "red": Material((0.57, 0.04, 0.04)),
        "green": Material((0.12, 0.42, 0.1)), "lamp": Material((0.0, 0.0, 0.0), lamp),
    })
    w = 5.56
    s.quad("white", (0, 0, 0), (0, 0, w), (w, 0, 0))
    hole = ((0.383, 0.617), (0.406, 0.594))
    s.frame("white", (0, w, 0), (w, 0, 0), (0, 0, w), hole)
    (u0, u1), (v0, v1) = hole
    s.quad("lamp", (w * u0, w, w * v0), (w * (u1 - u0), 0, 0), (0, 0, w * (v1 - v0)))
    s.quad("white", (0, 0, w), (0, w, 0), (w, 0, 0))
    s.quad("green", (0, 0, 0), (0, w, 0), (0, 0, w))
    s.quad("red", (w, 0, 0), (0, 0, w), (0, w, 0))
    s.box("white", (1.05, 0, 0.87), (2.70, 1.65, 2.52), -17)
    s.box("white", (2.85, 0, 2.70), (4.50, 3.30, 4.35), 17)
    return s


def window():
    """A furnished room with one window, under a constant sky and a sharp sun."""
    grey = (1.0, 1.0, 1.0)
    s = Scene("window", (3.5, 1.6, 4.6), (1.2, 1.0, 0.6), 65.0, (160, 96), {
        "wall": Material((0.8, 0.78, 0.74)), "floor": Material((0.45, 0.3, 0.2)),
        "blue": Material((0.15, 0.25, 0.5)), "wood": Material((0.5, 0.35, 0.2)),
    }, Sky(grey, grey, grey), ((-0.55, 0.62, -0.42), (9.0, 8.5, 7.5)))
    x, y, z = 4.0, 2.8, 5.0
    s.quad("floor", (0, 0, 0), (0, 0, z), (x, 0, 0))
    s.quad("wall", (0, y, 0), (x, 0, 0), (0, 0, z))
    s.frame("wall", (0, 0, 0), (0, 0, z), (0, y, 0), ((0.25, 0.6), (0.35, 0.8)))
    s.quad("wall", (x, 0, 0), (0, y, 0), (0, 0, z))
    s.quad("wall", (0, 0, 0), (x, 0, 0), (0, y, 0))
    s.quad("wall", (0, 0, z), (0, y, 0), (x, 0, 0))
    # A table on legs, two seats, a cupboard and a picture.
    s.box("wood", (1.6, 0.72, 1.6), (3.0, 0.76, 2.5))
    for leg_x in (1.65, 2.89):
        for leg_z in (1.65, 2.39):
            s.box("wood", (leg_x, 0, leg_z), (leg_x + 0.06, 0.72, leg_z + 0.06))
    s.box("blue", (1.9, 0, 0.9), (2.4, 0.45, 1.35), 12)
    s.box("blue", (3.2, 0, 1.7), (3.65, 0.45, 2.2), -8)
    s.box("wood", (3.4, 0, 0.05), (3.95, 1.9, 1.0))
    s.box("blue", (1.0, 1.2, 0.01), (1.8, 1.9, 0.04))
    return s


def atrium():
    """An open court with columns around it, under a sky that is brighter at the horizon."""
    s = Scene("atrium", (0.9, 1.7, 9.4), (7.5, 2.2, 3.4), 65.0, (160, 96), {
        "stone": Material((0.65, 0.6, 0.5)), "floor": Material((0.4, 0.38, 0.35)),
        "brick": Material((0.55, 0.25, 0.18)),
    }, Sky((0.6, 0.8, 1.2), (1.6, 1.5, 1.4), (0.3, 0.28, 0.25)))
    w, h, roof, inner = 12.0, 6.0, 3.4, 2.5
    s.quad("floor", (0, 0, 0), (0, 0, w), (w, 0, 0))
    for corner, u in [((0, 0, 0), (w, 0, 0)), ((w, 0, 0), (0, 0, w)), ((w, 0, w), (-w, 0, 0)), ((0, 0, w), (0, 0, -w))]:
        s.quad("brick", corner, u, (0, h, 0))
    hole = ((inner / w, 1 - inner / w),) * 2
    s.frame("stone", (0, roof, 0), (w, 0, 0), (0, 0, w), hole)
    s.frame("stone", (0, roof + 0.3, 0), (0, 0, w), (w, 0, 0), hole)
    far = w - inner
    for corner, u in [((inner, 0, inner), (inner - far, 0, 0)), ((far, 0, inner), (0, 0, inner - far))]:
        for at, edge in [(corner, minus(u)), ((w - corner[0], 0, w - corner[2]), u)]:
            s.quad("stone", (at[0], roof, at[2]), edge, (0, 0.3, 0))
    for i in range(5):
        at = inner + 0.15 + i * (far - inner - 0.3) / 4
        places = [(at, inner + 0.15), (at, far - 0.15)]
        places += [(inner + 0.15, at), (far - 0.15, at)] if 0 < i < 4 else []
        for place in places:
            column(s, place, 0.2, roof)
    s.box("stone", (5.0, 0, 5.0), (7.0, 0.5, 7.0), 20)
    return s


def metals():
    """Plates of metal of six roughnesses on a wall, opposite a lamp and a coloured room."""
    gold = (0.9, 0.75, 0.4)
    s = Scene("metals", (0.0, 1.5, 3.4), (0.0, 1.35, 0.0), 52.0, (192, 128), {
        "wall": Material((0.7, 0.68, 0.64)), "floor": Material((0.45, 0.3, 0.2)),
        "red": Material((0.6, 0.12, 0.1)), "lamp": Material((0.0, 0.0, 0.0), (9.0, 8.5, 7.5)),
    })
    w, h, d = 2.5, 2.8, 5.0
    s.quad("floor", (-w, 0, 0), (0, 0, d), (2 * w, 0, 0))
    hole = ((0.3, 0.7), (0.4, 0.6))
    s.frame("wall", (-w, h, 0), (2 * w, 0, 0), (0, 0, d), hole)
    (u0, u1), (v0, v1) = hole
    s.quad("lamp", (2 * w * u0 - w, h, d * v0), (2 * w * (u1 - u0), 0, 0), (0, 0, d * (v1 - v0)))
    s.quad("red", (-w, 0, 0), (0, h, 0), (0, 0, d))
    s.quad("wall", (w, 0, 0), (0, 0, d), (0, h, 0))
    s.quad("wall", (-w, 0, 0), (2 * w, 0, 0), (0, h, 0))
    s.quad("wall", (-w, 0, d), (0, h, 0), (2 * w, 0, 0))
    for i, roughness in enumerate((0.1, 0.2, 0.35, 0.5, 0.7, 0.9)):
        name, x, y = f"metal{i}", -2.1 + 1.45 * (i % 3), 1.45 - 1.25 * (i // 3)
        s.materials[name] = Material(gold, roughness=roughness)
        # Plates lean back, each by another angle.
        lean = 0.1 * (i + 1)
        s.quad(name, (x, y, 0.7), (1.3, 0, 0), (0, 1.1 * math.cos(lean), -1.1 * math.sin(lean)))
    return s


def column(s, place, radius, height, sides=10):
    """Adds a prism that stands at x and z."""
    def point(i):
        angle = 2 * math.pi * i / sides
        return (place[0] + radius * math.cos(angle), 0.0, place[1] + radius * math.sin(angle))

    for i in range(sides):
        a, b = point(i), point(i + 1)
        s.quad("stone", a, (0, height, 0), tuple(q - p for p, q in zip(a, b)))


ALL = {make.__name__: make for make in (cornell, window, atrium, metals)}


def corners(quad):
    _, corner, u, v = quad
    return [along(corner, u, v, a, b) for a, b in [(0, 0), (1, 0), (1, 1), (0, 1)]]


def obj(scene, names, library):
    """The text of an OBJ file with the quads of some materials."""
    lines, count = ([f"mtllib {library}"] if library else []) + ["s off"], 0
    for name in names:
        lines.append(f"usemtl {name}")
        for quad in (q for q in scene.quads if q[0] == name):
            lines += ["v " + " ".join(f"{x:.9g}" for x in p) for p in corners(quad)]
            lines.append("f " + " ".join(str(count + i) for i in (1, 2, 3, 4)))
            count += 4
    return "\n".join(lines) + "\n"


def vector(v):
    return "[" + ", ".join(f"{float(x):.9g}" for x in v) + "]"


def write_afterimage(scene, folder):
    """Writes model, library and sidecar; returns the path of the model."""
    path = folder / f"{scene.name}.obj"
    path.write_text(obj(scene, scene.materials, f"{scene.name}.mtl"))
    mtl = ""
    for name, m in scene.materials.items():
        kd, ke = (" ".join(map(str, c)) for c in (m.albedo, m.emission))
        mtl += f"newmtl {name}\nKd {kd}\nKe {ke}\n"
        rough = m.roughness is not None
        mtl += f"Pm 1\nPr {m.roughness}\n" if rough else "Ks 0 0 0\nillum 1\n"
    path.with_suffix(".mtl").write_text(mtl)
    toml = 'unit = "m"\nup = "+Y"\n'
    if scene.sun:
        direction, irradiance = scene.sun
        toml += f"[sun]\ndirection = {vector(direction)}\nirradiance = {vector(irradiance)}\n"
        toml += "angular_radius_deg = 0.0\n"
    if scene.sky:
        parts = {"zenith": scene.sky.zenith, "horizon": scene.sky.horizon, "ground": scene.sky.ground}
        toml += "[sky]\n" + "".join(f"{key} = {vector(value)}\n" for key, value in parts.items())
    path.with_suffix(".afterimage.toml").write_text(toml)
    return path


def sky_picture(sky, width=64, height=1024):
    """The sky as an equirectangular picture, its first row at the zenith."""
    import numpy

    rows = [sky.radiance(math.cos(math.pi * (i + 0.5) / height)) for i in range(height)]
    return numpy.repeat(numpy.array(rows, numpy.float32)[:, None, :], width, axis=1)


def mitsuba_dict(mi, scene, folder, max_depth):
    """The scene as Mitsuba's dictionary; meshes are written to `folder`."""
    def rgb(value):
        return {"type": "rgb", "value": list(map(float, value))}

    camera = mi.ScalarTransform4f().look_at(origin=scene.eye, target=scene.at, up=(0, 1, 0))
    made = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": max_depth, "rr_depth": 5},
        "sensor": {
            "type": "perspective", "fov": scene.fov_y_deg, "fov_axis": "y", "to_world": camera,
            "near_clip": 1e-3, "far_clip": 1e4, "sampler": {"type": "independent"},
            "film": {"type": "hdrfilm", "width": scene.size[0], "height": scene.size[1],
                     "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"},
        },
    }
    for name, material in scene.materials.items():
        bsdf = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(material.albedo)}}
        if material.roughness is not None:
            f0 = {f"f0_{c}": x for c, x in zip("rgb", material.albedo)}
            bsdf["bsdf"] = {"type": "metal", "alpha": material.roughness**2, **f0}
        if material.is_lamp():
            for i, quad in enumerate(q for q in scene.quads if q[0] == name):
                lamp = {"type": "area", "radiance": rgb(material.emission)}
                made[f"{name}{i}"] = {**rectangle(mi, quad), "bsdf": bsdf, "emitter": lamp}
        else:
            path = folder / f"{scene.name}-{name}.obj"
            path.write_text(obj(scene, [name], None))
            made[name] = {"type": "obj", "filename": str(path), "face_normals": True, "bsdf": bsdf}
    if scene.sky and scene.sky.is_constant():
        made["sky"] = {"type": "constant", "radiance": rgb(scene.sky.zenith)}
    elif scene.sky:
        made["sky"] = {"type": "envmap", "bitmap": mi.Bitmap(sky_picture(scene.sky))}
    if scene.sun:
        direction, irradiance = scene.sun
        made["sun"] = {"type": "directional", "direction": list(minus(direction)), "irradiance": rgb(irradiance)}
    return made


def rectangle(mi, quad):
    """Mitsuba's rectangle, from -1 to 1 in its own x and y, in the place of a quad."""
    _, corner, u, v = quad
    normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = math.sqrt(sum(n * n for n in normal))
    middle = along(corner, u, v, 0.5, 0.5)
    rows = [[u[i] / 2, v[i] / 2, normal[i] / length, middle[i]] for i in range(3)] + [[0, 0, 0, 1]]
    return {"type": "rectangle", "to_world": mi.ScalarTransform4f(rows)}
