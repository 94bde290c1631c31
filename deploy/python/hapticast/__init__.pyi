# SPDX-License-Identifier: MIT
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import TracebackType
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Method = Literal["hapticast", "thesis"]
Point = tuple[float, float]

safety_actions: tuple[str, ...]
"""Names of the bits of Ticks.safety_actions, bit 0 first."""

lookups: tuple[str, ...]
"""Names of the values of `lookup` in Recording.ticks()."""
faults: tuple[str, ...]
"""Names of the values of `fault` in Recording.ticks()."""

class Object:
    def __init__(
        self, height_mm: ArrayLike, mask: ArrayLike | None = None, *, left_px: int = 0,
        top_px: int = 0, id: int = 1, layer: int = 0, position_mm: ArrayLike = ...,
        velocity_mm_s: ArrayLike = ..., acceleration_mm_s2: ArrayLike = ..., angle_rad: float = 0.0,
        angular_velocity_rad_s: float = 0.0, impacts: Sequence[tuple[float, ArrayLike]] = ...,
        material: Mapping[str, float] = ...,
    ) -> None: ...
    @property
    def id(self) -> int: ...
    @property
    def layer(self) -> int: ...
    @property
    def height_mm(self) -> NDArray[np.float32] | None: ...
    @property
    def mask(self) -> NDArray[np.bool_] | None: ...
    @property
    def rect(self) -> tuple[int, int, int, int] | None:
        """left, top, width, height of height_mm in the picture, px."""
    @property
    def position_mm(self) -> NDArray[np.float64]: ...
    @property
    def velocity_mm_s(self) -> NDArray[np.float64]: ...
    @property
    def acceleration_mm_s2(self) -> NDArray[np.float64]: ...
    @property
    def angle_rad(self) -> float: ...
    @property
    def angular_velocity_rad_s(self) -> float: ...
    @property
    def quality(self) -> float: ...
    @property
    def visible_fraction(self) -> float: ...
    @property
    def impacts(self) -> list[tuple[float, NDArray[np.float64]]]:
        """Pairs of time_s and delta_velocity_mm_s."""
    @property
    def material(self) -> dict[str, float]: ...

class Frame:
    def __init__(
        self, time_s: float, objects: Sequence[Object], size: tuple[int, int] = (640, 480),
        fps: float = 25.0,
    ) -> None: ...
    @property
    def id(self) -> int: ...
    @property
    def epoch(self) -> int: ...
    @property
    def time_s(self) -> float: ...
    @property
    def objects(self) -> list[Object]: ...
    @property
    def info(self) -> dict[str, Any]: ...
    @property
    def jpeg(self) -> bytes:
        """The picture; empty if there is none."""

class Stream:
    def __init__(
        self, address: str = "localhost:7447", *, token: str = "", tls: bool = False,
        tls_ca_file: str = "", insecure: bool = False, udp: bool = False, pictures: bool = False,
        reconnect: bool = False, max_waiting: int = 64, timeout: float = 5.0,
        method: Method = "hapticast",
    ) -> None: ...
    def next(self, timeout: float | None = None) -> Frame | None: ...
    def close(self) -> None: ...
    def __iter__(self) -> Iterator[Frame]: ...
    def __next__(self) -> Frame: ...
    def __enter__(self) -> Stream: ...
    def __exit__(self, *error: type[BaseException] | BaseException | TracebackType | None) -> None: ...
    @property
    def info(self) -> dict[str, Any]: ...
    @property
    def connected(self) -> bool: ...
    @property
    def ended(self) -> bool:
        """True if next() has no more frames."""
    @property
    def dropped(self) -> int: ...

class Recording:
    def __init__(self, file: str | os.PathLike[str]) -> None: ...
    def frames(self, start_ns: int | None = None) -> Iterator[Frame]: ...
    def ticks(self, start_ns: int | None = None) -> NDArray[np.void]:
        """A structured array; help(Recording.ticks) lists its fields."""
    def close(self) -> None: ...
    def __enter__(self) -> Recording: ...
    def __exit__(self, *error: type[BaseException] | BaseException | TracebackType | None) -> None: ...
    @property
    def kind(self) -> Literal["server", "client"]: ...
    @property
    def start_ns(self) -> int: ...
    @property
    def end_ns(self) -> int: ...
    @property
    def description(self) -> dict[str, Any] | None: ...
    @property
    def frame_count(self) -> int: ...
    @property
    def tick_count(self) -> int: ...
    @property
    def picture_count(self) -> int: ...
    @property
    def problem(self) -> str:
        """Why the file ends early; an empty text: it does not."""

class Ticks(Protocol):
    """Result of Renderer.run(): an element or a row for each tick."""

    time_s: NDArray[np.float64]
    play_time_s: NDArray[np.float64]
    force_N: NDArray[np.float64]
    static_force_N: NDArray[np.float64]
    dynamic_force_N: NDArray[np.float64]
    penetration_mm: NDArray[np.float64]
    height_mm: NDArray[np.float64]
    hip_mm: NDArray[np.float64]
    contact: NDArray[np.bool_]
    halted: NDArray[np.bool_]
    safety_actions: NDArray[np.uint32]

class Renderer:
    def __init__(
        self, profile: str = "omni", method: Method = "hapticast", stiffness: float | None = None,
        surface: Literal["proxy", "normal", "perturbed"] = "proxy",
    ) -> None: ...
    def run(
        self, frames: Stream | Recording | Iterable[Frame] | Iterable[tuple[float, bytes]],
        positions_mm: ArrayLike, dt: float = 1e-3, begin_s: float | None = None,
        frame: Literal["nominal", "device"] = "nominal",
    ) -> Ticks: ...

class Publisher:
    def __init__(
        self, port: int = 7447, size: tuple[int, int] = (640, 480), fps: float = 25.0, *,
        name: str = "", host: str = "[::]", udp: bool = True, tls_cert_file: str = "",
        tls_key_file: str = "", tokens_file: str = "", max_viewers: int = 64,
    ) -> None: ...
    def publish(
        self, height_mm: ArrayLike | Frame, mask: ArrayLike | None = None,
        time_s: float | None = None, **properties: Any,
    ) -> float: ...
    def close(self) -> None: ...
    def __enter__(self) -> Publisher: ...
    def __exit__(self, *error: type[BaseException] | BaseException | TracebackType | None) -> None: ...
    @property
    def port(self) -> int: ...
    @property
    def viewers(self) -> int: ...
    @property
    def now(self) -> float: ...

class Vision:
    def __init__(
        self, fps: float, size: tuple[int, int],
        camera: tuple[float, float, float, float] | None = None, *,
        object: Point | list[Point] | None = None, not_object: Point | list[Point] | None = None,
        method: Method = "hapticast", motion: bool = True, low_latency: bool = False,
        pictures: bool = False, map_range: Point = ..., fov_deg: float = ..., stiffness_N_mm: float = ...,
        mass_kg: float = ...,
    ) -> None: ...
    def push(
        self, rgb: ArrayLike, depth: ArrayLike, mask: ArrayLike | None = None,
        time_s: float | None = None,
    ) -> Frame | None: ...
    def flush(self) -> list[Frame]: ...
    @property
    def info(self) -> dict[str, Any]: ...

class Images(Protocol):
    rgb: NDArray[np.uint8] | None
    depth: NDArray[np.float32]
    mask: NDArray[np.uint8] | None
    time_s: float
    epoch: int

class Source:
    def __iter__(self) -> Iterator[Images]: ...
    def __next__(self) -> Images: ...
    def rewind(self) -> None: ...
    def frames(self, **options: Any) -> Iterator[Frame]:
        """Iterates over the frames that Vision makes. Options: those of Vision."""
    @property
    def info(self) -> dict[str, Any]: ...

def open(source: str, fps: float = 0.0) -> Source: ...
