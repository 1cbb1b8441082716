"""Both programs over the same rows of directions. Every function takes a Spec and returns a list
with one entry a row."""

import subprocess
import tempfile
from pathlib import Path

EVAL_COLUMNS = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z"
SAMPLE_COLUMNS = "wo_x,wo_y,wo_z,u1,u2,uc"
PLAIN = ("diffuse", "conductor", "roughconductor", "dielectric", "thindielectric",
         "roughdielectric", "plastic", "roughplastic")


class Failure(Exception):
    """One of the programs refuses; the text is its complaint."""


class Faceta:
    def __init__(self, program):
        self.program = program

    def evaluate(self, spec, mode, rows):
        """(red, green, blue, density)."""
        table = self.run("eval", spec, mode, EVAL_COLUMNS, rows)
        return [tuple(map(float, line[6:10])) for line in table]

    def sample(self, spec, mode, rows):
        """(direction, weight, density, lobe, delta)."""
        table = self.run("sample", spec, mode, SAMPLE_COLUMNS, rows)
        return [(tuple(map(float, line[6:9])), tuple(map(float, line[9:12])), float(line[12]),
                 line[13], line[14] == "1") for line in table]

    def run(self, command, spec, mode, columns, rows):
        lines = [columns, *(",".join(map(repr, row)) for row in rows), ""]
        words = [self.program, command]
        with tempfile.TemporaryDirectory(prefix="faceta_peer_") as folder:
            if spec.type in PLAIN:
                words += [spec.type, *spec.settings()]
            else:
                scene = Path(folder) / "material.xml"
                body = spec.xml(' id="peer"')
                scene.write_text(f'<scene version="3.0.0">{body}</scene>', encoding="utf-8")
                words += ["--scene", scene, "--id", "peer"]
            result = subprocess.run([*words, "--mode", mode], input="\n".join(lines), text=True,
                                    capture_output=True, check=False)
        if result.returncode:
            raise Failure(f"faceta {command} {spec}: {result.stderr.strip()}")
        return [line.split(",") for line in result.stdout.splitlines()[1:]]


class Mitsuba:
    def __init__(self):
        import mitsuba
        mitsuba.set_variant("scalar_rgb")
        mitsuba.set_log_level(mitsuba.LogLevel.Error)
        self.mi = mitsuba
        self.lobes = [(mitsuba.BSDFFlags.Null, "null"),
                      (mitsuba.BSDFFlags.Reflection, "reflection"),
                      (mitsuba.BSDFFlags.Transmission, "transmission")]

    def load(self, spec, mode):
        mi = self.mi
        try:
            bsdf = mi.load_string(spec.xml(' version="3.0.0"'))
        except RuntimeError as error:
            raise Failure(f"mitsuba {spec}: {error}") from error
        point = mi.SurfaceInteraction3f()
        point.t, point.uv = 1, mi.Point2f(0.5, 0.5)
        point.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
        transport = {"radiance": mi.TransportMode.Radiance, "importance": mi.TransportMode.Importance}
        return bsdf, mi.BSDFContext(transport[mode]), point

    def evaluate(self, spec, mode, rows):
        bsdf, context, point = self.load(spec, mode)
        vector, result = self.mi.Vector3f, []
        for row in rows:
            point.wi, wi = vector(row[:3]), vector(row[3:])
            value = bsdf.eval(context, point, wi)
            result.append((value[0], value[1], value[2], bsdf.pdf(context, point, wi)))
        return result

    def sample(self, spec, mode, rows):
        bsdf, context, point = self.load(spec, mode)
        vector, pair, result = self.mi.Vector3f, self.mi.Point2f, []
        for row in rows:
            point.wi = vector(row[:3])
            s, weight = bsdf.sample(context, point, row[5], pair(row[3:5]))
            if s.pdf > 0:
                kind = s.sampled_type
                lobe = next(name for flag, name in self.lobes if kind & flag)
                delta = bool(kind & (self.mi.BSDFFlags.Delta | self.mi.BSDFFlags.Null))
                result.append((tuple(s.wo), tuple(weight), s.pdf, lobe, delta))
            else:
                result.append(((0.0,) * 3, (0.0,) * 3, 0.0, "none", False))
        return result
