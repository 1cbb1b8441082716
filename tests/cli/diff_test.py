"""The statistical tests of faceta diff, by numbers worked out on paper."""

import json
import math

from program import CHECK_FAILED, INPUT_ERROR, OK, USAGE, Case, main, run, write_pfm
from images_test import EQUAL_ENERGY


class Tests(Case):
    def image(self, name, pixel, size=(16, 8)):
        path = self.path(name)
        write_pfm(path, *size, pixel if callable(pixel) else lambda x, y: pixel)
        return path

    def diff(self, *arguments, code=OK):
        process = run("diff", *arguments, "--json")
        self.assertEqual((process.returncode, process.stderr), (code, ""))
        return json.loads(process.stdout)

    def two(self, *arguments, **others):
        return self.diff(*arguments, **others)["two_sample_test"]


class TwoSamples(Tests):
    def setUp(self):
        super().setUp()
        self.one = self.image("one.pfm", (1.0, 1.0, 1.0))
        self.zero = self.image("zero.pfm", (0.0, 0.0, 0.0))

    def test_variances_add_up(self):
        # One pixel differs by 0.5; variances 0.09 and 0.16 make a standard deviation of 0.5. Its
        # block of 64 pixels has 64 times that variance, both blocks together 128 times.
        image = self.image("i.pfm", lambda x, y: (1.0, 1.5 if (x, y) == (11, 2) else 1.0, 1.0))
        a = self.image("a.pfm", (0.09, 0.09, 0.09))
        b = self.image("b.pfm", (0.16, 0.16, 0.16))
        test = self.two(
            *[image, self.one, "--image-variance", a, "--reference-variance", b],
            *["--quantisation", "0"],
        )
        self.assertTrue(test["pass"])
        self.assertAlmostEqual(test["largest_z"], 1, places=5)
        self.assertEqual(test["largest_at"], {"x": 11, "y": 2, "channel": "G"})
        self.assertAlmostEqual(test["largest_block_z"], 0.5 / math.sqrt(64 * 0.25), places=5)
        self.assertEqual(test["largest_block_at"], {"x": 8, "y": 0})
        self.assertEqual(test["mean_z"][0], 0)
        self.assertAlmostEqual(test["mean_z"][1], 0.5 / math.sqrt(128 * 0.25), places=5)
        self.assertAlmostEqual(test["mean_ratio"][1], 1 + 0.5 / 128, places=6)

    def test_which_variance_is_whose_does_not_matter(self):
        image = self.image("i.pfm", lambda x, y: (1.0 + 0.01 * x / 16, 1.0, 1.0))
        a = self.image("a.pfm", lambda x, y: (0.01 * (x + 1), 0.2, 0.3))
        results = [
            self.two(image, self.one, "--image-variance", u, "--reference-variance", v)
            for u, v in [(a, self.zero), (self.zero, a)]
        ]
        self.assertEqual(*results)
        self.assertGreater(results[0]["largest_z"], 0)

    def test_quantisation(self):
        # Without variances, values of 1 and 1.003 rounded to 0.001 of themselves: z of a pixel is
        # 0.003 / (0.001 sqrt(1 + 1.003^2)), of a block of 64 pixels 8 times that.
        image = self.image("i.pfm", (1.003, 1.003, 1.003))
        variances = ["--image-variance", self.zero, "--reference-variance", self.zero]
        z = 3 / math.sqrt(1 + 1.003**2)
        for quantisation, scale, code in [(0.001, 1, CHECK_FAILED), (0.005, 5, OK)]:
            test = self.two(
                image, self.one, *variances, "--quantisation", str(quantisation), code=code
            )
            self.assertAlmostEqual(test["largest_z"], z / scale, places=3)
            self.assertAlmostEqual(test["largest_block_z"], 8 * z / scale, places=2)
            self.assertEqual(test["block_share"], 1 if code else 0)
        # The default is that of half precision: 2^-11 / sqrt(12).
        test = self.two(image, self.one, *variances, code=CHECK_FAILED)
        self.assertAlmostEqual(test["largest_z"], z * 1e-3 / (2**-11 / math.sqrt(12)), delta=0.01)

    def test_means_beyond_one_percent_fail(self):
        variance = self.image("v.pfm", (9.0, 9.0, 9.0))
        variances = ["--image-variance", variance, "--reference-variance", variance]
        for value, code in [(1.009, OK), (0.991, OK), (1.011, CHECK_FAILED), (0.989, CHECK_FAILED)]:
            image = self.image("i.pfm", (1.0, 1.0, value))
            test = self.two(image, self.one, *variances, code=code)
            self.assertEqual((test["pass"], test["block_share"]), (code == OK, 0))
            self.assertAlmostEqual(test["mean_ratio"][2], value, places=6)
            text = run("diff", image, self.one, *variances).stdout
            self.assertIn("two-sample test: " + ("FAIL" if code else "pass"), text)

    def test_negative_variances_count_as_zero(self):
        negative = self.image("n.pfm", (-1.0, -1.0, -1.0))
        quarter = self.image("q.pfm", (0.25, 0.25, 0.25))
        image = self.image("i.pfm", (1.0, 1.0, 1.001))
        test = self.two(
            *[image, self.one, "--image-variance", negative, "--reference-variance", quarter],
            *["--quantisation", "0"],
        )
        self.assertAlmostEqual(test["largest_z"], 0.001 / 0.5, places=5)

    def test_black_pictures_agree(self):
        variances = ["--image-variance", self.zero, "--reference-variance", self.zero]
        test = self.two(self.zero, self.zero, *variances)
        self.assertEqual((test["pass"], test["largest_z"], test["mean_z"]), (True, 0, [0, 0, 0]))


class OneSample(Tests):
    def xyz(self, value):
        return tuple(value * c for c in EQUAL_ENERGY)

    def test_small_variances_are_floored(self):
        # A variance of 0 counts as 1e-4: with 4 spp, z is 200 times the difference.
        reference = self.image("r.pfm", self.xyz(1))
        variance = self.image("v.pfm", (0.0, 0.0, 0.0))
        for difference, code in [(0.01, OK), (0.03, CHECK_FAILED)]:
            image = self.image("i.pfm", self.xyz(1 + difference))
            test = self.diff(
                *[image, reference, "--variance", variance, "--spp", "4"], code=code
            )["z_test"]
            self.assertAlmostEqual(test["largest_z"], 200 * difference, delta=2e-3)

    def test_samples_of_the_reference(self):
        # Variance 1; 16 and 48 samples: the mean of 128 pixels has variance (1/16 + 1/48) / 128.
        reference, variance = self.image("r.pfm", self.xyz(1)), self.image("v.pfm", self.xyz(1))
        image = self.image("i.pfm", self.xyz(1.01))
        arguments = [image, reference, "--variance", variance, "--spp", "16"]
        exact = self.diff(*arguments)["z_test"]
        noisy = self.diff(*arguments, "--reference-spp", "48")["z_test"]
        for test, variance_of_mean in [(exact, 1 / 16), (noisy, 1 / 16 + 1 / 48)]:
            self.assertAlmostEqual(test["largest_z"], 0.01 * 4, delta=1e-4)
            for z in test["mean_z"]:
                self.assertAlmostEqual(
                    z, 0.01 * math.sqrt(128 / variance_of_mean), delta=2e-3
                )

    def test_share_of_pixels_that_may_fail(self):
        # 3 x 1600 values: twelve (0.25 %) may fail, thirteen may not; one pixel is three values.
        size = (40, 40)
        reference = self.image("r.pfm", self.xyz(1), size)
        variance = self.image("v.pfm", self.xyz(1), size)
        for bad, code in [(4, OK), (5, CHECK_FAILED)]:
            wrong = lambda x, y: self.xyz(2 if y == 7 and x < bad else 1)
            image = self.image("i.pfm", wrong, size)
            test = self.diff(image, reference, "--variance", variance, "--spp", "100", code=code)
            self.assertAlmostEqual(test["z_test"]["pass_share"], 1 - 3 * bad / 4800, places=9)


class Errors(Tests):
    def test_input_errors(self):
        a = self.image("a.pfm", (1.0, 1.0, 1.0))
        small = self.image("small.pfm", (1.0, 1.0, 1.0), (8, 8))
        text = self.path("text.exr", "no picture")
        for arguments in [
            ["--variance", small, "--spp", "1"],
            ["--image-variance", small, "--reference-variance", a],
            ["--image-variance", a, "--reference-variance", small],
        ]:
            self.fail_with(INPUT_ERROR, r"error: .*size", "diff", a, a, *arguments)
        for arguments in [
            ["--variance", text, "--spp", "1"],
            ["--image-variance", text, "--reference-variance", a],
            ["--image-variance", a, "--reference-variance", text],
        ]:
            self.fail_with(INPUT_ERROR, r"text\.exr: error: ", "diff", a, a, *arguments)
        missing = self.path("missing.pfm")
        for arguments in [[missing, a], [a, missing]]:
            self.fail_with(INPUT_ERROR, r"missing\.pfm: error: ", "diff", *arguments)
        self.fail_with(
            INPUT_ERROR, r"missing\.pfm: error: ", "diff", a, a, "--variance", missing, "--spp", "1"
        )

    def test_usage(self):
        a = self.image("a.pfm", (1.0, 1.0, 1.0))
        both = ["--image-variance", a, "--reference-variance", a]
        for pattern, arguments in [
            (r"--image-variance requires --reference-variance", ["--image-variance", a]),
            (r"--reference-variance requires --image-variance", ["--reference-variance", a]),
            (r"--quantisation requires --image-variance", ["--quantisation", "0.1"]),
            (r"--spp requires --variance", ["--spp", "4"]),
            (r"--reference-spp requires --variance", ["--reference-spp", "4"]),
            (r"--spp", ["--variance", a, "--spp", "0"]),
            (r"--spp", ["--variance", a, "--spp", "inf"]),
            (r"--quantisation", [*both, "--quantisation", "-1"]),
            (r"--quantisation", [*both, "--quantisation", "nan"]),
            (r"--quantisation", [*both, "--quantisation", "half"]),
        ]:
            self.fail_with(USAGE, pattern, "diff", a, a, *arguments)


if __name__ == "__main__":
    main()
