"""Irradiance at world points of a scene by an independent renderer (Mitsuba 3), as CSV with standard errors.

    python scenes/truth/irradiance.py cornell > tests/data/truth_cornell.csv

Needs `pip install mitsuba` and an LLVM library of version 16 or newer (DRJIT_LIBLLVM_PATH names it). Reads
scenes/NAME.glb and NAME.bake.ron with its own few lines of code, so that nothing is shared with the baker.

scenes/tests/data/mitsuba_*.csv, against which the closed forms are tested, were made with
--plain 40 --hard 0 --clearance 0.02 --batches 32.

Light that arrives after reflections comes from Mitsuba's `path` integrator without a limit of length (Russian roulette
from depth 5) along cosine-distributed rays; light straight from emitters from the same rays and from sampled emitters,
weighted by the balance heuristic. Surfaces are Lambertian; the back of a single-sided face blocks and reflects nothing.
"""

import argparse
import json
import pathlib
import re
import struct
import sys

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
FOLDER = pathlib.Path(__file__).resolve().parent.parent


# ---- the scene file -------------------------------------------------------------------------------------------------


class Glb:
    """World-space triangles by material, and lights."""

    COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
    TYPES = {5123: np.uint16, 5125: np.uint32, 5126: np.float32}

    def __init__(self, path):
        data = path.read_bytes()
        json_length = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20 : 20 + json_length])
        self.binary = data[28 + json_length :]
        self.parts = {}  # (material, colour) -> list of positions, each (triangles, 3 corners, 3)
        self.lights = []  # (light, world matrix)
        for root in self.json["scenes"][0]["nodes"]:
            self.visit(root, np.eye(4))

    def accessor(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width = self.COMPONENTS[accessor["type"]]
        flat = np.frombuffer(
            self.binary, self.TYPES[accessor["componentType"]], accessor["count"] * width, view["byteOffset"]
        )
        return flat.reshape(-1, width)

    def visit(self, index, parent):
        node = self.json["nodes"][index]
        matrix = parent @ local_matrix(node)
        light = node.get("extensions", {}).get("KHR_lights_punctual")
        if light:
            self.lights.append((self.json["extensions"]["KHR_lights_punctual"]["lights"][light["light"]], matrix))
        if "mesh" in node:
            for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                self.add(primitive, matrix)
        for child in node.get("children", []):
            self.visit(child, matrix)

    def add(self, primitive, matrix):
        attributes = primitive["attributes"]
        indices = self.accessor(primitive["indices"]).reshape(-1, 3)
        if np.linalg.det(matrix[:3, :3]) < 0:
            indices = indices[:, ::-1]
        positions = self.accessor(attributes["POSITION"]) @ matrix[:3, :3].T + matrix[:3, 3]
        colours = np.ones((len(positions), 3))
        if "COLOR_0" in attributes:
            colours = self.accessor(attributes["COLOR_0"])[:, :3].astype(float)
        by_colour = {}
        for triangle in indices:
            by_colour.setdefault(tuple(colours[triangle[0]]), []).append(triangle)
        for colour, triangles in by_colour.items():
            part = self.parts.setdefault((primitive["material"], colour), [])
            part.append(positions[np.array(triangles)])

    def triangles(self):
        """Corners of all triangles, (n, 3, 3), and whether irradiance is asked for there: not on sheets and lamps."""
        corners, asked = [], []
        for (material, _), pieces in self.parts.items():
            material = self.json["materials"][material]
            albedo = material["pbrMetallicRoughness"]["baseColorFactor"]
            for piece in pieces:
                corners.append(piece)
                asked.append(np.full(len(piece), max(albedo[:3]) > 0 and not material.get("doubleSided")))
        return np.concatenate(corners), np.concatenate(asked)


def local_matrix(node):
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = rotation @ np.diag(node.get("scale", [1, 1, 1]))
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix


def settings(name):
    """Sky radiance (or None) and the sun's direction of travel, lux by channel, angular radius (or None)."""
    path = FOLDER / f"{name}.bake.ron"
    text = re.sub(r"//.*", "", path.read_text()) if path.exists() else ""
    triple = r"\(\s*([-\d.e]+)\s*,\s*([-\d.e]+)\s*,\s*([-\d.e]+)\s*\)"
    sky = re.search(r"sky:\s*(?:Some\()?" + triple, text)
    sun = re.search(r"sun:\s*(?:Some\()?Sun\((.*?angular_diameter_deg.*?)\)", text, re.S)
    if sun:
        fields = {key: float(value) for key, value in re.findall(r"(\w+):\s*([-\d.e]+)", sun[1])}
        colour = np.array([float(c) for c in re.search(r"colour:\s*" + triple, sun[1]).groups()])
        azimuth, elevation = np.radians(fields["azimuth_deg"]), np.radians(fields["elevation_deg"])
        # Azimuth 0 is -Z, turning towards +X.
        to_sun = [np.cos(elevation) * np.sin(azimuth), np.sin(elevation), -np.cos(elevation) * np.cos(azimuth)]
        radius = np.radians(fields["angular_diameter_deg"]) / 2
        sun = (-np.array(to_sun), fields["lux"] * colour, radius)
    return [float(s) for s in sky.groups()] if sky else None, sun


# ---- the same scene in Mitsuba --------------------------------------------------------------------------------------


class Punctual(mi.Emitter):
    """A glTF point or spot light (cone of KHR_lights_punctual), or a sun: a uniform disk in the sky."""

    def __init__(self, props):
        super().__init__(props)
        self.kind = props["kind"]
        self.colour = mi.Color3f(props["colour"])
        self.position = mi.Point3f(props["position"])
        self.axis = mi.Vector3f(props["axis"])
        self.cos = (props["cos_inner"], props["cos_outer"])
        directional = self.kind == "sun"
        self.m_flags = mi.EmitterFlags.DeltaDirection if directional else mi.EmitterFlags.DeltaPosition

    def sample_direction(self, it, sample, active=True):
        ds = dr.zeros(mi.DirectionSample3f)
        if self.kind == "sun":
            local = mi.warp.square_to_uniform_cone(sample, self.cos[1])
            ds.d = mi.Frame3f(-self.axis).to_world(local)
            ds.dist = mi.Float(1e4)
            ds.p = it.p + ds.d * ds.dist
            # Lux across the beam is L pi sin^2; L times the cone's solid angle is this.
            weight = self.colour * (2 / (1 + self.cos[1]))
        else:
            ds.p = self.position
            offset = self.position - it.p
            ds.dist = dr.norm(offset)
            ds.d = offset / ds.dist
            weight = self.colour / dr.square(ds.dist)
            if self.kind == "spot":
                inner, outer = self.cos
                fade = dr.clip((dr.dot(-ds.d, self.axis) - outer) / max(inner - outer, 1e-6), 0, 1)
                weight *= dr.square(fade)
        ds.pdf = mi.Float(1)
        ds.delta = mi.Bool(True)
        ds.emitter = mi.EmitterPtr(self)
        return ds, weight & active

    def pdf_direction(self, it, ds, active=True):
        return mi.Float(0)

    def eval(self, si, active=True):
        return mi.Color3f(0)

    def bbox(self):
        return mi.ScalarBoundingBox3f()


mi.register_emitter("punctual", Punctual)


def punctual(kind, colour, position=(0, 0, 0), axis=(0, -1, 0), cos=(0.0, 0.0)):
    props = {"type": "punctual", "kind": kind, "cos_inner": float(cos[0]), "cos_outer": float(cos[1])}
    vectors = {"colour": colour, "position": position, "axis": axis}
    return props | {key: mi.ScalarPoint3f(*map(float, value)) for key, value in vectors.items()}


def mitsuba_scene(glb, sky, sun):
    content = {"type": "scene"}
    if sky:
        content["sky"] = {"type": "constant", "sampling_weight": 3.0, "radiance": {"type": "rgb", "value": sky}}
    if sun:
        direction, lux, radius = sun
        content["sun"] = punctual("sun", lux, axis=direction, cos=(1.0, np.cos(radius))) | {"sampling_weight": 8.0}
    for index, (light, matrix) in enumerate(glb.lights):
        colour = np.array(light.get("color", [1, 1, 1])) * light["intensity"]
        axis, position = -matrix[:3, 2] / np.linalg.norm(matrix[:3, 2]), matrix[:3, 3]
        spot = light.get("spot", {})
        cos = (np.cos(spot.get("innerConeAngle", 0)), np.cos(spot.get("outerConeAngle", np.pi / 4)))
        if light["type"] == "directional":
            content[f"light{index}"] = {
                "type": "directional",
                "direction": axis.tolist(),
                "irradiance": {"type": "rgb", "value": colour.tolist()},
            }
        else:
            content[f"light{index}"] = punctual(light["type"], colour, position, axis, cos)
    for index, ((material, colour), pieces) in enumerate(glb.parts.items()):
        corners = np.concatenate(pieces)
        content[f"part{index}"] = mitsuba_mesh(f"part{index}", corners, glb.json["materials"][material], colour)
    return mi.load_dict(content)


def mitsuba_mesh(name, corners, material, colour):
    albedo = np.array(material["pbrMetallicRoughness"]["baseColorFactor"][:3]) * colour
    bsdf = {"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo.tolist()}}
    if material.get("doubleSided"):
        bsdf = {"type": "twosided", "bsdf": bsdf}
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(bsdf)
    emission = np.array(material.get("emissiveFactor", [0, 0, 0]), float)
    if emission.any():
        assert not material.get("doubleSided"), "two-sided emitters are not handled"
        extension = material.get("extensions", {}).get("KHR_materials_emissive_strength", {})
        emission = emission * extension.get("emissiveStrength", 1.0)
        props["emitter"] = mi.load_dict({"type": "area", "radiance": {"type": "rgb", "value": emission.tolist()}})
    mesh = mi.Mesh(name, 3 * len(corners), len(corners), props=props)
    params = mi.traverse(mesh)
    params["vertex_positions"] = mi.Float(corners.reshape(-1).astype(np.float32))
    params["faces"] = mi.UInt32(np.arange(3 * len(corners), dtype=np.uint32))
    params.update()
    return mesh


# ---- irradiance -----------------------------------------------------------------------------------------------------


def irradiance(scene, points, normals, samples, seed):
    """One independent estimate of irradiance per point, (n, 3)."""
    integrator = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 5})
    sampler = mi.load_dict({"type": "independent"})
    n = len(points)
    # Opaque, so that all batches share one compiled kernel.
    sampler.seed(dr.opaque(mi.UInt32, seed), n * samples)
    lane = dr.arange(mi.UInt32, n * samples) // samples
    cell = dr.arange(mi.UInt32, n * samples) % samples
    strata = int(np.sqrt(samples))
    assert strata * strata == samples, "samples must be a square number"

    def stratified():
        return (mi.Point2f(cell % strata, cell // strata) + sampler.next_2d()) / strata

    gather = lambda values: dr.gather(mi.Point3f, mi.Point3f(values.T.astype(np.float32)), lane)

    si = dr.zeros(mi.SurfaceInteraction3f, n * samples)
    si.p, si.n = gather(points), mi.Normal3f(gather(normals))
    si.sh_frame = mi.Frame3f(si.n)

    # Along a cosine-distributed ray: everything, with straight emission weighted against the emitter samples below.
    ray = si.spawn_ray(si.sh_frame.to_world(mi.warp.square_to_cosine_hemisphere(stratified())))
    cosine_pdf = dr.dot(ray.d, si.n) / dr.pi
    hit = scene.ray_intersect(ray)
    emitter = hit.emitter(scene)
    straight = emitter.eval(hit)
    all_light, _, _ = integrator.sample(scene, sampler, mi.RayDifferential3f(ray))
    ds = mi.DirectionSample3f(scene, hit, si)
    emitter_pdf = scene.pdf_emitter_direction(si, ds, emitter != None)  # noqa: E711 (a drjit pointer)
    value = dr.pi * (all_light - straight + straight * dr.select(cosine_pdf > 0, cosine_pdf / (cosine_pdf + emitter_pdf), 0))

    # Towards a sampled emitter.
    ds, weight = scene.sample_emitter_direction(si, stratified(), True)
    cosine = dr.maximum(dr.dot(ds.d, si.n), 0)
    balance = dr.select(ds.delta, 1, ds.pdf / (ds.pdf + cosine / dr.pi))
    value += dr.select(ds.pdf > 0, weight * cosine * balance, 0)

    return np.stack([np.array(dr.block_sum(channel, samples), dtype=float) for channel in value], 1) / samples


def distance_to_other_surfaces(point, normal, corners, face_normals):
    """Least distance to a triangle that does not continue the point's own surface."""
    other = corners[face_normals @ normal < 0.9]
    a, b, c = other[:, 0], other[:, 1], other[:, 2]
    best = np.inf
    for s, e in ((a, b), (b, c), (c, a)):
        t = np.clip(np.einsum("ij,ij->i", point - s, e - s) / np.einsum("ij,ij->i", e - s, e - s), 0, 1)
        best = min(best, np.linalg.norm(s + t[:, None] * (e - s) - point, axis=1).min(initial=np.inf))
    n = np.cross(b - a, c - a)
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    height = np.einsum("ij,ij->i", point - a, n)
    foot = point - height[:, None] * n
    inside = np.ones(len(other), bool)
    for s, e in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(e - s, foot - s), n) >= 0
    return min(best, np.abs(height[inside]).min(initial=np.inf))


def choose_points(glb, scene, sun, plain, hard, clearance, rng):
    """Points spread by area over reflecting faces; hard ones lie near edges and contacts. Buried ones are left out."""
    corners, asked = glb.triangles()
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    face_normals = cross / (2 * area[:, None])
    probability = area * asked / (area * asked).sum()
    points, normals, cases = [], [], []
    wanted = {"plain": plain, "hard": hard}
    for _ in range(200 * (plain + hard)):
        if not any(wanted.values()):
            break
        index = rng.choice(len(area), p=probability)
        s, t = np.sqrt(rng.random()), rng.random()
        point = corners[index].T @ np.array([1 - s, s * (1 - t), s * t])
        normal = face_normals[index]
        near = distance_to_other_surfaces(point, normal, corners, face_normals)
        edge = sun and near_sun_edge(scene, sun, point, normal, clearance, rng)
        case = "hard" if near < clearance or edge else "plain"
        if near < 0.01 or wanted[case] == 0 or buried(scene, point, normal, rng):
            continue
        wanted[case] -= 1
        points.append(point), normals.append(normal), cases.append(case)
    order = sorted(range(len(points)), key=lambda i: (cases[i] != "plain", i))
    return np.array(points)[order], np.array(normals)[order], [cases[i] for i in order]


def near_sun_edge(scene, sun, point, normal, clearance, rng, rays=64):
    """Whether only a part of the points within the clearance sees the sun."""
    frame = mi.Frame3f(mi.Normal3f(*map(float, normal)))
    disk = mi.warp.square_to_uniform_disk(mi.Point2f(rng.random((2, rays)).astype(np.float32))) * clearance
    origin = mi.Point3f(*map(float, point)) + frame.to_world(mi.Vector3f(disk.x, disk.y, 1e-4))
    lit = ~np.array(scene.ray_test(mi.Ray3f(origin, mi.Vector3f(*map(float, -sun[0])))))
    return sun[0] @ normal < 0 and lit.any() and not lit.all()


def buried(scene, point, normal, rng, rays=256):
    """Whether more than a hundredth of the rays from a point hit the back of a face."""
    p, n = mi.Point3f(*map(float, point)), mi.Normal3f(*map(float, normal))
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(rng.random((2, rays)).astype(np.float32)))
    hit = scene.ray_intersect(mi.Ray3f(mi.Point3f(p + 1e-4 * n), mi.Frame3f(n).to_world(local)))
    return np.mean(np.array(hit.is_valid() & (hit.wi.z < 0))) > 0.01


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--plain", type=int, default=160, help="points at least --clearance from other surfaces")
    parser.add_argument("--hard", type=int, default=40, help="points nearer than that")
    parser.add_argument("--clearance", type=float, default=0.1, help="metres")
    parser.add_argument("--samples", type=int, default=1024, help="paths per point and batch, a square number")
    parser.add_argument("--batches", type=int, default=128)
    parser.add_argument("--threads", type=int, default=1)
    args = parser.parse_args()
    dr.set_thread_count(args.threads)

    glb = Glb(FOLDER / f"{args.scene}.glb")
    sky, sun = settings(args.scene)
    scene = mitsuba_scene(glb, sky, sun)
    points, normals, cases = choose_points(glb, scene, sun, args.plain, args.hard, args.clearance, np.random.default_rng(1))
    batches = []
    try:
        for batch in range(args.batches):
            batches.append(irradiance(scene, points, normals, args.samples, seed=1000 + batch))
            print(f"\rbatch {batch + 1} of {args.batches}", end="", file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        pass  # what is done counts
    batches = np.array(batches)
    mean = batches.mean(0)
    error = batches.std(0, ddof=1) / np.sqrt(len(batches))
    share = error.sum(1) / np.maximum(mean.sum(1), 1e-30)

    print(f"# irradiance (lux, linear Rec.709) at world points of scenes/{args.scene}.glb, all orders of reflection")
    print(f"# made by scenes/truth/irradiance.py: Mitsuba {mi.__version__} path integrator, {len(batches)} batches of")
    print(f"# {args.samples} paths a point; se = one standard error of the mean from the batches")
    print(f"# relative se: median {np.median(share):.5f}, max {share.max():.5f}")
    print(f"# case: hard = less than {args.clearance} m from the sun's shadow edge or a surface that does not continue the point's")
    print("px,py,pz,nx,ny,nz,E_r,E_g,E_b,se_r,se_g,se_b,case")
    for point, normal, e, se, case in zip(points, normals, mean, error, cases):
        place = [f"{x + 0.0:.6f}" for x in point.round(6)] + [f"{x + 0.0:.7f}" for x in normal.round(7)]
        print(",".join(place + [f"{x:.6g}" for x in e] + [f"{x:.3g}" for x in se] + [case]))


if __name__ == "__main__":
    main()
