# SPDX-License-Identifier: MIT
"""Tests of the Python package. PYTHONPATH has the package; REFERENCE_RUN is the program beside this
file."""

import gc
import os
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy as np

import hapticast

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from programs import CLIENT, SERVER, Program  # pylint: disable=wrong-import-position
from waiting import SOON_S, wait_until  # pylint: disable=wrong-import-position


def make_disc(height_mm=20.0):
    v, u = np.mgrid[0:100, 0:100]
    inside = np.hypot(u - 49.5, v - 49.5) < 45
    return np.where(inside, height_mm, 0.0).astype(np.float32), inside


def make_frames(count=60, fps=25.0):
    disc = hapticast.Object(*make_disc(), left_px=270, top_px=190)
    return [hapticast.Frame(i / fps, [disc], fps=fps) for i in range(count)]


def press(ticks=1000):
    z = np.maximum(18.0, 40.0 - 0.05 * np.arange(ticks))
    return np.c_[np.zeros(ticks), np.zeros(ticks), z]


def is_touched(log):
    """Returns whether a client's log has 3000 ticks, 600 of them with a force."""
    lines = log.read_text().splitlines()[1:-1] if log.exists() else []
    forces = sum(any(float(force) for force in line.split(",")[5:8]) for line in lines)
    return len(lines) > 3000 and forces > 600


def has_frames(path):
    """Returns whether a recording that is still written has 2 s and 40 frames of a stream, with some to spare."""
    recording = hapticast.Recording(path) if os.path.getsize(path) > 1 << 16 else None
    return bool(recording) and recording.end_ns - recording.start_ns > 3e9 and recording.frame_count > 50


def count_files():
    return len(os.listdir("/proc/self/fd"))


class Rendering(unittest.TestCase):
    def test_has_the_bits_of_the_client(self):
        for seed in range(101, 113):
            with tempfile.NamedTemporaryFile() as file:
                own = {name: text for name, text in os.environ.items() if name != "LD_PRELOAD"}
                subprocess.run([os.environ["REFERENCE_RUN"], str(seed), file.name], check=True, env=own)
                data = file.read()
            at, messages = 4, []
            for _ in range(struct.unpack_from("<I", data)[0]):
                arrival_s, size = struct.unpack_from("<dI", data, at)
                messages.append((arrival_s, data[at + 12:at + 12 + size]))
                at += 12 + size
            ticks = np.frombuffer(data, "<f8", offset=at + 4).reshape(-1, 7)
            out = hapticast.Renderer().run(
                messages, ticks[:, 1:4], begin_s=ticks[0, 0], frame="device")
            self.assertTrue(np.array_equal(out.force_N, ticks[:, 4:7]), f"seed {seed}")
            self.assertGreater(np.count_nonzero(out.contact), 100)

    def test_presses_back(self):
        out = hapticast.Renderer().run(make_frames(), press())
        self.assertGreater(out.force_N[-1, 2], 0.5)
        self.assertAlmostEqual(out.penetration_mm[-1], 2.0, delta=0.3)
        self.assertEqual(out.force_N.shape, (1000, 3))
        self.assertEqual(out.safety_actions.dtype, np.uint32)
        self.assertFalse(out.contact[0])
        self.assertLessEqual(np.linalg.norm(out.force_N, axis=1).max(), 3.3)

    def test_each_run_starts_anew(self):
        renderer, frames = hapticast.Renderer(), make_frames()
        first, second = renderer.run(frames, press()), renderer.run(iter(frames), press())
        self.assertTrue(np.array_equal(first.force_N, second.force_N))

    def test_thesis_and_stiffness(self):
        soft = hapticast.Renderer(stiffness=0.1).run(make_frames(), press())
        stiff = hapticast.Renderer(stiffness=0.5).run(make_frames(), press())
        self.assertGreater(stiff.force_N[-1, 2], 2 * soft.force_N[-1, 2])
        thesis = hapticast.Renderer(method="thesis").run(make_frames(), press())
        self.assertTrue(np.isfinite(thesis.force_N).all())

    def test_wrong_positions(self):
        run = hapticast.Renderer().run
        frames = make_frames(2)
        for error, positions in (
            (ValueError, np.zeros(3)), (ValueError, np.zeros((5, 2))), (TypeError, "here"),
            (TypeError, None), (TypeError, np.array([["a", "b", "c"]])),
        ):
            with self.assertRaises(error) as caught:
                run(frames, positions)
            self.assertNotIn("\n", str(caught.exception))
        self.assertEqual(run(frames, np.zeros((0, 3))).force_N.shape, (0, 3))
        strided = np.asfortranarray(press())[::2]
        self.assertTrue(np.array_equal(run(make_frames(), strided).force_N,
                                       run(make_frames(), strided.copy()).force_N))
        holes = press()
        holes[500:] = np.nan
        self.assertTrue((run(make_frames(), holes).force_N[650:] == 0).all())

    def test_wrong_arguments(self):
        frames = make_frames(2)
        for error, call in (
            (ValueError, lambda: hapticast.Renderer(method="other")),
            (ValueError, lambda: hapticast.Renderer(surface="other")),
            (ValueError, lambda: hapticast.Renderer(stiffness=-1)),
            (TypeError, lambda: hapticast.Renderer(stiffness="hard")),
            (RuntimeError, lambda: hapticast.Renderer(profile="/no/such/file")),
            (ValueError, lambda: hapticast.Renderer().run(frames, press(), dt=0)),
            (ValueError, lambda: hapticast.Renderer().run(frames, press(), dt=float("nan"))),
            (ValueError, lambda: hapticast.Renderer().run(frames[::-1], press())),
            (TypeError, lambda: hapticast.Renderer().run([1, 2], press())),
            (TypeError, lambda: hapticast.Renderer().run(7, press())),
            (RuntimeError, lambda: hapticast.Renderer().run([(0.0, b"")], press())),
            (RuntimeError, lambda: hapticast.Renderer().run([(0.0, b"GET / HTTP/1.1")], press())),
            (ValueError, lambda: hapticast.Object(np.zeros(3))),
            (ValueError, lambda: hapticast.Object(np.zeros((3, 3)), np.zeros((2, 3)))),
            (TypeError, lambda: hapticast.Object(np.zeros((3, 3)), colour="red")),
            (ValueError, lambda: hapticast.Object(np.zeros((3, 3)), left_px=-1)),
            (ValueError, lambda: hapticast.Object(np.zeros((3, 3)), id=2**40)),
            (ValueError, lambda: hapticast.Object(np.zeros((3, 3)), material={"taste": 1})),
            (ValueError, lambda: hapticast.Frame(0, [], size=(-4, 4))),
        ):
            with self.assertRaises(error) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))
        for heights in (np.full((9, 9), np.nan), np.full((9, 9), 1e9), np.zeros((0, 0))):
            frame = hapticast.Frame(0, [hapticast.Object(heights, np.ones(heights.shape))])
            with self.assertRaises(ValueError):
                hapticast.Renderer().run([frame], press(10))

    def test_threads_share_a_renderer(self):
        renderer, frames, results = hapticast.Renderer(), make_frames(), []
        threads = [threading.Thread(target=lambda: results.append(
            renderer.run(frames, press()).force_N)) for _ in range(4)]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
        self.assertTrue(all(np.array_equal(results[0], each) for each in results[1:]))


class Publishing(unittest.TestCase):
    def test_a_frame_arrives(self):
        heights, inside = make_disc()
        with hapticast.Publisher(0, host="127.0.0.1", name="disc") as publisher:
            stream = hapticast.Stream(f"127.0.0.1:{publisher.port}")
            self.assertEqual(stream.info["name"], "disc")
            publisher.publish(heights, inside, left_px=270, top_px=190, id=7,
                              velocity_mm_s=(1, 2, 3), impacts=[(0.5, (0, 0, 9))],
                              material={"stiffness_N_mm": 0.25})
            frame = stream.next(timeout=SOON_S)
            (disc,) = frame.objects
            self.assertEqual((disc.id, disc.rect[:2]), (7, (270, 190)))
            self.assertLessEqual(np.abs(disc.height_mm - heights)[inside].max(), 0.0201)
            self.assertTrue(np.array_equal(disc.mask, inside))
            self.assertTrue(np.allclose(disc.velocity_mm_s, (1, 2, 3)))
            self.assertAlmostEqual(disc.material["stiffness_N_mm"], 0.25)
            self.assertEqual(len(disc.impacts), 1)
            with self.assertRaises(ValueError):
                disc.height_mm[0, 0] = 1  # read-only: other frames share it
        self.assertEqual(list(stream), [])  # the goodbye ends the stream
        with self.assertRaises(RuntimeError):
            publisher.publish(heights)

    def test_heights_outlive_their_frame(self):
        with hapticast.Publisher(0, host="127.0.0.1") as publisher:
            stream = hapticast.Stream(f"127.0.0.1:{publisher.port}")
            publisher.publish(*make_disc())
            heights = stream.next(timeout=SOON_S).objects[0].height_mm
            stream.close()
            del stream
            gc.collect()
            self.assertAlmostEqual(float(heights[50, 50]), 20.0, delta=0.03)

    def test_nobody_reads(self):
        with hapticast.Publisher(0, host="127.0.0.1") as publisher:
            stream = hapticast.Stream(f"127.0.0.1:{publisher.port}", max_waiting=3)
            reader = hapticast.Stream(f"127.0.0.1:{publisher.port}")
            for _ in range(20):
                publisher.publish(*make_disc())
                self.assertIsNotNone(reader.next(timeout=SOON_S))
            wait_until(lambda: stream.dropped >= 10, lambda: f"{stream.dropped} are dropped")
            self.assertIsNone(reader.next(timeout=0.01))

    def test_stream_in_real_time(self):
        with hapticast.Publisher(0, host="127.0.0.1") as publisher:
            stream = hapticast.Stream(f"127.0.0.1:{publisher.port}")
            done = threading.Event()

            def publish():
                while not done.wait(0.04):
                    publisher.publish(*make_disc(), left_px=270, top_px=190)

            thread = threading.Thread(target=publish)
            thread.start()
            try:
                out = hapticast.Renderer().run(stream, press(3000))
            finally:
                done.set()
                thread.join()
            self.assertTrue(out.contact[-1000:].any())
            with self.assertRaises(ValueError):  # a second renderer
                hapticast.Renderer().run(stream, press(1))

    def test_wrong_arguments(self):
        with hapticast.Publisher(0, host="127.0.0.1") as publisher:
            for error, call in (
                (ValueError, lambda: hapticast.Publisher(-1)),
                (TypeError, lambda: hapticast.Publisher("http")),
                (ValueError, lambda: hapticast.Publisher(0, size=(0, 9))),
                (ValueError, lambda: hapticast.Publisher(0, fps=1e9)),
                (TypeError, lambda: hapticast.Publisher(0, colour="red")),
                (RuntimeError, lambda: hapticast.Publisher(publisher.port, host="127.0.0.1")),
                (RuntimeError, lambda: hapticast.Publisher(0, tls_cert_file="/none", tls_key_file="/none")),
                (RuntimeError, lambda: hapticast.Stream("127.0.0.1:1")),
                (ValueError, lambda: hapticast.Stream("a b")),
                (TypeError, lambda: hapticast.Stream(7447)),
                (ValueError, lambda: hapticast.Stream("127.0.0.1", max_waiting=0)),
                (TypeError, lambda: hapticast.Stream("127.0.0.1", colour="red")),
                (ValueError, lambda: publisher.publish(np.zeros((9, 9)), np.ones((3, 3)))),
                (ValueError, lambda: publisher.publish(np.zeros((2000, 2000)))),
                (ValueError, lambda: publisher.publish(np.zeros((9, 9)), velocity_mm_s=(1, 2))),
            ):
                with self.assertRaises(error) as caught:
                    call()
                self.assertNotIn("\n", str(caught.exception))
            with self.assertRaises(ValueError):
                publisher.publish(np.full((9, 9), np.nan), np.ones((9, 9)))
            publisher.publish(*make_disc())  # and it still works

    def test_fork(self):
        with hapticast.Publisher(0, host="127.0.0.1") as publisher:
            stream = hapticast.Stream(f"127.0.0.1:{publisher.port}")
            child = os.fork()
            if child == 0:
                code = 1
                try:
                    stream.next(timeout=1)
                except RuntimeError:
                    try:
                        publisher.publish(*make_disc())
                    except RuntimeError:
                        code = 0
                del stream, publisher
                os._exit(code)
            self.assertEqual(os.waitpid(child, 0)[1], 0)
            publisher.publish(*make_disc())
            self.assertIsNotNone(stream.next(timeout=SOON_S))

    def test_close_wakes_a_reader(self):
        with hapticast.Publisher(0, host="127.0.0.1") as publisher:
            stream = hapticast.Stream(f"127.0.0.1:{publisher.port}")
            closer = threading.Timer(0.2, stream.close)
            closer.start()
            self.assertIsNone(stream.next())
            closer.join()
            self.assertEqual(list(stream), [])

    def test_ctrl_c(self):
        code = ("import hapticast\np = hapticast.Publisher(0, host='127.0.0.1')\n"
                "s = hapticast.Stream(f'127.0.0.1:{p.port}')\nprint('ready', flush=True)\ns.next()")
        with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE) as child:
            self.assertEqual(child.stdout.readline(), b"ready\n")
            child.send_signal(signal.SIGINT)
            error = child.communicate(timeout=SOON_S)[1]
        self.assertIn(b"KeyboardInterrupt", error)

    def test_opens_leak_nothing(self):
        # A close with a viewer lasts up to a second, so one publisher has all streams.
        with hapticast.Publisher(0, host="127.0.0.1") as publisher:
            def open_once():
                with hapticast.Stream(f"127.0.0.1:{publisher.port}", max_waiting=2) as stream:
                    publisher.publish(*make_disc())
                    self.assertIsNotNone(stream.next(timeout=SOON_S))
                hapticast.Publisher(0, host="127.0.0.1").close()

            files = count_files()
            for _ in range(50):
                open_once()
            self.wait_for_files(files)
            memory_kB = self.memory_kB()
            for _ in range(1000):
                open_once()
            self.wait_for_files(files)
            if "ASAN_OPTIONS" not in os.environ:  # ASan keeps freed memory
                self.assertLess(self.memory_kB() - memory_kB, 5_000)

    @staticmethod
    def wait_for_files(most):
        """Waits until the publisher has closed the connections that their viewers have left."""
        wait_until(lambda: count_files() <= most + 2, lambda: f"{count_files()} files are open")

    @staticmethod
    def memory_kB():
        gc.collect()
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * 4


class Recordings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """Records a server and a client that touches it for 3000 ticks. A busy server leaves frames out."""
        cls.folder = tempfile.TemporaryDirectory()
        own = {name: text for name, text in os.environ.items() if name != "LD_PRELOAD"}
        cls.server, cls.client = (os.path.join(cls.folder.name, name)
                                  for name in ("server.mcap", "client.mcap"))
        server = Program(SERVER, "--source", "synthetic:bounce", "--loop", "--listen", "127.0.0.1:0",
                         "--map-range", "520,620", "--record", cls.server, env=own)
        cls.addClassCleanup(server.stop)
        log = pathlib.Path(cls.folder.name, "log.csv")
        client = Program(CLIENT, server.address(), "--device", "virtual", "--hand", "press", "--view", "off",
                         "--log", log, "--record", cls.client, env=own)
        cls.addClassCleanup(client.stop)
        wait_until(lambda: is_touched(log), lambda: "the client touches nothing")
        for path in (cls.server, cls.client):
            wait_until(lambda: has_frames(path), lambda: f"{path} has too few frames")
        for program in (client, server):
            if program.end() != 0:
                raise AssertionError(program.output())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def write(self, name, data):
        path = os.path.join(self.folder.name, name)
        with open(path, "wb") as file:
            file.write(data)
        return path

    @staticmethod
    def read(path):
        with open(path, "rb") as file:
            return file.read()

    def test_has_the_content(self):
        for path, kind in ((self.server, "server"), (self.client, "client")):
            recording = hapticast.Recording(path)
            self.assertEqual(recording.kind, kind)
            self.assertEqual(recording.problem, "")
            self.assertEqual(recording.description["size"], (640, 480))
            self.assertGreater(recording.end_ns - recording.start_ns, 2e9)
            frames = list(recording.frames())
            self.assertGreater(len(frames), 40)
            self.assertEqual(recording.frame_count, len(frames))
            self.assertEqual(frames[0].info, recording.description)
            self.assertTrue(all(frame.objects[0].height_mm.max() > 1 for frame in frames))
            times = [frame.time_s for frame in frames]
            self.assertEqual(sorted(times), times)
        pictures = [frame.jpeg for frame in hapticast.Recording(self.server).frames()]
        self.assertTrue(all(jpeg.startswith(b"\xff\xd8") for jpeg in pictures))

    def test_ticks(self):
        recording = hapticast.Recording(self.client)
        ticks = recording.ticks()
        self.assertEqual(ticks.shape, (recording.tick_count,))
        self.assertGreater(len(ticks), 2500)
        self.assertTrue(np.array_equal(ticks["tick"], np.arange(1, len(ticks) + 1)))
        self.assertEqual(ticks["force_N"].shape, (len(ticks), 3))
        strength = np.linalg.norm(ticks["force_N"], axis=1)
        self.assertGreater(strength.max(), 0.5)
        self.assertLessEqual(strength.max(), 3.31)
        self.assertGreater(np.count_nonzero(ticks["contact"]), 500)
        self.assertTrue((ticks["penetration_mm"][~ticks["contact"]] == 0).all())
        self.assertIn("interpolated", {hapticast.lookups[i] for i in np.unique(ticks["lookup"])})
        self.assertEqual(hapticast.faults[0], "none")
        half_ns = (recording.start_ns + recording.end_ns) // 2
        later = recording.ticks(start_ns=half_ns)
        self.assertTrue(np.array_equal(later, ticks[-len(later):]))
        self.assertGreaterEqual(later["time_s"][0], 1e-9 * half_ns - 1e-6)
        self.assertEqual(hapticast.Recording(self.server).ticks().shape, (0,))

    def test_two_iterations_and_a_seek(self):
        recording = hapticast.Recording(self.server)
        first, second = recording.frames(), recording.frames()
        together = [(a.time_s, b.time_s) for a, b in zip(first, second)]
        self.assertEqual(len(together), recording.frame_count)
        self.assertTrue(all(a == b for a, b in together))
        self.assertEqual(list(first), [])  # it has ended
        later = list(recording.frames(start_ns=int(1e9 * together[30][0])))
        self.assertLessEqual(abs(len(later) - len(together) + 30), 1)
        self.assertIsNotNone(later[0].objects[0].height_mm)

    def test_renders(self):
        frames = list(hapticast.Recording(self.server).frames())
        ball = np.array([frame.objects[0].position_mm for frame in frames])
        top_mm = max(frame.objects[0].height_mm.max() for frame in frames)
        ticks = np.arange(2000)
        at_s, times_s = frames[0].time_s + 1e-3 * ticks, [frame.time_s for frame in frames]
        hand = np.c_[np.interp(at_s, times_s, ball[:, 0]), np.interp(at_s, times_s, ball[:, 1]),
                     np.maximum(top_mm - 4, 45 - 0.05 * ticks)]
        recorded = hapticast.Renderer().run(hapticast.Recording(self.server), hand)
        self.assertTrue(recorded.contact.any())
        self.assertGreater(np.linalg.norm(recorded.force_N, axis=1).max(), 0.1)
        for again in (frames, hapticast.Recording(self.server).frames()):
            out = hapticast.Renderer().run(again, hand)
            self.assertTrue(np.array_equal(out.force_N, recorded.force_N))

    def test_the_file_of_a_killed_program(self):
        whole, data = list(hapticast.Recording(self.client).frames()), self.read(self.client)
        cut = hapticast.Recording(self.write("cut.mcap", data[:len(data) * 2 // 3]))
        frames = list(cut.frames())
        self.assertTrue(0 < len(frames) < len(whole))
        self.assertEqual([f.time_s for f in frames], [f.time_s for f in whole[:len(frames)]])
        self.assertEqual(cut.frame_count, len(frames))
        self.assertEqual(cut.tick_count, len(cut.ticks()))
        self.assertIn("cut off", cut.problem)
        flipped = bytearray(data)
        flipped[len(data) // 2] ^= 1
        self.assertIn("checksum", hapticast.Recording(self.write("flipped.mcap", flipped)).problem)

    def test_other_files(self):
        def record(code, content):
            return struct.pack("<BQ", code, len(content)) + content

        def text(value):
            return struct.pack("<I", len(value)) + value.encode()

        other = self.write("other.mcap", b"\x89MCAP0\r\n" + record(1, text("") + text("")) +
                           record(4, struct.pack("<HH", 1, 0) + text("/a") + text("json") + bytes(4)) +
                           record(5, struct.pack("<HIQQ", 1, 0, 5, 5) + b"{}"))
        plain = self.write("plain.mcap", b"text")
        for error, call, words in (
            (RuntimeError, lambda: hapticast.Recording("/no/such.mcap"), "No such file"),
            (RuntimeError, lambda: hapticast.Recording(self.folder.name), "is no MCAP file"),
            (RuntimeError, lambda: hapticast.Recording(plain), "is no MCAP file"),
            (RuntimeError, lambda: hapticast.Recording(other), "no channel /frame or /tick"),
            (TypeError, lambda: hapticast.Recording(7), "int"),
            (TypeError, lambda: hapticast.Recording(), "file"),
            (TypeError, lambda: hapticast.Recording(self.server).frames(start_ns=0.5), "start_ns"),
            (ValueError, lambda: hapticast.Recording(self.server).ticks(start_ns=2**70), "start_ns"),
        ):
            with self.assertRaises(error) as caught:
                call()
            self.assertIn(words, str(caught.exception))

    def test_frames_outlive_their_recording(self):
        with hapticast.Recording(pathlib.Path(self.server)) as recording:
            frames = recording.frames()
            count = recording.frame_count
        for use in (recording.frames, recording.ticks, lambda: recording.problem):
            with self.assertRaises(RuntimeError):
                use()
        recording.close()  # a second time
        del recording
        gc.collect()
        heights = next(frames).objects[0].height_mm
        self.assertEqual(len(list(frames)), count - 1)
        del frames
        gc.collect()
        self.assertGreater(float(heights.max()), 1.0)

    def test_threads_share_an_iteration(self):
        recording, seen = hapticast.Recording(self.server), []
        frames = recording.frames()
        threads = [threading.Thread(target=lambda: seen.extend(f.time_s for f in frames))
                   for _ in range(4)]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
        self.assertEqual(sorted(seen), [frame.time_s for frame in recording.frames()])

    def test_opens_leak_nothing(self):
        recording, files = hapticast.Recording(self.client), count_files()
        for _ in range(100):
            next(recording.frames())
            recording.ticks()
        gc.collect()
        self.assertEqual(count_files(), files)


class Seeing(unittest.TestCase):
    def test_frames_of_a_source(self):
        source = hapticast.open("synthetic:bounce")
        self.assertEqual(source.info["size"], (640, 480))
        frames = []
        for frame in source.frames():
            frames.append(frame)
            if len(frames) == 40:
                break  # half-way
        self.assertTrue(any(frame.objects for frame in frames))
        self.assertEqual(sorted(f.time_s for f in frames), [f.time_s for f in frames])
        z = np.maximum(5.0, 45.0 - 0.05 * np.arange(1200))
        centre = frames[-1].objects[0].position_mm
        at = np.c_[np.full(1200, centre[0]), np.full(1200, centre[1]), z]
        self.assertTrue(np.isfinite(hapticast.Renderer().run(frames, at).force_N).all())

    def test_images_of_ones_own(self):
        vision = hapticast.Vision(30, (320, 240), camera=(333, 333, 160, 120),
                                  object=(100, 120))
        v, u = np.mgrid[0:240, 0:320]
        rgb = np.full((240, 320, 3), 90, np.uint8)
        frames = []
        for i in range(30):
            radius = np.hypot(u - 100 - 2 * i, v - 120) / 45
            ball = radius < 1
            depth = np.full((240, 320), 1400.0)
            depth[ball] = 1135 - 135 * np.sqrt(1 - radius[ball] ** 2)
            picture = rgb.copy()
            picture[ball] = 200
            frame = vision.push(picture, depth)
            if frame:
                frames.append(frame)
        frames += vision.flush()
        self.assertEqual(len(frames), 30)
        self.assertGreater(frames[20].objects[0].velocity_mm_s[0], 10)

    def test_wrong_images(self):
        vision = hapticast.Vision(25, (64, 48))
        rgb, depth = np.zeros((48, 64, 3), np.uint8), np.full((48, 64), 1000.0)
        for error, call in (
            (ValueError, lambda: vision.push(rgb, depth[:10])),
            (ValueError, lambda: vision.push(rgb[:, :, :2], depth)),
            (ValueError, lambda: vision.push(rgb[:10, :10], depth[:10, :10])),
            (ValueError, lambda: vision.push(rgb, np.full((48, 64), np.nan))),
            (TypeError, lambda: vision.push(rgb, "far")),
            (TypeError, lambda: vision.push(None, depth)),
            (ValueError, lambda: vision.push(rgb, depth, np.zeros((2, 2)))),
            (ValueError, lambda: vision.push(rgb, depth, time_s=float("nan"))),
            (ValueError, lambda: hapticast.Vision(25, (64, 48), object=(900, 900))),
            (ValueError, lambda: hapticast.Vision(0, (64, 48))),
            (ValueError, lambda: hapticast.Vision(25, (64, 48), fov_deg=500)),
            (TypeError, lambda: hapticast.Vision(25, (64, 48), colour="red")),
            (RuntimeError, lambda: hapticast.open("/no/such/clip")),
            (TypeError, lambda: hapticast.open(7)),
        ):
            with self.assertRaises(error) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))
        vision.push(rgb, depth)  # and it still works


if __name__ == "__main__":
    unittest.main()
