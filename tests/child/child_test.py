# SPDX-License-Identifier: MIT
"""The user's own programs: --depth-from, --depth-cache and --mask-from with real programs, right and
wrong ones, and what the recipes of deploy/examples share.

HAPTICAST_ONNXRUNTIME is the folder of onnxruntime-node (npm); without it the test of ONNX Runtime is
left out. Run it with Debian's python3 (python3-numpy, python3-pil).
"""

import collections
import io
import json
import os
import pathlib
import py_compile
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import textwrap
import unittest

import numpy as np
from PIL import Image

TESTS = pathlib.Path(__file__).resolve().parent.parent
EXAMPLES = TESTS.parent / "deploy" / "examples"
TYPING_HANDS = TESTS / "data" / "typing_hands"
ONNXRUNTIME = pathlib.Path(
    os.environ.get("HAPTICAST_ONNXRUNTIME", "build/npm/node_modules/onnxruntime-node")).resolve()
PYTHON = f"{sys.executable} -B"
HAND = "167,111"  # a pixel on the nearer hand
SKIPPED = 77  # ctest's code for a test that was left out
LONGEST_S = 100  # only ends a test that has failed

sys.dont_write_bytecode = True
sys.path.insert(0, str(EXAMPLES))
sys.path.insert(0, str(TESTS / "support"))
import hapticast_child  # pylint: disable=wrong-import-position
from programs import SERVER  # pylint: disable=wrong-import-position

Run = collections.namedtuple("Run", "code lines warnings errors")


class ChildTest(unittest.TestCase):
    """A test with a folder of its own, and the server as a user runs it."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="hapticast-child-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def copy_clip(self, frames=8):
        """Copies the first frames of typing_hands."""
        clip = self.folder / "clip"
        for kind in ("rgb", "depth"):
            (clip / kind).mkdir(parents=True)
            for file in sorted((TYPING_HANDS / kind).iterdir())[:frames]:
                shutil.copy(file, clip / kind)
        shutil.copy(TYPING_HANDS / "meta.json", clip)
        return clip

    def write_program(self, name, code):
        """Writes a program that has numpy as np, hapticast_child as child and `counted()`, which notes
        each request in the file NAME.log. Returns its command."""
        file = self.folder / f"{name}.py"
        file.write_text(textwrap.dedent("""
            import hashlib, os, pathlib, signal, sys, time
            import numpy as np
            import hapticast_child as child
            answers = child.claim_stdout()
            def counted(read):
                number = 0
                with open(__file__.replace(".py", ".log"), "a", buffering=1) as log:
                    while (request := read(sys.stdin.buffer)) is not None:
                        number += 1
                        picture = request[1] if isinstance(request, tuple) else request
                        log.write(hashlib.sha256(picture).hexdigest() + "\\n")
                        yield number, request
            """) + textwrap.dedent(code), encoding="utf-8")
        return f"{PYTHON} {file}"

    def count(self, name):
        """Returns how many different pictures a program has received since the last call.

        The server may ask for a picture twice, if it begins the clip again before the answer."""
        file = self.folder / f"{name}.log"
        pictures = set(file.read_text("utf-8").split()) if file.exists() else ()
        file.unlink(missing_ok=True)
        return len(pictures)

    def run_server(self, *flags):
        """Runs a preview."""
        done = subprocess.run(
            [SERVER, *map(str, flags), "--preview", self.folder / "preview.png"], check=False,
            capture_output=True, text=True, timeout=LONGEST_S,
            env={**os.environ, "PYTHONPATH": str(EXAMPLES)})
        lines = (done.stdout + done.stderr).splitlines()
        return Run(done.returncode, lines, [each for each in lines if " warning " in each],
                   [each for each in lines if " error " in each])

    def find_object(self, run):
        """Returns the share (%) and the depths (mm) of object 1; fails without one in each frame."""
        self.assertEqual(run.code, 0, run)
        self.assertEqual(run.errors, [])
        text = "\n".join(run.lines)
        self.assertRegex(text, r"no object found in 0 of \d+ frames")
        found = re.search(r"object 1: ([\d.]+) % of the picture, depth (\d+) to (\d+) mm", text)
        self.assertIsNotNone(found, text)
        return [float(each) for each in found.groups()]

    def assert_refused(self, run, *parts):
        """Fails unless the run ended with exit code 2 and one line, which has the parts."""
        self.assertEqual(run.code, 2, run)
        self.assertEqual(len(run.errors), 1, run)
        self.assertEqual(run.warnings, [])
        for part in parts:
            self.assertIn(part, run.errors[0])


class SharedBytes(unittest.TestCase):
    """hapticast_child.py"""

    def test_reads_pictures(self):
        stream = io.BytesIO(b"P6\n2 1\n255\n\x01\x02\x03\x04\x05\x06" + b"P6\n1 1\n255\nab")
        picture = hapticast_child.read_ppm(stream)
        self.assertEqual(picture.tolist(), [[[1, 2, 3], [4, 5, 6]]])
        self.assertIsNone(hapticast_child.read_ppm(stream), "a picture that is cut off")
        self.assertIsNone(hapticast_child.read_ppm(stream), "the end")
        with self.assertRaises(ValueError):
            hapticast_child.read_ppm(io.BytesIO(b"P5\n1 1\n255\na"))

    def test_writes_depth(self):
        stream = io.BytesIO()
        hapticast_child.write_depth(stream, np.array([[1.5, 2.0, 3.0], [4.0, 5.0, 6.0]]).T, "inverse")
        self.assertEqual(stream.getvalue(), b"2 3 inverse\n" + struct.pack("<6f", 1.5, 4, 2, 5, 3, 6))

    def test_reads_requests_for_masks(self):
        header = {"frame": 3, "time_s": 0.125, "width": 2, "height": 1,
                  "points": [{"object": 1, "u": 1.0, "v": 0.0, "time_s": 0.0}]}
        complete = json.dumps(header).encode() + b"\n" + bytes(range(6)) + struct.pack("<2f", 0, 650.5)
        stream = io.BytesIO(complete + complete[:-1])
        request, picture, depth = hapticast_child.read_mask_request(stream)
        self.assertEqual(request, header)
        self.assertEqual(picture.tolist(), [[[0, 1, 2], [3, 4, 5]]])
        self.assertEqual(depth.tolist(), [[0.0, 650.5]])
        self.assertIsNone(hapticast_child.read_mask_request(stream), "a request that is cut off")
        self.assertIsNone(hapticast_child.read_mask_request(stream), "the end")

    def test_writes_masks(self):
        stream = io.BytesIO()
        hapticast_child.write_mask(stream, np.array([[0, 1], [2, 0]]))
        hapticast_child.write_mask(stream, None)
        self.assertEqual(stream.getvalue(), b"2 2\n\x00\x01\x02\x00" + b"0 0\n")

    def test_keeps_other_text_out_of_the_answers(self):
        code = ("import os, hapticast_child; answers = hapticast_child.claim_stdout(); print('a library');"
                "os.system('echo a program'); answers.write(b'answer'); answers.flush()")
        done = subprocess.run([sys.executable, "-B", "-c", code], check=True, capture_output=True,
                              env={**os.environ, "PYTHONPATH": str(EXAMPLES)})
        self.assertEqual(done.stdout, b"answer")
        self.assertIn(b"a library", done.stderr)
        self.assertIn(b"a program", done.stderr)


class Recipes(ChildTest):
    def test_have_no_errors_of_syntax(self):
        for name in ("depth_anything", "video_depth_anything", "sam2", "shift_scale_noise"):
            py_compile.compile(EXAMPLES / f"{name}.py", cfile=self.folder / "compiled", doraise=True)

    def estimate(self, clip, *flags):
        return f"{PYTHON} {EXAMPLES}/shift_scale_noise.py {clip}/depth {' '.join(flags)}"

    def test_an_estimator_of_each_kind_gives_an_object(self):
        start = self.copy_clip(12)
        for kind, clip in (("metric_mm", TYPING_HANDS), ("relative", start), ("inverse", start)):
            with self.subTest(kind):
                run = self.run_server("--source", clip, "--object", HAND, "--depth-from",
                                      self.estimate(clip, "--kind", kind))
                share, near_mm, far_mm = self.find_object(run)
                self.assertEqual(run.warnings, [])
                self.assertTrue(2 < share < 10, run)
                self.assertTrue(500 < near_mm < far_mm < 1200, run)

    def test_an_estimator_without_errors_gives_the_depths_of_the_clip(self):
        # The clip has masks, because holes, which an estimator fills, change the choice of the object.
        clip = self.copy_clip()
        mask = np.zeros((208, 320), np.uint8)
        mask[96:124, 140:190] = 1
        (clip / "mask").mkdir()
        for file in (clip / "depth").iterdir():
            Image.fromarray(mask).save(clip / "mask" / file.name)
        true = self.find_object(self.run_server("--source", clip))
        estimated = self.find_object(self.run_server(
            "--source", clip, "--depth-from", self.estimate(clip, "--scale 0 --shift 0 --soft-px 1")))
        self.assertEqual(estimated[0], true[0])
        for mine, its in zip(estimated[1:], true[1:]):
            self.assertLess(abs(mine - its), 8, f"{estimated} {true}")


def encode_field(number, value):
    """Returns a field of protobuf: an integer, or bytes, text and messages by their length."""
    def encode_integer(integer):
        out = b""
        while integer > 127:
            out += bytes([integer & 127 | 128])
            integer >>= 7
        return out + bytes([integer])
    if isinstance(value, int):
        return encode_integer(number << 3) + encode_integer(value)
    value = value.encode() if isinstance(value, str) else value
    return encode_integer(number << 3 | 2) + encode_integer(len(value)) + value


def encode_graph(weights, bias):
    """Returns an ONNX model (onnx.proto): a 1 x 1 convolution of three colours into one depth."""
    def tensor(name, dims, values):
        return (b"".join(encode_field(1, each) for each in dims) + encode_field(2, 1) +
                encode_field(8, name) + encode_field(9, np.array(values, "<f4").tobytes()))

    def value(name, dims):
        shape = b"".join(
            encode_field(1, encode_field(1 if isinstance(each, int) else 2, each)) for each in dims)
        return encode_field(1, name) + encode_field(
            2, encode_field(1, encode_field(1, 1) + encode_field(2, shape)))

    node = b"".join(encode_field(1, each) for each in ("picture", "weights", "bias"))
    node += encode_field(2, "depth") + encode_field(4, "Conv")
    graph = (encode_field(1, node) + encode_field(2, "depth_of_colors") +
             encode_field(5, tensor("weights", [1, 3, 1, 1], weights)) +
             encode_field(5, tensor("bias", [1], [bias])) +
             encode_field(11, value("picture", [1, 3, "height", "width"])) +
             encode_field(12, value("depth", [1, 1, "height", "width"])))
    opset = encode_field(1, "") + encode_field(2, 13)
    return encode_field(1, 8) + encode_field(7, graph) + encode_field(8, opset)


class OnnxRuntime(ChildTest):
    WEIGHTS = (1.0, 0.5, 0.25)  # all sums are exact in float32, in any order
    BIAS_mm = 500.0

    @unittest.skipUnless(ONNXRUNTIME.exists() and shutil.which("node"),
                         f"onnxruntime-node was not found in {ONNXRUNTIME}: "
                         "npm install --ignore-scripts --prefix build/npm onnxruntime-node@1.30.0")
    def test_a_graph_makes_depth(self):
        clip = self.copy_clip()
        shutil.rmtree(clip / "depth")
        graph = self.folder / "graph.onnx"
        graph.write_bytes(encode_graph(self.WEIGHTS, self.BIAS_mm))
        # A program of --mask-from receives the depth that vision receives.
        keeps = self.write_program("keeps", """
            for number, (request, picture, depth) in counted(child.read_mask_request):
                np.save(f"{sys.argv[1]}/{request['frame']}.npy", depth)
                child.write_mask(answers, None)
            """)
        run = self.run_server(
            "--source", clip, "--object", HAND, "--mask-from", f"{keeps} {self.folder}", "--depth-from",
            f"node {TESTS}/child/onnx_depth.mjs {ONNXRUNTIME} {graph}")
        self.assertEqual(run.code, 0, run)
        self.assertEqual(run.errors, [])
        self.assertEqual(self.count("keeps"), 8)
        for number, file in enumerate(sorted((clip / "rgb").iterdir())):
            picture = np.asarray(Image.open(file).convert("RGB")).astype(np.float32)
            expected = picture @ np.array(self.WEIGHTS, np.float32) + np.float32(self.BIAS_mm)
            received = np.load(self.folder / f"{number}.npy")
            self.assertTrue(np.array_equal(received, expected), f"frame {number}")


class WrongPrograms(ChildTest):
    """One line and exit code 2."""
    PROGRAMS = {
        "ends at once": ("sys.exit('has no weights')", "ended with exit code 1: has no weights"),
        "prints text": ("os.write(answers.fileno(), b'Loading the model\\n'); signal.pause()",
                        "'Loading the model', which is no header"),
        "other shape": ("next(counted(child.read_ppm))\n"
                        "child.write_depth(answers, np.ones((100, 100)), 'metric_mm'); signal.pause()",
                        "100x100 for a picture of 320x208"),
        "unknown kind": ("child.write_depth(answers, np.ones((208, 320)), 'metres'); signal.pause()",
                         "'320 208 metres', which is no header"),
        "too large": ("os.write(answers.fileno(), b'5000 5000 metric_mm\\n'); signal.pause()",
                      "'5000 5000 metric_mm', which is no header"),
        "half an answer": ("os.write(answers.fileno(), b'320 208 metric_mm\\nabc')",
                           "ended with exit code 0"),
    }

    def test_are_refused(self):
        clip = self.copy_clip()
        for name, (code, problem) in self.PROGRAMS.items():
            with self.subTest(name):
                run = self.run_server("--source", clip, "--depth-from", self.write_program("wrong", code))
                self.assert_refused(run, "--depth-from", problem, "mend")

    def test_an_unknown_command(self):
        run = self.run_server("--source", self.copy_clip(), "--depth-from", "no-such-program --fast")
        self.assert_refused(run, "--depth-from 'no-such-program --fast'", "not found", "mend")

    def test_an_empty_command(self):
        run = self.run_server("--source", self.copy_clip(), "--depth-from", " ")
        self.assert_refused(run, "--depth-from", "is empty")

    def test_more_answers_than_pictures(self):
        wrong = self.write_program("wrong", """
            next(counted(child.read_ppm))
            answer = b"20 13 metric_mm\\n" + np.full((13, 20), 700, "<f4").tobytes()
            os.write(answers.fileno(), 20 * answer)
            signal.pause()
            """)
        run = self.run_server("--source", self.copy_clip(), "--depth-from", wrong)
        said = [each for each in run.warnings + run.errors if "more answers than it received pictures" in each]
        self.assertGreater(len(said), 0, run)
        self.assertIn("--depth-from", said[0])

    def test_a_closed_stdout(self):
        wrong = self.write_program("wrong", "answers.close(); signal.pause()")
        run = self.run_server("--source", self.copy_clip(), "--depth-from", f"exec {wrong}")
        self.assert_refused(run, "--depth-from", "mend")


class DepthCache(ChildTest):
    PLANE = """
        for number, picture in counted(child.read_ppm):
            v, u = np.mgrid[0:208, 0:320]
            hand = np.hypot(u - 167, v - 111) < 40
            child.write_depth(answers, np.where(hand, 650 + 0.1 * u, 900), "metric_mm")
        """

    def setUp(self):
        super().setUp()
        self.cache = self.folder / "cache"
        self.clip = self.copy_clip()
        self.command = self.write_program("plane", self.PLANE)

    def estimate(self, command):
        run = self.run_server("--source", self.clip, "--object", HAND, "--depth-from", command,
                              "--depth-cache", self.cache)
        return self.find_object(run)

    def test_a_second_run_asks_nothing(self):
        first = self.estimate(self.command)
        self.assertEqual(self.count("plane"), 8)
        self.assertEqual(self.estimate(self.command), first)
        self.assertEqual(self.count("plane"), 0)

    def test_another_command_has_its_own_entry(self):
        self.estimate(self.command)
        self.assertEqual(self.count("plane"), 8)
        self.estimate(f"{self.command} --other")
        self.assertEqual(self.count("plane"), 8)
        self.assertEqual(len(list(self.cache.iterdir())), 2)
        self.estimate(self.command)
        self.assertEqual(self.count("plane"), 0)

    def test_a_changed_clip_has_its_own_entry(self):
        self.estimate(self.command)
        self.assertEqual(self.count("plane"), 8)
        file = next((self.clip / "rgb").iterdir())
        os.utime(file, (1, 1))
        self.estimate(self.command)
        self.assertEqual(self.count("plane"), 8)

    def test_damaged_files_are_computed_anew(self):
        first = self.estimate(self.command)
        files = sorted(self.cache.glob("*/*.depth"))
        self.assertEqual(len(files), 8)
        self.assertEqual(self.count("plane"), 8)
        whole = files[0].read_bytes()
        files[0].write_bytes(whole[:len(whole) // 2])
        files[3].write_bytes(b"")
        files[5].write_bytes(os.urandom(len(whole)))
        self.assertEqual(self.estimate(self.command), first)
        self.assertEqual(self.count("plane"), 3)
        self.assertEqual(files[0].read_bytes(), whole)
        self.assertEqual(self.estimate(self.command), first)
        self.assertEqual(self.count("plane"), 0)


class Masks(ChildTest):
    NEAR = """
        for number, (request, picture, depth) in counted(child.read_mask_request):
            mask = (depth > 0) & (depth < 720)
            mask[:96] = mask[124:] = False
            mask[:, :135] = mask[:, 200:] = False
            child.write_mask(answers, mask)
        """

    def make_mask(self, depth):
        """As NEAR."""
        mask = (depth > 0) & (depth < 720)
        mask[:96] = mask[124:] = False
        mask[:, :135] = mask[:, 200:] = False
        return mask

    def segment(self, clip, command, *flags):
        return self.run_server("--source", clip, "--object", HAND, "--mask-from", command, *flags)

    def test_are_kept_in_the_clip(self):
        clip = self.copy_clip()
        near = self.write_program("near", self.NEAR)
        first = self.find_object(self.segment(clip, near))
        self.assertEqual(self.count("near"), 8)
        for file in sorted((clip / "depth").iterdir()):
            expected = self.make_mask(np.asarray(Image.open(file)))
            kept = np.asarray(Image.open(clip / "mask" / file.name))
            self.assertTrue(np.array_equal(kept, expected), file.name)
        self.assertTrue((clip / "mask" / "mask-from.txt").read_text("utf-8").startswith(near + "\n"))
        self.assertEqual(len(list((clip / "mask").iterdir())), 9)

        self.assertEqual(self.find_object(self.segment(clip, near)), first)
        self.assertEqual(self.count("near"), 0, "the second run does not start the program")

        self.assert_refused(self.segment(clip, f"{near} --other"), "--mask-from", "another command")
        self.assert_refused(self.segment(clip, near, "--not", "20,20"), "--mask-from", "other points")
        self.assertEqual(self.count("near"), 0)

    def test_never_replace_those_of_the_author(self):
        clip = self.copy_clip()
        (clip / "mask").mkdir()
        Image.fromarray(np.ones((208, 320), np.uint8)).save(clip / "mask" / "000000.png")
        run = self.segment(clip, self.write_program("near", self.NEAR))
        self.assert_refused(run, "--mask-from", "masks of the clip's author")
        self.assertEqual(len(list((clip / "mask").iterdir())), 1)

    def test_requests_have_picture_depth_and_points(self):
        clip = self.copy_clip()
        keeps = self.write_program("keeps", """
            import json
            for number, (request, picture, depth) in counted(child.read_mask_request):
                name = f"{sys.argv[1]}/{request['frame']}"
                np.savez(name, picture=picture, depth=depth, request=json.dumps(request))
                child.write_mask(answers, None)
            """)
        run = self.segment(clip, f"{keeps} {self.folder}", "--object", "50,60@0.2", "--not", "20,30")
        self.assertEqual(run.code, 0, run)
        self.assertEqual(self.count("keeps"), 8)
        for number in range(8):
            kept = np.load(self.folder / f"{number}.npz")
            request = json.loads(str(kept["request"]))
            self.assertAlmostEqual(request["time_s"], number / 24, 6)
            self.assertEqual((request["width"], request["height"]), (320, 208))
            points = [{"object": 1, "u": 167.0, "v": 111.0, "time_s": 0.0},
                      {"object": 2, "u": 50.0, "v": 60.0, "time_s": 0.2},
                      {"object": 0, "u": 20.0, "v": 30.0, "time_s": 0.0}]
            self.assertEqual(request["points"], points if number >= 5 else [points[0], points[2]])
            name = f"{number:06}.png"
            picture = np.asarray(Image.open(clip / "rgb" / name).convert("RGB"))
            self.assertTrue(np.array_equal(kept["picture"], picture))
            depth = np.asarray(Image.open(clip / "depth" / name)).astype(np.float32)
            self.assertTrue(np.array_equal(kept["depth"], depth))

    def test_every_second_frame_is_enough(self):
        clip = self.copy_clip()
        code = self.NEAR.replace("(answers, mask)", "(answers, None if request['frame'] % 2 else mask)")
        second = self.write_program("second", code)
        run = self.segment(clip, second)
        share, near_mm, far_mm = self.find_object(run)
        self.assertEqual(run.warnings, [])
        self.assertEqual(self.count("second"), 8)
        self.assertTrue(1 < share < 4 and 600 < near_mm < far_mm < 760, run)
        self.assertEqual(sorted(file.name for file in (clip / "mask").glob("*.png")),
                         [f"{number:06}.png" for number in range(0, 8, 2)])
        self.assertEqual(self.find_object(self.segment(clip, second)), [share, near_mm, far_mm])
        self.assertEqual(self.count("second"), 0)

    def test_a_program_that_dies_is_one_warning(self):
        clip = self.copy_clip(12)
        code = self.NEAR + """
            once = pathlib.Path(sys.argv[1])
            if number == 5 and not once.exists():
                once.touch()
                os.kill(os.getpid(), 9)
        """
        run = self.segment(clip, f"{self.write_program('dies', code)} {self.folder}/once")
        self.find_object(run)
        self.assertEqual(len(run.warnings), 1, run)
        self.assertIn("--mask-from", run.warnings[0])
        self.assertGreaterEqual(len(list((clip / "mask").glob("*.png"))), 5)

    def test_wrong_programs_are_refused(self):
        clip = self.copy_clip()
        for name, (code, problem) in {
                "ends at once": ("sys.exit('has no weights')", "ended with exit code 1: has no weights"),
                "other size": ("next(counted(child.read_mask_request))\n"
                               "child.write_mask(answers, np.ones((100, 100))); signal.pause()",
                               "100x100 for a picture of 320x208"),
                "too many objects": ("next(counted(child.read_mask_request))\n"
                                     "child.write_mask(answers, np.full((208, 320), 200)); signal.pause()",
                                     "the value 200"),
                "depth instead": ("child.write_depth(answers, np.ones((208, 320)), 'inverse'); signal.pause()",
                                  "'320 208 inverse', which is no header")}.items():
            with self.subTest(name):
                run = self.segment(clip, self.write_program("wrong", code))
                self.assert_refused(run, "--mask-from", problem, "mend")
        self.assertFalse((clip / "mask").exists())


if __name__ == "__main__":
    if not pathlib.Path(SERVER).exists():
        print(f"left out: {SERVER} was not found: build hapticast-server")
        sys.exit(SKIPPED)
    unittest.main(verbosity=2)
