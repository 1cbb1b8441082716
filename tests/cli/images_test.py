"""faceta diff and faceta info on pictures whose numbers are known."""

import json
import math

from program import CHECK_FAILED, INPUT_ERROR, OK, Case, main, run, write_pfm

# Linear Rec. 709 of X = Y = Z = 1: the rows of the inverse matrix of ITU-R BT.709 with D65, added up.
EQUAL_ENERGY = (1.204794, 0.948292, 0.908916)


def grey(value):
    return lambda x, y: tuple(value * c for c in EQUAL_ENERGY)


class Images(Case):
    def image(self, name, pixel, size=(4, 4)):
        path = self.path(name)
        write_pfm(path, *size, pixel)
        return path

    def diff(self, *arguments, code=OK):
        process = run("diff", *arguments, "--json")
        self.assertEqual((process.returncode, process.stderr), (code, ""))
        return json.loads(process.stdout)

    def test_differences(self):
        a = self.image("a.pfm", lambda x, y: (1.0, 0.5, 2.0))
        b = self.image("b.pfm", lambda x, y: (0.5, 0.5, 2.0 if (x, y) != (3, 1) else 0.0))
        result = self.diff(a, b)
        mse = (0.25 + 4 / 16) / 3
        self.assertAlmostEqual(result["mse"], mse, places=6)
        self.assertAlmostEqual(result["rmse"], math.sqrt(mse), places=6)
        self.assertAlmostEqual(result["psnr"], -10 * math.log10(mse), places=5)
        self.assertAlmostEqual(result["channels"]["R"]["rel_mse"], 0.25 / 0.26, places=5)
        self.assertEqual(result["max_at"], {"x": 3, "y": 1, "channel": "B"})
        self.assertEqual(result["max_abs"], 2)
        self.assertNotIn("z_test", result)
        text = self.succeed("diff", a, b)
        for word in ["MSE", "RMSE", "relMSE", "PSNR", f"{mse:.6g}", f"{math.sqrt(mse):.6g}"]:
            self.assertIn(word, text)

    def test_equal_images(self):
        a = self.image("a.pfm", grey(1))
        result = self.diff(a, a)
        self.assertEqual((result["mse"], result["psnr"]), (0, None))
        self.assertIn("inf", self.succeed("diff", a, a))

    def test_z_test(self):
        # Variance 1 in X, Y and Z, 100 samples: z is ten times the difference. With 16 pixels
        # alpha = 1 - 0.99^(1/16), whose |z| is 3.42.
        reference = self.image("r.pfm", grey(0.5))
        variance = self.image("v.pfm", grey(1))
        for difference, code in [(0.30, OK), (0.33, OK), (0.36, CHECK_FAILED)]:
            image = self.image("i.pfm", grey(0.5 + difference))
            test = self.diff(
                image, reference, "--variance", variance, "--spp", "100", code=code
            )["z_test"]
            self.assertEqual(test["pass"], code == OK)
            self.assertAlmostEqual(test["largest_z"], 10 * difference, delta=1e-3)
            self.assertAlmostEqual(test["z_threshold"], 3.42, delta=0.01)
            for z in test["mean_z"]:
                self.assertAlmostEqual(z, 4 * 10 * difference, delta=1e-2)
            text = run("diff", image, reference, "--variance", variance, "--spp", "100").stdout
            self.assertIn("z-test: pass" if code == OK else "z-test: FAIL", text)

    def test_two_sample_test(self):
        # Variances of 0.02 each: z of a pixel is 5 times the difference, of a block of 64 pixels 40
        # times, where rounding to halves adds nothing that counts.
        reference = self.image("r.pfm", lambda x, y: (2, 2, 2), (80, 80))
        variance = self.image("v.pfm", lambda x, y: (0.02, 0.02, 0.02), (80, 80))
        bright_block = lambda x, y: (2, 2.11 if x < 8 and y >= 72 else 2, 2)
        bright_blocks = lambda x, y: (2 + 0.11 * (x < 8), 2, 2 + 0.11 * (x < 8 and y < 72))
        for pixel, code, share, z, ratio in [
            (lambda x, y: (2, 2, 2), OK, 0, 0, 1),
            (bright_block, OK, 1 / 300, 4.4, 1 + 0.055 / 100),
            (bright_blocks, CHECK_FAILED, 19 / 300, 4.4, 1),
            (lambda x, y: (2, 2.03, 2), CHECK_FAILED, 0, 1.2, 1.015),
            (lambda x, y: (math.nan,) * 3, CHECK_FAILED, 0, 0, None),
        ]:
            image = self.image("i.pfm", pixel, (80, 80))
            variances = ["--image-variance", variance, "--reference-variance", variance]
            test = self.diff(image, reference, *variances, code=code)["two_sample_test"]
            self.assertEqual(test["pass"], code == OK)
            self.assertAlmostEqual(test["block_share"], share, places=9)
            self.assertAlmostEqual(test["largest_block_z"], z, delta=1e-2)
            if ratio is None:
                self.assertEqual(test["non_finite"], 3 * 80 * 80)
            else:
                self.assertAlmostEqual(test["mean_ratio"][1], ratio, delta=1e-5)

    def test_errors(self):
        a, b = self.image("a.pfm", grey(1)), self.image("b.pfm", grey(1), (4, 5))
        self.fail_with(INPUT_ERROR, r"error: .*size", "diff", a, b)
        self.fail_with(INPUT_ERROR, r"give --spp N", "diff", a, a, "--variance", a)
        text = self.path("text.exr", "this is no picture")
        self.fail_with(INPUT_ERROR, r"text\.exr: error: ", "diff", a, text)
        self.fail_with(INPUT_ERROR, r"text\.exr: error: ", "info", text)

    def test_info(self):
        a = self.image("a.pfm", lambda x, y: (x, -0.5, 2 if y else math.inf), (5, 3))
        info = json.loads(self.succeed("info", a, "--json"))
        self.assertEqual((info["width"], info["height"], info["storage"]), (5, 3, "float"))
        channels = [
            (c["name"], c["min"], c["max"], c["mean"], c["non_finite"]) for c in info["channels"]
        ]
        self.assertEqual(
            channels, [("R", 0, 4, 2, 0), ("G", -0.5, -0.5, -0.5, 0), ("B", 2, 2, 2, 5)]
        )
        text = self.succeed("info", a, a)
        self.assertEqual(text.count("a.pfm: 5 x 3, float\n"), 2)
        self.assertEqual(len(json.loads(self.succeed("info", "--cpu", a, "--json"))), 2)

    def test_info_of_the_cpu(self):
        cpu = json.loads(self.succeed("info", "--cpu", "--json"))
        self.assertIn(cpu["best"], cpu["instruction_sets"])
        for name in cpu["instruction_sets"]:
            self.assertIn(f"builtin_{name}.so", cpu["modules"])
        with open("/proc/cpuinfo") as file:
            self.assertIn(cpu["cpu"], file.read())
        self.assertIn(cpu["cpu"], self.succeed("info", "--cpu"))


if __name__ == "__main__":
    main()
