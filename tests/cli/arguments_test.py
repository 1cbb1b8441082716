"""Help, version, usage errors and their exit codes."""

from program import INPUT_ERROR, USAGE, Case, main

COMMANDS = ["render", "gallery", "materials", "eval", "sample", "diff", "info"]


class Arguments(Case):
    def test_version(self):
        self.assertRegex(self.succeed("--version"), r"^faceta \d+\.\d+\.\d+\n$")

    def test_help_names_every_command(self):
        text = self.succeed("--help")
        for command in COMMANDS:
            self.assertRegex(text, rf"(?m)^  {command} ")

    def test_help_of_every_command(self):
        for command in COMMANDS:
            with self.subTest(command):
                self.assertIn("Usage: faceta " + command, self.succeed(command, "--help"))

    def test_usage_errors(self):
        for arguments in [
            [],
            ["paint"],
            ["render"],
            ["render", "a.xml", "--paint"],
            ["render", "a.xml", "--size", "640"],
            ["render", "a.xml", "--size", "640x"],
            ["render", "a.xml", "--size", "0x480"],
            ["render", "a.xml", "--size", "640x480x3"],
            ["render", "a.xml", "--crop", "0,0,64"],
            ["render", "a.xml", "--crop=-1,0,64,64"],
            ["render", "a.xml", "--spp", "0"],
            ["render", "a.xml", "--spp", "many"],
            ["render", "a.xml", "--threads", "0"],
            ["render", "a.xml", "--isa", "sse"],
            ["render", "a.xml", "--sampler", "halton"],
            ["render", "a.xml", "-D", "spp"],
            ["render", "a.xml", "-D", "=1"],
            ["render", "a.xml", "-q", "-v"],
            ["render", "a.xml", "--exposure", "nan"],
            ["eval"],
            ["eval", "diffuse", "reflectance"],
            ["eval", "diffuse", "--mode", "sideways"],
            ["eval", "diffuse", "--isa", "v5"],
            ["eval", "--scene", "a.xml"],
            ["eval", "--id", "a"],
            ["eval", "diffuse", "--scene", "a.xml", "--id", "a"],
            ["sample", "diffuse", "-D", "a=1"],
            ["materials", "--json", "--markdown"],
            ["diff", "a.exr"],
            ["diff", "a.exr", "b.exr", "--spp", "3"],
            ["diff", "a.exr", "b.exr", "--variance", "v.exr", "--spp", "0"],
            ["diff", "a.exr", "b.exr", "--variance", "v.exr", "--spp", "nan"],
            ["info"],
        ]:
            with self.subTest(arguments):
                self.fail_with(USAGE, r"\S", *arguments)

    def test_arguments_of_render_are_understood(self):
        # What follows a good command line is the scene's fault: exit code 3 names the file.
        scene = self.folder / "no.xml"
        self.fail_with(
            INPUT_ERROR, r"no\.xml", "render", scene, "-o", self.path("a.exr"), "-o",
            self.path("a.png"), "--spp", "4", "--seed", "7", "--threads", "2", "--size", "64x48",
            "--crop", "0,8,16,32", "-s", "0", "--sampler", "sobol", "--isa", "scalar", "-D", "a=1",
            "-D", "b=x=y", "--exposure", "-1.5", "-q", "--permissive",
        )
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_errors_of_the_input(self):
        for arguments in [
            ["materials", "difuse"],
            ["eval", "difuse"],
            ["eval", "diffuse", "reflektance=1"],
            ["eval", "diffuse", "reflectance=2"],
            ["eval", "diffuse", "reflectance=red"],
            ["eval", "diffuse", "--input", self.folder / "none.csv"],
            ["eval", "--scene", self.folder / "none.xml", "--id", "a"],
            ["diff", self.folder / "none.exr", self.folder / "none.exr"],
            ["info", self.folder / "none.exr"],
        ]:
            with self.subTest(arguments):
                self.fail_with(INPUT_ERROR, r"error: ", *arguments)

    def test_suggestions(self):
        self.fail_with(INPUT_ERROR, "did you mean 'diffuse'", "eval", "difuse")
        self.fail_with(
            INPUT_ERROR, "did you mean 'reflectance'", "eval", "diffuse", "reflektance=1"
        )


if __name__ == "__main__":
    main()
