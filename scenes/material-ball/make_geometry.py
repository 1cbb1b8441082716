#!/usr/bin/env python3
"""Writes the geometry and the textures of the material-ball scene. Standard library only, deterministic.

    python3 make_geometry.py            # writes orb.ply, foot.ply, stage.ply, floor.png, softbox.hdr, room.hdr here

The orb is a thick, hollow shell with an opening, turned around the z axis. From the outside in, it shows curvature at
several scales: the sphere itself, a belt of flat facets in a groove, a fine turned groove, a thin raised lip, a
concave funnel and an inner cavity. Its surface is closed and its normals leave the solid, so that it can be made of
glass. Texture coordinates run around the axis (u) and along the profile (v): an anisotropic material looks spun.
"""
import math
import os
import struct
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))

# ------------------------------------------------------------------------------------------------ the orb's numbers
AZIMUTH = 168          # divisions around the axis
FACETS = 24            # facets around the belt; AZIMUTH is a multiple of it
CAVITY = 0.66          # radius of the cavity (outer radius: 1)
BELT = (42.5, 57.0)    # polar angles of the belt's edges, degrees from the axis
BELT_FLOOR = 0.930     # distance of the belt's edges from the centre
BELT_RIDGE = 1.002     # distance of the belt's middle ring of corners from the centre
OPENING = 33.0         # polar angle of the lip
ROUNDING = 0.0085      # standard deviation of the Gaussian that rounds the profile's corners
TURN = 12.0            # largest turn of the profile between two rings, degrees
STEP = 0.09            # largest distance between two rings


def polar(radius, degrees):
    """Point (r, z) of the profile plane at a distance from the centre and an angle from the axis."""
    a = math.radians(degrees)
    return (radius * math.sin(a), radius * math.cos(a))


def arc(radius, first, last, n=400):
    """Points of a circle around the centre between two polar angles."""
    return [polar(radius, first + (last - first) * i / n) for i in range(n + 1)]


def bump(centre_degrees, half_width, height, n=40):
    """A half-round ring (height > 0) or groove (height < 0) in the unit circle, walked towards the axis."""
    out = []
    for i in range(n + 1):
        t = -1 + 2 * i / n
        out.append(polar(1 + height * math.sqrt(max(0.0, 1 - t * t)), centre_degrees - t * half_width))
    return out


# --------------------------------------------------------------------------------------------------- profile curves
def resample(points, spacing):
    """The same polyline with equal steps; both ends kept."""
    lengths = [0.0]
    for a, b in zip(points, points[1:]):
        lengths.append(lengths[-1] + math.dist(a, b))
    n = max(2, round(lengths[-1] / spacing))
    out, j = [], 0
    for i in range(n + 1):
        s = lengths[-1] * i / n
        while j < len(points) - 2 and lengths[j + 1] < s:
            j += 1
        span = lengths[j + 1] - lengths[j]
        t = (s - lengths[j]) / span if span > 0 else 0.0
        out.append(tuple(p + (q - p) * t for p, q in zip(points[j], points[j + 1])))
    return out, lengths[-1] / n


def rounded(points, sigma):
    """The polyline with its corners rounded by a Gaussian along its length. Beyond its ends it is continued by point
    reflection, so that the ends stay where they are and keep their tangent."""
    fine, h = resample(points, sigma / 12)
    reach = min(int(4 * sigma / h), len(fine) - 1)
    weights = [math.exp(-0.5 * (k * h / sigma) ** 2) for k in range(-reach, reach + 1)]
    total = sum(weights)

    def at(i):
        if i < 0:
            return tuple(2 * e - p for e, p in zip(fine[0], fine[-i]))
        if i >= len(fine):
            return tuple(2 * e - p for e, p in zip(fine[-1], fine[2 * (len(fine) - 1) - i]))
        return fine[i]

    padded = [at(i) for i in range(-reach, len(fine) + reach)]
    return [tuple(sum(w * padded[i + k][c] for k, w in enumerate(weights)) / total for c in (0, 1))
            for i in range(len(fine))]


def rings(points, turn=TURN, step=STEP):
    """Chooses rings (r, z, nr, nz, v) of a smooth profile: a new one after each `turn` degrees or `step` of length.
    The normal is to the right of the direction of travel."""
    tangents = []
    for i in range(len(points)):
        a, b = points[max(i - 1, 0)], points[min(i + 1, len(points) - 1)]
        d = math.dist(a, b)
        tangents.append(((b[0] - a[0]) / d, (b[1] - a[1]) / d))
    chosen, turned, walked, v = [0], 0.0, 0.0, [0.0]
    for i in range(1, len(points)):
        ds = math.dist(points[i - 1], points[i])
        v.append(v[-1] + ds)
        c = tangents[i - 1][0] * tangents[i][1] - tangents[i - 1][1] * tangents[i][0]
        turned += math.degrees(abs(math.asin(max(-1.0, min(1.0, c)))))
        walked += ds
        if turned >= turn or walked >= step:
            chosen.append(i)
            turned = walked = 0.0
    if chosen[-1] != len(points) - 1:
        chosen.append(len(points) - 1)
    return [(*points[i], tangents[i][1], -tangents[i][0], v[i]) for i in chosen]


# ------------------------------------------------------------------------------------------------------------ meshes
class Mesh:
    """Vertices (x, y, z, nx, ny, nz, u, v) and triangles."""

    def __init__(self):
        self.vertices, self.triangles = [], []

    def vertex(self, position, normal, uv):
        length = math.sqrt(sum(c * c for c in normal))
        self.vertices.append((*position, *(c / length for c in normal), *uv))
        return len(self.vertices) - 1

    def revolve(self, profile, azimuth, given=None):
        """Turns rings around z. A ring on the axis becomes one vertex per azimuth (each with its own u).
        `given` maps a ring's number to positions that replace those of its circle."""
        rows = []
        for k, (r, z, nr, nz, v) in enumerate(profile):
            row = []
            for j in range(azimuth + 1):
                phi = 2 * math.pi * j / azimuth
                # The seam repeats its first position exactly, so that the surface closes.
                c, s = (math.cos(phi), math.sin(phi)) if j < azimuth else (1.0, 0.0)
                position = given[k][j % azimuth] if given and k in given else (r * c, r * s, z)
                row.append(self.vertex(position, (nr * c, nr * s, nz), (j / azimuth, v)))
            rows.append(row)
        for k in range(len(rows) - 1):
            for j in range(azimuth):
                a, b, c, d = rows[k][j], rows[k][j + 1], rows[k + 1][j + 1], rows[k + 1][j]
                if profile[k][0] > 0:
                    self.triangles.append((a, b, c))
                if profile[k + 1][0] > 0:
                    self.triangles.append((a, c, d))

    def facet(self, a, b, c, n, ua, ub, uc):
        """A flat triangle, cut into n * n so that its edges meet the finer rings beside it."""
        e, f = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
        normal = (e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0])
        index = {}
        for i in range(n + 1):
            for j in range(n + 1 - i):
                p = lerp3(a, b, c, i / n, j / n)
                index[i, j] = self.vertex(p, normal, lerp3(ua, ub, uc, i / n, j / n))
        for i in range(n):
            for j in range(n - i):
                self.triangles.append((index[i, j], index[i + 1, j], index[i, j + 1]))
                if i + j < n - 1:
                    self.triangles.append((index[i + 1, j], index[i + 1, j + 1], index[i, j + 1]))

    def write(self, name):
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(self.vertices)}"]
        header += [f"property float {p}" for p in ("x", "y", "z", "nx", "ny", "nz", "u", "v")]
        header += [f"element face {len(self.triangles)}", "property list uchar int vertex_indices", "end_header"]
        data = ("\n".join(header) + "\n").encode()
        # Eight decimals hide most last-bit differences between platforms' sines; adding 0.0 turns -0.0 into 0.0.
        data += b"".join(struct.pack("<8f", *(round(c, 8) + 0.0 for c in v)) for v in self.vertices)
        data += b"".join(struct.pack("<B3i", 3, *t) for t in self.triangles)
        save(name, data, f"{len(self.triangles)} triangles")


def lerp3(a, b, c, s, t):
    return tuple(p + (q - p) * s + (r - p) * t for p, q, r in zip(a, b, c))


def save(name, data, what):
    with open(os.path.join(HERE, name), "wb") as f:
        f.write(data)
    print(f"{name}: {what}, {len(data)} bytes")


# ----------------------------------------------------------------------------------------------------------- the orb
def make_orb():
    mesh = Mesh()
    chord = math.pi / FACETS

    cut = AZIMUTH // FACETS

    def corner(ring, step):
        phi = step % (2 * FACETS) * chord
        return (ring[0] * math.cos(phi), ring[0] * math.sin(phi), ring[1])

    def polygon(ring):
        """The points of a ring of the belt: a regular polygon, each edge cut as the facets beside it are."""
        return [lerp3(corner(ring, 2 * i), corner(ring, 2 * i + 2), (0, 0, 0), j / cut, 0)
                for i in range(FACETS) for j in range(cut)]

    # Dome and groove, from the pole up to the belt; the last ring is the belt's polygon.
    low, high = BELT[1], BELT[0]
    lower = arc(1.0, 180, low + 5.2) + bump(low + 4.0, 1.1, -0.022) + arc(1.0, low + 2.8, low + 0.8, 20)
    lower += [polar(BELT_FLOOR, low)]
    profile = rings(rounded(lower, ROUNDING))
    profile[0] = (0.0, -1.0, 0.0, -1.0, 0.0)
    last = len(profile) - 1
    v_low = profile[-1][4]
    corner_low = (profile[-1][0], profile[-1][1])
    mesh.revolve(profile, AZIMUTH, {last: polygon(corner_low)})

    # Collar, lip, funnel, cavity: one profile from the belt over the lip to the cavity's far pole.
    upper = [polar(BELT_FLOOR, high)] + arc(1.0, high - 0.8, OPENING + 4.8, 60)
    upper += bump(OPENING + 2.4, 2.4, 0.042)
    upper += [polar(0.985, OPENING - 0.6)] + arc(CAVITY, 30.5, 180)
    profile = rings(rounded(upper, ROUNDING))
    profile = [(*p[:4], p[4] + v_low + 0.3) for p in profile]
    profile[-1] = (0.0, -CAVITY, 0.0, 1.0, profile[-1][4])
    corner_high = (profile[0][0], profile[0][1])
    mesh.revolve(profile, AZIMUTH, {0: polygon(corner_high)})

    # The belt: corners on the two polygons, between them a ring of corners half a facet further.
    ridge = polar(BELT_RIDGE, 0.5 * (low + high))

    def uv(step, v):
        return (step / (2 * FACETS), v)

    v_mid, v_high = v_low + 0.15, v_low + 0.3
    for i in range(0, 2 * FACETS, 2):
        for edge, v, flip in ((corner_low, v_low, False), (corner_high, v_high, True)):
            wide = [corner(edge, i), corner(edge, i + 2), corner(ridge, i + 1)]
            uw = [uv(i, v), uv(i + 2, v), uv(i + 1, v_mid)]
            back = [corner(ridge, i + 1), corner(edge, i + 2), corner(ridge, i + 3)]
            ub = [uv(i + 1, v_mid), uv(i + 2, v), uv(i + 3, v_mid)]
            for t, u in ((wide, uw), (back, ub)):
                order = (0, 2, 1) if flip else (0, 1, 2)
                mesh.facet(*(t[o] for o in order), cut, *(u[o] for o in order))
    mesh.write("orb.ply")
    return mesh


# ---------------------------------------------------------------------------------------------- the foot it stands on
FOOT_CENTRE = 1.20     # height of the orb's centre
FOOT_GAP = 0.002       # room between orb and foot


def make_foot():
    cup = 1 + FOOT_GAP
    rim = 0.44
    edge = FOOT_CENTRE - math.sqrt(cup * cup - rim * rim)
    outline = [(0.0, FOOT_CENTRE - cup)]
    outline += [(r, FOOT_CENTRE - math.sqrt(cup * cup - r * r)) for r in [rim * i / 60 for i in range(1, 61)]]
    outline += [(rim + 0.045, edge + 0.004), (rim + 0.05, edge - 0.045), (rim - 0.03, edge - 0.075)]
    # A cove (quarter ellipse) from the neck out to the plinth.
    outline += [(0.40 + 0.20 * (1 - math.cos(t)), 0.075 + (edge - 0.165) * (1 - math.sin(t)))
                for t in [0.5 * math.pi * i / 40 for i in range(41)]]
    outline += [(0.66, 0.075), (0.66, 0.0), (0.0, 0.0)]
    # Travelled from the bottom up, like the orb, the outside is to the right.
    profile = rings(rounded(outline[::-1], 0.008), turn=15, step=0.2)
    profile[0] = (0.0, 0.0, 0.0, -1.0, 0.0)
    profile[-1] = (0.0, FOOT_CENTRE - cup, 0.0, 1.0, profile[-1][4])
    mesh = Mesh()
    mesh.revolve(profile, 72)
    mesh.write("foot.ply")
    return mesh


# ------------------------------------------------------------------------------------------ the stage: floor and sweep
STAGE_HALF_WIDTH = 24.0
STAGE_FRONT, STAGE_BACK, STAGE_RADIUS, STAGE_TOP = -24.0, 6.5, 4.5, 9.0


def make_stage():
    """A floor that bends up into a back wall. Its texture coordinates are the floor's own (x, y) / 8 + 1/2, continued
    up the wall by length, so that one texture covers [-4, 4] x [-4, 4] around the orb."""
    n = 48
    path = [(STAGE_FRONT, 0.0, 0.0, 1.0, STAGE_FRONT)]
    start = STAGE_BACK - STAGE_RADIUS
    for i in range(n + 1):
        a = 0.5 * math.pi * i / n
        path.append((start + STAGE_RADIUS * math.sin(a), STAGE_RADIUS * (1 - math.cos(a)),
                     -math.sin(a), math.cos(a), start + STAGE_RADIUS * a))
    path.append((STAGE_BACK, STAGE_TOP, -1.0, 0.0, path[-1][4] + STAGE_TOP - STAGE_RADIUS))
    mesh = Mesh()
    w = STAGE_HALF_WIDTH
    rows = [[mesh.vertex((x, y, z), (0.0, ny, nz), (x / 8 + 0.5, s / 8 + 0.5)) for x in (-w, w)]
            for y, z, ny, nz, s in path]
    for a, b in zip(rows, rows[1:]):
        mesh.triangles += [(a[0], a[1], b[1]), (a[0], b[1], b[0])]
    mesh.write("stage.ply")
    return mesh


# ---------------------------------------------------------------------------------------------------------- textures
SOFTBOX_RADIANCE = 11.0


def png(name, size, pixel, tint):
    """An 8-bit sRGB PNG: a tint times a function of x, y in [0, 1], both linear."""
    rows = bytearray()
    for j in range(size):
        rows.append(0)
        for i in range(size):
            value = pixel((i + 0.5) / size, (j + 0.5) / size)
            rows += bytes(max(0, min(255, round(255 * srgb(value * t)))) for t in tint)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0))
    data += chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b"")
    save(name, data, f"{size} x {size}")


def srgb(linear):
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


def smoothstep(a, b, x):
    t = max(0.0, min(1.0, (x - a) / (b - a)))
    return t * t * (3 - 2 * t)


def floor_pixel(x, y):
    """A checker that fades into plain grey away from the orb."""
    px, py = 8 * (x - 0.5), 8 * (y - 0.5)
    tile, edge = 0.5, 8 / 1024
    # The two square waves have edges one texel wide, so that the checker does not step.
    wave = 1.0
    for p in (px, py):
        t = abs(math.fmod(abs(p) / tile + 0.5, 1.0) - 0.5) * tile
        sign = 1.0 if math.floor(p / tile) % 2 == 0 else -1.0
        wave *= sign * min(1.0, t / (0.5 * edge))
    fade = 1 - smoothstep(1.4, 3.9, math.hypot(px, py))
    return 0.20 + 0.07 * wave * fade


def softbox(x, y):
    """Radiance of a softbox: bright in the middle, dimmer outwards, gone at its rim."""
    d = max(abs(2 * x - 1), abs(2 * y - 1))
    r2 = (2 * x - 1) ** 2 + (2 * y - 1) ** 2
    return SOFTBOX_RADIANCE * (0.5 + 0.5 * math.exp(-1.5 * r2)) * (1 - smoothstep(0.90, 1.0, d))


def room(x, y):
    """Radiance of the room around the studio, latitude and longitude, Y up, as the scene's envmap reads it: dark below,
    a glow above the horizon on the key's side, a long soft lamp overhead."""
    theta, phi = math.pi * y, 2 * math.pi * x
    up = math.cos(theta)
    right, front = math.sin(theta) * math.sin(phi), -math.sin(theta) * math.cos(phi)
    level = 0.03 + 0.20 * smoothstep(-0.1, 1.0, up)
    level += 0.30 * math.exp(-((up - 0.05) / 0.16) ** 2) * smoothstep(-0.7, 0.9, -0.8 * right + 0.6 * front)
    if up > 0.5:
        along, across = abs(right / up), abs(front / up - 0.05)
        level += 3.0 * (1 - smoothstep(0.34, 0.72, along)) * (1 - smoothstep(0.10, 0.38, across))
    return level


def hdr(name, width, height, radiance, tint=(1.0, 1.0, 1.0)):
    """A Radiance picture (RGBE, no run lengths) from a function of x, y in [0, 1]."""
    data = bytearray(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode())
    for j in range(height):
        for i in range(width):
            value = radiance((i + 0.5) / width, (j + 0.5) / height)
            rgb = [value * t for t in tint]
            exponent = math.frexp(max(rgb))[1]
            scale = 256 / 2.0 ** exponent
            data += bytes((*(min(255, int(c * scale)) for c in rgb), exponent + 128) if value > 1e-6 else (0, 0, 0, 0))
    save(name, data, f"{width} x {height}")


def main():
    make_orb()
    make_foot()
    make_stage()
    png("floor.png", 1024, floor_pixel, (0.96, 0.995, 1.05))
    hdr("softbox.hdr", 64, 64, softbox, (1.04, 1.0, 0.94))
    hdr("room.hdr", 128, 64, room, (0.94, 0.99, 1.07))


if __name__ == "__main__":
    main()
