# SPDX-License-Identifier: MIT
"""A study as a lab runs it: start, answers, results. The group `window` needs Xvfb and xdotool.
It stores its screenshots in STUDY_PICTURES."""

import contextlib
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from programs import CLIENT, SERVER, Program  # pylint: disable=wrong-import-position
from waiting import SOON_S, wait_until  # pylint: disable=wrong-import-position

COLUMNS = ["onset", "duration", "trial_type", "trial", "condition", "comparison_interval", "level",
           "answer", "is_correct", "response_time", "status", "wall_clock"]
# Columns and keys of BIDS 1.9.0, Motion: required ones, and values of the types of channels.
BIDS_CHANNELS = ["name", "component", "type", "tracked_point", "units"]
BIDS_OPTIONAL_CHANNELS = {"placement", "reference_frame", "description", "sampling_frequency", "status",
                          "status_description"}
BIDS_TYPES = {"ACCEL", "ANGACCEL", "GYRO", "JNTANG", "LATENCY", "MAGN", "MISC", "ORNT", "POS", "VEL"}
BIDS_COMPONENTS = {"x", "y", "z", "quat_x", "quat_y", "quat_z", "quat_w", "n/a"}


def make_study(**changes):
    study = {
        "name": "test", "consent": "You touch a ball. You may stop at any time.", "seed": 7, "blocks": 4,
        "training": 1, "question": {"kind": "2afc", "text": "Which one was stiffer?"},
        "comparison": {"variable": "stiffness", "reference": 1, "selection": "quest", "least": 0.02,
                       "most": 1},
        "defaults": {"recording": "ball.mcap", "seconds": 0.05},
        "conditions": [{"name": "still"}, {"name": "jitter", "jitter_ms": 30},
                       {"name": "thesis", "method": "thesis"}]}
    study.update(changes)
    return study


RATING = {"comparison": None, "question": {"kind": "likert", "text": "How real was it?", "steps": 5,
                                           "low": "not at all", "high": "very"}}


class Markers:
    """Receives the lines of --markers."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(SOON_S)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def flags(self):
        return ["--markers", f"127.0.0.1:{self.socket.getsockname()[1]}"]

    def count(self, events, client):
        """Waits until a number of events has come, or the client has ended."""
        left = events

        def is_done():
            nonlocal left
            with contextlib.suppress(BlockingIOError):
                while left > 0 and self.socket.recv(1000, socket.MSG_DONTWAIT):
                    left -= 1
            return left == 0 or client.process.poll() is not None
        wait_until(is_done, lambda: f"{left} of {events} events did not come")

    def wait_for(self, words):
        """Waits for the next event with these words, such as question; returns all lines until then."""
        lines = []
        while not lines or f" {words} " not in lines[-1]:
            lines.append(self.socket.recv(1000).decode())
        return lines


class StudyTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="study"))
        subprocess.run([SERVER, "bake", "synthetic:bounce", "--frames", "40", "-o", cls.folder / "ball.mcap"],
                       check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def write(self, study, name="study.json"):
        study = {key: value for key, value in study.items() if value is not None}
        (self.folder / name).write_text(json.dumps(study, indent=1))

    def command(self, out, *flags, subject="07", study="study.json", simulate="threshold=0.2,lapse=0.02",
                device="virtual"):
        simulated = ["--simulate", simulate, "--view", "off"] if simulate else []
        return [CLIENT, "--study", self.folder / study, "--subject", subject, "--out", self.folder / out,
                "--device", device, *simulated, *flags]

    def start_program(self, command, **options):
        program = Program(*command, **options)
        self.addCleanup(program.stop)
        return program

    def run_client(self, *args, **named):
        return subprocess.run(self.command(*args, **named), capture_output=True, text=True, timeout=10 * SOON_S)

    def complete(self, *args, **named):
        done = self.run_client(*args, **named)
        self.assertEqual(done.returncode, 0, done.stderr)

    def read_rows(self, out, subject="07"):
        file = self.folder / out / f"sub-{subject}/motion/sub-{subject}_task-test_events.tsv"
        lines = file.read_text().splitlines()
        self.assertEqual(lines[0].split("\t"), COLUMNS)
        return [dict(zip(COLUMNS, line.split("\t"))) for line in lines[1:]]


class Run(StudyTest):
    def plan(self, rows):
        """Everything that follows from the seed and the answers."""
        keys = ["trial_type", "trial", "condition", "comparison_interval", "level", "answer", "status"]
        return [tuple(row[key] for key in keys) for row in rows]

    def test_killed_in_random_moments_loses_repeats_and_swaps_no_trial(self):
        wanted = int(os.environ.get("STUDY_KILLS", "6"))
        blocks = 2 + wanted // 3
        self.write(make_study(blocks=blocks))
        whole = self.run_client("whole")
        self.assertEqual(whole.returncode, 0, whole.stderr)
        expected = self.plan(self.read_rows("whole"))
        self.assertEqual(len(expected), 3 * blocks + 1)
        moments, kills = random.Random(20261129), 0
        while kills < wanted:
            begun = (self.folder / "killed/sub-07/motion/sub-07_task-test_events.tsv").exists()
            with Markers() as markers:
                flags = [*(["--resume"] if begun else []), *markers.flags()]
                client = self.start_program(self.command("killed", *flags))
                # A trial has four events. The pauses of the wait make the moment between two of them random.
                markers.count(moments.randrange(8), client)
            if begun and client.process.poll() is not None:
                self.assertEqual(client.process.returncode, 0, client.output())
                break  # complete
            client.stop()
            kills += 1
        rest = self.run_client("killed", "--resume")
        self.assertEqual(rest.returncode, 0, rest.stderr)
        self.assertEqual(self.plan(self.read_rows("killed")), expected)
        print(f"{kills} kills, {len(expected)} trials: the same as without a kill", file=sys.stderr)
        self.assertGreaterEqual(2 * kills, wanted)

    def test_a_signal_ends_with_the_force_at_zero_and_the_rest_waits(self):
        self.write(make_study(**RATING, defaults={"recording": "ball.mcap", "seconds": 1}))
        with Markers() as markers:
            log = self.folder / "signal.csv"
            client = self.start_program(self.command("signal", "--log", log, *markers.flags()))
            markers.wait_for("trial 2 interval")
        self.assertEqual(client.end(signal.SIGTERM), 1)
        self.assertIn("_run-1.mcap is complete", client.output())
        self.assertEqual([float(value) for value in log.read_text().splitlines()[-1].split(",")[5:8]], [0.0] * 3)
        self.assertIn("trials are left: continue with --resume", client.output())
        motion = self.folder / "signal/sub-07/motion/sub-07_task-test_tracksys-haptic_motion.tsv"
        last = motion.read_text().splitlines()[-1].split("\t")
        self.assertEqual([float(value) for value in last[4:7]], [0.0, 0.0, 0.0])

    def test_an_observer_with_a_small_jnd_gets_a_smaller_estimate(self):
        self.write(make_study(blocks=10, conditions=[{"name": "still"}]))
        estimates = []
        for subject, threshold in (("1", 0.04), ("2", 0.8)):
            done = self.run_client("jnd", subject=subject, simulate=f"threshold={threshold}")
            self.assertEqual(done.returncode, 0, done.stderr)
            estimates.append(float(done.stdout.split("JND ")[1].split(",")[0]))
        self.assertLess(3 * estimates[0], estimates[1])

    def test_sends_markers_with_the_time(self):
        self.write(make_study(**RATING, blocks=1))
        with Markers() as markers:
            done = self.run_client("marker", *markers.flags())
            self.assertEqual(done.returncode, 0, done.stderr)
            lines = markers.wait_for("study end")
        self.assertEqual(len(lines), 4 * 3 + 1)
        for line in lines:
            self.assertRegex(line, r"^hapticast sub-07 task-test .* \d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{6}Z\n$")

    def test_the_log_shows_codes_and_no_names(self):
        self.write(make_study(conditions=[{"name": "secretone"}, {"name": "secrettwo"}]))
        done = self.run_client("blind")
        self.assertEqual(done.returncode, 0)
        self.assertNotIn("secret", done.stdout + done.stderr)
        self.assertIn("condition A", done.stderr)

    def test_the_recording_of_the_run_has_the_same_bits(self):
        self.write(make_study(blocks=1))
        self.complete("bits")
        file = next((self.folder / "bits/sourcedata/sub-07").glob("*.mcap"))
        replay = subprocess.run([CLIENT, "--replay", file], capture_output=True, text=True)
        self.assertIn("all forces have the recorded bits", replay.stdout)

    def test_a_server_is_a_source_as_well(self):
        server = self.start_program([SERVER, "--source", "synthetic:bounce", "--listen", "127.0.0.1:0"])
        self.write(make_study(**RATING, blocks=1, training=0, defaults={"seconds": 0.3}, conditions=[
            {"name": "live", "server": server.address()}, {"name": "baked", "recording": "ball.mcap"}]))
        done = self.run_client("live")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([row["status"] for row in self.read_rows("live")], ["valid", "valid"])


class Refusals(StudyTest):
    def refuse(self, study, text, *flags, code=2, out="refused", **named):
        self.write(study)
        done = self.run_client(out, *flags, **named)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(text, done.stderr)
        self.assertFalse((self.folder / out).exists(), "a refused study leaves no folder")

    def test_before_the_first_subject(self):
        self.refuse(make_study(conditions=[{"name": "a", "recording": "none.mcap"}]),
                    "study.json:23:")
        self.refuse(make_study(conditions=[{"name": "a"}, {"name": "a"}]), "two conditions have the name 'a'")
        self.refuse(make_study(blocks=4000), "at most 5000 are possible")
        self.refuse(make_study(), "cannot render", "--stiffness-limit", "0.3")
        self.refuse(make_study(**RATING, conditions=[{"name": "a", "mass_kg": 0.001}]), "the device renders")
        self.refuse(make_study(), "needs a window", simulate=None, out="none")
        self.refuse(make_study(), "is no code", subject="Jane Doe")
        self.refuse(make_study(), "has not begun the study", "--resume")
        (self.folder / "cut.mcap").write_bytes((self.folder / "ball.mcap").read_bytes()[:-40000])
        self.refuse(make_study(conditions=[{"name": "a", "recording": "cut.mcap"}]), "cut.mcap")

    def test_two_runs_for_one_subject(self):
        self.write(make_study(blocks=1))
        self.complete("twice")
        again = self.run_client("twice")
        self.assertEqual(again.returncode, 2)
        self.assertIn("continue with --resume", again.stderr)
        self.assertIn("is complete", self.run_client("twice", "--resume").stderr)
        self.write(make_study(blocks=2))
        other = self.run_client("twice", "--resume")
        self.assertEqual(other.returncode, 2)
        self.assertIn("another study file", other.stderr)

    def test_a_full_disk(self):
        full = self.folder / "full"
        full.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", full], capture_output=True).returncode:
            self.skipTest("needs the right to mount a small disk")
        try:
            self.write(make_study(blocks=100))
            done = self.run_client("full")
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("the disk has", done.stderr)
        finally:
            subprocess.run(["umount", full], check=True)


class Results(StudyTest):
    def test_is_a_dataset_of_bids(self):
        self.write(make_study(blocks=1))
        self.complete("bids")
        out = self.folder / "bids"
        names = sorted(str(file.relative_to(out)) for file in out.rglob("*")
                       if file.is_file() and "sourcedata" not in file.parts)
        start = "sub-07/motion/sub-07_task-test_"
        self.assertEqual(names, sorted([
            "README", "dataset_description.json", "participants.tsv", "sub-07/sub-07_scans.tsv",
            *(start + end for end in ["events.json", "events.tsv", *("tracksys-haptic_" + end for end in [
                "channels.json", "channels.tsv", "motion.json", "motion.tsv"])])]))
        dataset = json.loads((out / "dataset_description.json").read_text())
        self.assertEqual((dataset["BIDSVersion"], dataset["DatasetType"]), ("1.9.0", "raw"))
        self.check_channels(out, start)
        self.check_events(out, start)

    def check_channels(self, out, start):
        lines = (out / (start + "tracksys-haptic_channels.tsv")).read_text().splitlines()
        header = lines[0].split("\t")
        self.assertEqual(header[:5], BIDS_CHANNELS)
        self.assertLessEqual(set(header[5:]), BIDS_OPTIONAL_CHANNELS)
        channels = [dict(zip(header, line.split("\t"))) for line in lines[1:]]
        self.assertLessEqual({row["type"] for row in channels}, BIDS_TYPES)
        self.assertLessEqual({row["component"] for row in channels}, BIDS_COMPONENTS)
        frames = json.loads((out / (start + "tracksys-haptic_channels.json")).read_text())
        self.assertLessEqual({row["reference_frame"] for row in channels} - {"n/a"},
                             set(frames["reference_frame"]["Levels"]))
        motion = json.loads((out / (start + "tracksys-haptic_motion.json")).read_text())
        self.assertEqual((motion["SamplingFrequency"], motion["TaskName"]), (1000, "test"))
        for kind in ("POS", "MISC", "LATENCY"):
            self.assertEqual(motion[kind + "ChannelCount"], sum(row["type"] == kind for row in channels))
        self.assertEqual(motion["MotionChannelCount"], len(channels))
        self.assertEqual(motion["TrackedPointsCount"], len({row["tracked_point"] for row in channels} - {"n/a"}))

    def check_events(self, out, start):
        described = json.loads((out / (start + "events.json")).read_text())
        self.assertLessEqual(set(COLUMNS), set(described))
        rows = self.read_rows("bids")
        self.assertEqual(len(rows), 4)
        self.assertEqual({row["condition"] for row in rows}, set(described["condition"]["Levels"]))
        for before, row in zip(rows, rows[1:]):
            self.assertGreater(float(row["onset"]), float(before["onset"]) + float(before["duration"]))

    def test_pandas_reads_all(self):
        import pandas
        self.write(make_study(blocks=1))
        self.complete("pandas")
        start = self.folder / "pandas/sub-07/motion/sub-07_task-test_"
        channels = pandas.read_csv(f"{start}tracksys-haptic_channels.tsv", sep="\t")
        motion = pandas.read_csv(f"{start}tracksys-haptic_motion.tsv", sep="\t", header=None,
                                 names=list(channels["name"]))
        events = pandas.read_csv(f"{start}events.tsv", sep="\t")
        self.assertFalse(motion.isna().any().any())
        self.assertTrue((motion["latency"].diff().dropna() > 0).all())
        self.assertGreater(motion["latency"].iloc[-1], events["onset"].iloc[-1])
        self.assertTrue(pandas.api.types.is_float_dtype(events["level"]))
        for file, count in ((self.folder / "pandas/participants.tsv", 1),
                            (self.folder / "pandas/sub-07/sub-07_scans.tsv", 1)):
            self.assertEqual(len(pandas.read_csv(file, sep="\t")), count)


    def analyse(self, out, *flags):
        program = pathlib.Path(__file__).resolve().parents[2] / "deploy/studies/analyse.py"
        return subprocess.run([sys.executable, "-B", program, self.folder / out, *flags], capture_output=True,
                              text=True, timeout=10 * SOON_S)

    def test_the_analysis_draws_curve_and_table(self):
        self.write(make_study(blocks=3, conditions=[{"name": "still"}, {"name": "jitter", "jitter_ms": 30}]))
        for subject in ("1", "2"):
            self.complete("analysis", subject=subject)
        done = self.analyse("analysis", "--figure", self.folder / "jnd.png", "--table", self.folder / "jnd.tsv")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [line.split("\t") for line in (self.folder / "jnd.tsv").read_text().splitlines()]
        self.assertEqual(len(rows), 1 + 2 * (2 + 1))  # two subjects and all of them, for each condition
        self.assertGreater((self.folder / "jnd.png").stat().st_size, 10000)
        if "STUDY_PICTURES" in os.environ:
            shutil.copy(self.folder / "jnd.png", os.environ["STUDY_PICTURES"])
        self.assertEqual(self.analyse("nowhere").returncode, 2)

    def test_the_fit_of_the_analysis_finds_the_threshold(self):
        import numpy as np
        sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "deploy/studies"))
        import analyse
        numbers = np.random.default_rng(20261129)
        levels = np.tile([0.05, 0.1, 0.15, 0.2, 0.3, 0.45], 10)
        for slope in (1.3, 2.5):
            right = analyse.compute_correct(levels, 0.18, slope, 0.02)
            fits = [analyse.fit_threshold(levels, numbers.random(60) < right, 0.02) for _ in range(200)]
            ratio = np.median([fit.threshold for fit in fits]) / 0.18
            inside = np.mean([(fit.low or 0.0) <= 0.18 <= (fit.high or 9.0) for fit in fits])
            print(f"slope {slope}: median estimate / threshold {ratio:.3f}, in the interval {inside:.2f}",
                  file=sys.stderr)
            self.assertAlmostEqual(ratio, 1.0, delta=0.1)
            self.assertGreater(inside, 0.85)


class Window(StudyTest):
    """A subject at the window: xdotool presses the keys."""

    def setUp(self):
        if not shutil.which("Xvfb") or not shutil.which("xdotool"):
            self.skipTest("needs Xvfb and xdotool")
        read, write = os.pipe()
        # Without -noreset it refuses a client for a moment after the last one has left.
        self.display = subprocess.Popen(["Xvfb", "-noreset", "-displayfd", str(write), "-screen", "0", "1280x720x24"],
                                        pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            self.environment = {**os.environ, "DISPLAY": ":" + number.readline().strip(),
                                "SDL_VIDEODRIVER": "x11"}
        self.addCleanup(self.display.wait)
        self.addCleanup(self.display.kill)
        self.pictures = pathlib.Path(os.environ.get("STUDY_PICTURES", self.folder / "pictures"))
        self.pictures.mkdir(parents=True, exist_ok=True)
        self.markers = Markers()
        self.addCleanup(self.markers.socket.close)
        self.prompt = b""  # the last one

    def start(self, out):
        """Starts the client, and waits for the consent."""
        self.client = self.start_program(
            self.command(out, "--view", "on", *self.markers.flags(), simulate=None, device="mouse"),
            env=self.environment)
        self.wait_for_prompt()
        return self.client

    def xdo(self, *words):
        subprocess.run(["xdotool", *words], env=self.environment, check=True, timeout=SOON_S, capture_output=True)

    def press(self, *keys):
        for key in keys:
            self.xdo("key", key)

    def grab(self):
        from PIL import ImageGrab
        return ImageGrab.grab(xdisplay=self.environment["DISPLAY"])

    def read_prompt(self):
        """Returns the pixels of the text of the prompt; nothing in a trial, which has no grey text."""
        import numpy
        pixels = numpy.asarray(self.grab().crop((128, 200, 1152, 520)))
        grey, white = ((pixels == value).all(axis=2) for value in (128, 255))
        return (grey | white).tobytes() if numpy.count_nonzero(grey) > 50 else b""

    def wait_for_prompt(self):
        """Waits until a prompt is shown, another one than the last: keys before it have no effect."""
        def is_new():
            seen = self.read_prompt()
            return seen if seen != self.prompt and seen == self.read_prompt() else b""
        self.prompt = wait_until(is_new, lambda: f"no other prompt is shown: {self.client.output()}")

    def save(self, name):
        picture = self.grab()
        picture.save(self.pictures / (name + ".png"))
        return picture

    def wait_for_rows(self, out, count):
        file = self.folder / out / "sub-07/motion/sub-07_task-test_events.tsv"
        wait_until(lambda: file.exists() and len(self.read_rows(out)) >= count, f"{count} rows did not arrive")

    def finish(self, client, picture=None):
        self.go_on(picture)  # after the thanks
        self.assertEqual(client.process.wait(SOON_S), 0, client.output())

    def go_on(self, picture=None):
        """Waits for the next prompt and confirms it."""
        self.wait_for_prompt()
        if picture:
            self.save(picture)
        self.press("Return")

    def begin(self, picture=None):
        """Begins a trial, and waits for its question."""
        self.go_on()
        if picture:
            self.markers.wait_for("interval")
            wait_until(lambda: not self.read_prompt(), "the prompt stays")
            self.save(picture)
        self.markers.wait_for("question")
        self.wait_for_prompt()

    def answer(self, out, rows, keys, picture=None):
        """Begins a trial, waits for its end and answers."""
        self.begin(picture)
        self.press(*keys)
        self.wait_for_rows(out, rows)

    def study(self, **changes):
        self.write(make_study(blocks=1, training=0, rest_every=2,
                              defaults={"recording": "ball.mcap", "seconds": 0.8}, **changes))

    def test_a_rating_study_from_start_to_end(self):
        self.study(**RATING)
        client = self.start("rating")
        consent = self.save("consent")
        self.press("space", "d", "s", "m")  # keys of the normal window: no function in a study
        self.press("1")
        self.answer("rating", 1, ["4"], picture="trial")
        self.begin()
        question = self.save("question")
        self.press("8", "2")  # 8 is no step of this scale
        self.wait_for_rows("rating", 2)
        self.go_on("pause")
        self.answer("rating", 3, ["5"])
        self.finish(client, "thanks")
        self.assertEqual([row["answer"] for row in self.read_rows("rating")], ["4", "2", "5"])
        self.assertNotEqual(consent.tobytes(), question.tobytes())

    def test_a_forced_choice_has_two_intervals_and_a_correct_answer(self):
        self.write(make_study(blocks=2, training=0, defaults={"recording": "ball.mcap", "seconds": 0.5},
                              conditions=[{"name": "still"}]))
        client = self.start("choice")
        self.press("1")
        for rows, key in ((1, "1"), (2, "2")):
            self.begin()
            if rows == 1:
                self.save("choice")
            self.press(key)
            self.wait_for_rows("choice", rows)
        self.finish(client)
        for row, answer in zip(self.read_rows("choice"), "12"):
            self.assertEqual(row["answer"], answer)
            self.assertEqual(row["is_correct"], "1" if row["comparison_interval"] == answer else "0")
            self.assertGreater(float(row["duration"]), 1.5)

    def test_a_scale(self):
        self.study(comparison=None, question={"kind": "vas", "text": "How stiff?", "low": "soft", "high": "hard"})
        client = self.start("vas")
        self.xdo("mousemove", "640", "358")  # the answer "I agree"
        wait_until(lambda: self.grab().getpixel((200, 358))[2] == 250, "the answer is not lit under the mouse")
        self.xdo("click", "1")
        self.answer("vas", 1, ["Right", "Right", "Right", "Return"])
        self.begin()
        self.save("scale")
        self.press("Return")
        self.wait_for_rows("vas", 2)
        self.go_on()  # the pause
        self.answer("vas", 3, ["Left", "Return"])
        self.finish(client)
        self.assertEqual([row["answer"] for row in self.read_rows("vas")], ["56", "50", "48"])

    def test_the_stop_key_makes_the_trial_void_and_it_comes_again(self):
        self.study(**RATING)
        client = self.start("stop")
        self.press("1")
        self.go_on()
        self.markers.wait_for("interval")
        self.press("Escape")
        self.wait_for_prompt()
        self.wait_for_rows("stop", 1)
        self.save("stopped")
        self.press("1")
        for rows in range(2, 4):
            self.answer("stop", rows, ["3"])
            if rows == 2:
                self.go_on()  # the pause
        self.answer("stop", 4, ["3"])
        self.finish(client)
        rows = self.read_rows("stop")
        self.assertEqual([row["status"] for row in rows], ["stopped", "valid", "valid", "valid"])
        self.assertEqual(rows[0]["condition"], rows[3]["condition"])
        self.assertEqual(len({row["condition"] for row in rows[1:]}), 3)

    def test_a_closed_window_ends_the_study(self):
        self.study(**RATING)
        client = self.start("closed")
        self.press("1")
        self.wait_for_prompt()
        self.assertEqual(client.end(signal.SIGTERM), 1)
        self.assertIn("3 trials are left", client.output())


if __name__ == "__main__":
    unittest.main()
