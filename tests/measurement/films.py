"""Films of simulated pendulums, rendered frame by frame: what a camera sees of a bob on a rod, and what spoils it."""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

GRAVITY = 9.81
SUBFRAMES = 4  # of an exposure, for the blur of motion


class Scene(NamedTuple):
    """A pendulum before a camera; lengths in px of the picture, angles in rad."""

    omega: float = 2 * np.pi / 1.3  # rad/s
    damping: float = 0.02  # viscous: its amplitude falls as exp(-damping * omega * t)
    release: float = 0.5
    seconds: float = 12.0
    rate: float = 30.0  # frames a second
    size: tuple[int, int] = (640, 360)
    length: float = 250.0
    bob: float = 14.0  # radius
    exposure: float = 0.5  # of the time between frames
    pitch: float = 0.0  # the camera looks up from below by this angle
    yaw: float = 0.0  # the camera looks from the side by this angle
    shine: float = 0.0  # share by which the bob looks larger at 0.5 rad than in the middle, by area
    stand: tuple[int, int] = (0, 0)  # from and to where in x something stands before the bob
    hand: float = 0.0  # s for which a hand moves through the picture
    noise: float = 3.0  # of a pixel, of 255
    codec: str = "mp4v"
    seed: int = 1


def swing(scene, times):
    """The angles of the scene's pendulum at these times: sine restoring, viscous damping, released at rest."""
    fine = solve_ivp(
        lambda _, s: (s[1], -2 * scene.damping * scene.omega * s[1] - scene.omega**2 * np.sin(s[0])),
        (0, float(np.max(times)) + 0.01),
        (scene.release, 0.0),
        rtol=1e-9,
        atol=1e-10,
        dense_output=True,
    )
    return fine.sol(np.asarray(times))[0]


def seen(scene, angle, along=1.0):
    """Where a camera far away sees a point of the rod, as a share of its length: x, y in px."""
    pivot = scene.size[0] / 2, scene.size[1] / 2 - 0.6 * scene.length
    across, down = along * scene.length * np.sin(angle), along * scene.length * np.cos(angle)
    far = 8 * scene.length
    toward = across * np.sin(scene.yaw) + down * np.sin(scene.pitch)
    shrink = far / (far + toward)
    return pivot[0] + shrink * across * np.cos(scene.yaw), pivot[1] + shrink * down * np.cos(scene.pitch)


def render(path, scene, times=None, angles=None):
    """The film of a scene written to ``path``: its frames' angles. ``angles`` of sub-frames are another motion than the swing."""
    import cv2

    draws = np.random.default_rng(scene.seed)
    frames = np.arange(int(scene.seconds * scene.rate)) / scene.rate if times is None else times
    offsets = (np.arange(SUBFRAMES) + 0.5) / SUBFRAMES * scene.exposure / scene.rate
    inside = frames[:, None] + offsets - offsets.mean() + offsets.max()
    moved = swing(scene, inside.ravel()).reshape(inside.shape) if angles is None else angles(inside)
    width, height = scene.size
    wall = 150 + 40 * np.sin(np.arange(width) / 90)[None, :, None] + 20 * np.cos(np.arange(height) / 60)[:, None, None]  # fmt: skip
    wall = np.ascontiguousarray(np.broadcast_to(wall, (height, width, 3)).astype(np.uint8))
    grain = [
        draws.normal(0, scene.noise, (height, width, 1)) for _ in range(7)
    ]  # drawn anew for each frame it takes too long
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*scene.codec), scene.rate, scene.size)
    for k, time in enumerate(frames):
        exposed = np.zeros((height, width, 3), np.float32)
        for angle in moved[k]:
            picture = wall.copy()
            _draw(cv2, picture, scene, angle)
            exposed += picture
        exposed /= SUBFRAMES
        if time < scene.hand:
            _hand(cv2, exposed, scene, time)
        left, right = scene.stand
        exposed[:, left:right] = (70, 75, 80)
        noisy = exposed + np.roll(grain[k % 7], int(draws.integers(width)), axis=1)
        writer.write(np.clip(noisy, 0, 255).astype(np.uint8))
    writer.release()
    return moved.mean(axis=1)


def _draw(cv2, picture, scene, angle):
    shift = 6
    ends = [tuple(int(round(v * 2**shift)) for v in seen(scene, angle, along)) for along in (0.0, 1.0)]
    cv2.line(picture, *ends, (90, 90, 90), 1, cv2.LINE_AA, shift)
    grown = np.sqrt(1 + scene.shine * abs(angle) / 0.5)
    cv2.circle(picture, ends[1], int(grown * scene.bob * 2**shift), (30, 40, 160), -1, cv2.LINE_AA, shift)


def _hand(cv2, picture, scene, time):
    """An arm that comes in from the side, waves and leaves."""
    width, height = scene.size
    reach = 0.45 * width * np.sin(np.pi * time / scene.hand) + 15 * np.sin(9 * time)
    cv2.line(picture, (0, int(0.75 * height)), (int(reach), int(0.55 * height + 20 * np.sin(5 * time))), (140, 170, 210), 40)  # fmt: skip
