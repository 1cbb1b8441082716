"""faceta info on scene files."""

import json

from program import INPUT_ERROR, USAGE, Case, main

SCENE = """<scene version="3.0.0">
  <default name="samples" value="7"/>
  <integrator type="path"><integer name="max_depth" value="9"/></integrator>
  <sensor type="perspective" id="front">
    <float name="fov" value="35"/>
    <film type="hdrfilm">
      <integer name="width" value="64"/><integer name="height" value="48"/>
      <integer name="crop_offset_x" value="8"/><integer name="crop_offset_y" value="4"/>
      <integer name="crop_width" value="16"/><integer name="crop_height" value="12"/>
      <rfilter type="tent"/>
    </film>
    <sampler type="independent">
      <integer name="sample_count" value="$samples"/><integer name="seed" value="3"/>
    </sampler>
  </sensor>
  <sensor type="perspective"/>
  <texture type="checkerboard" id="squares"/>
  <bsdf type="twosided" id="paper">
    <bsdf type="diffuse"><ref name="reflectance" id="squares"/></bsdf>
  </bsdf>
  <shape type="cube"><ref id="paper"/></shape>
  <shape type="rectangle"><ref id="paper"/></shape>
  <shape type="cube"><bsdf type="roughconductor"><string name="material" value="Au"/></bsdf></shape>
  <shape type="sphere"><emitter type="area"/></shape>
  <emitter type="constant"/>
</scene>
"""


class InfoOfScenes(Case):
    def info(self, text, *arguments):
        return json.loads(self.succeed("info", self.path("s.xml", text), *arguments, "--json"))

    def test_what_is_in_it(self):
        info = self.info(SCENE)
        self.assertEqual(info["shapes"], {"cube": 2, "rectangle": 1, "sphere": 1})
        self.assertEqual(info["triangles"], 2 * 12 + 2)
        self.assertEqual(info["emitters"], {"area": 1, "constant": 1})
        self.assertEqual(info["lights"], 2)
        # What several shapes refer to counts once.
        self.assertEqual(info["materials"], {"diffuse": 1, "roughconductor": 1, "twosided": 1})
        self.assertEqual(info["textures"], {"checkerboard": 1})
        self.assertEqual(
            info["integrator"],
            {
                "type": "path",
                "max_depth": 9,
                "rr_depth": 5,
                "hide_emitters": False,
                "moments": False,
            },
        )
        front, other = info["sensors"]
        self.assertEqual((front["id"], front["width"], front["height"]), ("front", 64, 48))
        self.assertEqual(front["crop"], [8, 4, 16, 12])
        self.assertEqual((front["filter"], front["sampler"]), ("tent", "independent"))
        self.assertEqual((front["spp"], front["seed"]), (7, 3))
        self.assertAlmostEqual(front["x_fov"], 35)
        self.assertEqual((other["width"], other["height"], other["spp"]), (768, 576, 4))
        self.assertNotIn("crop", other)

    def test_text_names_the_same(self):
        text = self.succeed("info", self.path("s.xml", SCENE))
        for words in [
            "s.xml: scene",
            "2 cube, 1 rectangle, 1 sphere; 26 triangles",
            "1 area, 1 constant; 2 lights",
            "1 diffuse, 1 roughconductor, 1 twosided",
            "1 checkerboard",
            "path, max_depth 9, rr_depth 5",
            "front: 64 x 48 (crop 16 x 12 at 8, 4), 35 degrees wide, tent filter",
            "independent sampler, 7 spp, seed 3",
            "768 x 576",
        ]:
            self.assertIn(words, text)

    def test_defines_and_other_integrators(self):
        self.assertEqual(self.info(SCENE, "-D", "samples=64")["sensors"][0]["spp"], 64)
        direct = SCENE.replace(
            '<integrator type="path"><integer name="max_depth" value="9"/></integrator>',
            '<integrator type="moment"><integrator type="direct">'
            '<integer name="emitter_samples" value="2"/></integrator></integrator>',
        )
        integrator = self.info(direct)["integrator"]
        self.assertEqual((integrator["type"], integrator["moments"]), ("direct", True))
        self.assertEqual((integrator["emitter_samples"], integrator["bsdf_samples"]), (2, 1))

    def test_errors(self):
        broken = self.path("broken.xml", SCENE.replace('type="cube"', 'type="cubus"', 1))
        self.fail_with(INPUT_ERROR, r"broken\.xml:\d+:\d+: error: .*cubus", "info", broken)
        cut = self.path("cut.xml", SCENE[:200])
        self.fail_with(INPUT_ERROR, r"cut\.xml:\d+:\d+: error: ", "info", cut)
        missing = self.path("missing.xml")
        self.fail_with(INPUT_ERROR, r"missing\.xml.* does not exist", "info", missing)
        good = self.path("s.xml", SCENE)
        self.fail_with(INPUT_ERROR, r"nobody", "info", good, "-D", "nobody=1")
        self.fail_with(USAGE, r"give a file or --cpu", "info")


if __name__ == "__main__":
    main()
