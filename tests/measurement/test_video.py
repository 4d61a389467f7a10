"""A film of a pendulum: the bob is followed, and its period and damping are those of the simulated one, or the film is refused."""

import struct
import sys

import numpy as np
import pandas as pd
import pytest
from films import Scene, render

from swingdown.answer.command import Wishes, answer
from swingdown.errors import InputError, PackageError
from swingdown.measurement.film import video
from swingdown.measurement.positions import fit_circle, to_angles
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS

cv2 = pytest.importorskip("cv2", reason="films are read with the extra `video`: pip install swingdown[video]")
SCENE = Scene(seconds=8.0, size=(480, 270), length=190.0, bob=11.0)
SCENES = {
    "plain": SCENE,
    "grainy and blurred": SCENE._replace(noise=8.0, exposure=0.95),
    "from below": SCENE._replace(pitch=np.radians(10)),
    "from the side": SCENE._replace(yaw=np.radians(10)),
    "shining at its ends": SCENE._replace(shine=0.6, damping=0.005),
    "another codec": SCENE._replace(codec="MJPG"),
    "behind a stand": SCENE._replace(stand=(265, 285)),
    "with a hand": SCENE._replace(hand=2.0),
}


@pytest.fixture(scope="module")
def films(tmp_path_factory):
    """A function that gives the path of a scene's film and the angles of its frames, rendered once."""
    folder, made = tmp_path_factory.mktemp("films"), {}

    def one(scene):
        if scene not in made:
            path = folder / f"film{len(made)}{'.avi' if scene.codec == 'MJPG' else '.mp4'}"
            made[scene] = path, render(path, scene)
        return made[scene]

    return one


def followed(path):
    """Times, angles, and which frames have them, as the film tells."""
    track = video.tracked(path)
    seen = np.isfinite(track.places[:, 0])
    x, y = track.places[seen].T
    return track.times, to_angles(x, y, fit_circle(x, y)), seen


@pytest.mark.parametrize("name", list(SCENES))
def test_the_bob_is_followed(films, name):
    """Within half a pixel at worst, and within the tolerance of its gain and zero; what is hidden is left out and nothing else is."""
    path, true = films(SCENES[name])
    times, angles, seen = followed(path)
    np.testing.assert_allclose(times, np.arange(len(true)) / SCENE.rate, atol=1e-6)
    line = np.polyfit(true[seen], angles, 1)
    assert abs(line[0] - 1) < video.GAIN
    off = SCENE.length * (angles - np.polyval(line, true[seen]))
    assert np.std(off) < (0.5 if name == "from the side" else 0.15)  # px; from the side the circle is none
    hidden = np.zeros(len(true), bool)
    if name == "behind a stand":
        x = SCENE.size[0] / 2 + SCENE.length * np.sin(true)
        hidden = (x > 265 - SCENE.bob) & (x < 285 + SCENE.bob)
        assert not seen[hidden & (x > 265) & (x < 285)].any()
        hidden = np.convolve(hidden, [1, 1, 1, 1, 1], "same") > 0
    if name == "with a hand":
        hidden = np.arange(len(true)) < SCENES[name].hand * SCENE.rate
    assert np.mean(seen[~hidden]) > 0.97


@pytest.mark.parametrize("name", ["plain", "grainy and blurred", "from below", "another codec"])
def test_period_and_damping_are_those_of_the_pendulum(films, tmp_path, name):
    scene = SCENES[name]
    path, _ = films(scene)
    assert answer([str(path)], {}, Wishes(into=str(tmp_path / "study"), quick=True)) == 0
    row = pd.read_csv(tmp_path / "study" / "first_answer.csv").iloc[0]
    for key, true in (("natural_frequency_rad_per_s", scene.omega), ("viscous_ratio", scene.damping)):
        assert abs(row[key] - true) < 3 * row[f"{key}_u"], key
    # and that tells something; the value of one law holds what other laws say of it, the quality is much the same by each
    for key in ("natural_frequency_rad_per_s", "quality"):
        assert row[f"{key}_u"] < 0.005 * row[key]


def test_the_track_is_drawn_over_the_first_frame(films, tmp_path, capsys):
    path, _ = films(SCENE)
    answer([str(path)], {}, Wishes(into=str(tmp_path / "study"), quick=True))
    drawn = cv2.imread(str(tmp_path / "study" / f"{path.stem}-track.png"))
    assert f"{path.stem}-track.png" in capsys.readouterr().out
    reader = cv2.VideoCapture(str(path))
    changed = np.argwhere(cv2.absdiff(drawn, reader.read()[1]).max(axis=2) > 40)[:, ::-1]
    pivot = SCENE.size[0] / 2, SCENE.size[1] / 2 - 0.6 * SCENE.length
    away = np.hypot(*(changed - pivot).T) - SCENE.length
    assert len(changed) > 100
    assert np.abs(away).max() < 4


def test_what_is_told_of_a_film_and_what_is_left_open(films):
    path, _ = films(SCENE)
    found = ingest({**COLUMNS, "recording": "a", "campaign": "a", "file": str(path)})
    assert "followed in 240 of 240 frames" in found.attrs["remarks"]
    assert "film of 480 × 270 px" in found.attrs["taken"]
    assert found.attrs["gain_tolerance"] == video.GAIN
    stated = ingest(
        {**COLUMNS, "recording": "a", "campaign": "a", "file": str(path), "gain_tolerance": 0.001}
    )
    assert stated.attrs["gain_tolerance"] == 0.001


def _boxes(content, start, end):
    """The boxes of an MP4 file: name, and from where to where."""
    while start < end:
        size, name = struct.unpack(">I4s", content[start : start + 8])
        yield name, start, start + size
        start += size


def uneven(content, durations):
    """An MP4 whose frames last these numbers of ticks: its table of times written anew."""
    path, at = [b"moov", b"trak", b"mdia", b"minf", b"stbl", b"stts"], []
    start, end = 0, len(content)
    for wanted in path:
        start, end = next(one[1:] for one in _boxes(content, start, end) if one[0] == wanted)
        at.append(start)
        start += 8
    entries = b"".join(struct.pack(">II", 1, int(one)) for one in durations)
    table = struct.pack(">I4sII", 16 + len(entries), b"stts", 0, len(durations)) + entries
    longer = len(table) - (end - at[-1])
    whole = bytearray(content[: at[-1]] + table + content[end:])
    for place in at[:-1]:
        whole[place : place + 4] = struct.pack(">I", struct.unpack(">I", whole[place : place + 4])[0] + longer)  # fmt: skip
    return bytes(whole)


def test_frames_that_follow_each_other_unevenly_have_the_times_of_the_container(films, tmp_path):
    path, _ = films(SCENE)
    ticks = 512  # of a frame, as this container counts
    early = np.random.default_rng(3).integers(-ticks // 2, ticks // 2, 120)
    drawn = ticks + np.column_stack([early, -early]).ravel()  # as long in all as before
    odd = tmp_path / "odd.mp4"
    odd.write_bytes(uneven(path.read_bytes(), drawn))
    times, _, _ = followed(odd)
    np.testing.assert_allclose(times, np.r_[0, np.cumsum(drawn)[:-1]] / ticks / SCENE.rate, atol=2e-3)


def rolling(inside):
    """A bob that goes around and never back, slower and slower."""
    return 6.0 * (1 - np.exp(-inside / 8))


def test_films_without_a_swing_are_refused(films, tmp_path):
    still = tmp_path / "still.mp4"
    render(still, SCENE._replace(release=0.0))
    with pytest.raises(InputError, match="nothing moves.*camera on a stand"):
        video.tracked(still)
    around = tmp_path / "around.mp4"
    render(around, SCENE._replace(length=90.0), angles=rolling)
    with pytest.raises(InputError):
        answer([str(around)], {}, Wishes(into=str(tmp_path / "a"), quick=True))
    shaking = tmp_path / "shaking.mp4"
    draws = np.random.default_rng(5)
    render(shaking, SCENE, angles=lambda inside: draws.normal(0, 0.3, (len(inside), 1)) + 0 * inside)
    with pytest.raises(InputError):
        answer([str(shaking)], {}, Wishes(into=str(tmp_path / "b"), quick=True))
    assert not (tmp_path / "a").exists()
    assert not (tmp_path / "b").exists()


def test_damaged_films_are_refused(films, tmp_path):
    whole = films(SCENES["plain"])[0].read_bytes()
    for name, content, words in (
        ("none.mp4", b"no film at all" * 100, "no frame of it can be read"),
        ("empty.mp4", b"", "no frame of it can be read"),
        ("cut.mp4", whole[: len(whole) // 2], "no frame of it can be read"),
    ):
        path = tmp_path / name
        path.write_bytes(content)
        with pytest.raises(InputError, match=words) as caught:
            video.tracked(path)
        assert "copy it anew" in caught.value.mend


def test_of_a_film_that_breaks_off_what_can_be_read_is_used(films, tmp_path):
    whole, true = films(SCENES["another codec"])
    film = whole.read_bytes()
    path = tmp_path / "cut.avi"
    path.write_bytes(film[: len(film) // 2])
    times, angles, seen = followed(path)
    assert 0.3 * len(true) < len(times) < 0.7 * len(true)
    line = np.polyfit(true[: len(times)][seen], angles, 1)
    assert np.std(angles - np.polyval(line, true[: len(times)][seen])) < 2e-3
    recording = ingest({**COLUMNS, "recording": "cut", "campaign": "cut", "file": str(path)})
    assert f"THE FILE STATES {len(true)} FRAMES" in recording.attrs["remarks"]


def test_without_opencv_the_extra_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "cv2", None)
    path = tmp_path / "a.mp4"
    path.write_bytes(b"x")
    with pytest.raises(PackageError, match=r"pip install 'swingdown\[video\]'"):
        ingest({**COLUMNS, "recording": "a", "campaign": "a", "file": str(path)})


def remade(path, sources, change):
    """A film at ``path`` of frames that ``change`` makes of those of the ``sources``."""
    readers, writer = [cv2.VideoCapture(str(one)) for one in sources], None
    for k in range(10_000):
        frames = [reader.read() for reader in readers]
        if not all(read for read, _ in frames):
            break
        picture = change(k, *(frame for _, frame in frames))
        if writer is None:
            size = picture.shape[1], picture.shape[0]
            writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 30.0, size)
        writer.write(picture)
    writer.release()
    return path


def test_a_white_marker_on_black_is_followed(films, tmp_path):
    """As a film is from which all but the marker was masked: no picture of it is bright enough to tell how bright it is."""
    path, true = films(SCENE)

    def masked(_, frame):
        bob = np.abs(frame.astype(int) - (30, 40, 160)).sum(axis=2) < 60
        return np.where(bob, 255, 0).astype(np.uint8)[:, :, None].repeat(3, axis=2)

    _, angles, seen = followed(remade(tmp_path / "masked.avi", [path], masked))
    assert np.mean(seen) > 0.97
    assert (
        np.std(angles - np.poly1d(np.polyfit(true[seen], angles, 1))(true[seen])) * SCENE.length < 0.5
    )  # px


def test_two_bobs_in_one_film_are_two_recordings(films, tmp_path):
    left, right = SCENE, SCENE._replace(omega=2 * np.pi / 1.0, seed=2)
    path = remade(
        tmp_path / "two.avi", [films(one)[0] for one in (left, right)], lambda _, *both: np.hstack(both)
    )
    runs = video.film(path.open("rb"), path.name)
    assert list(runs) == ["bob 1 from the left", "bob 2 from the left"]
    for one, scene in zip(runs.values(), (left, right), strict=True):
        times, x = one.frame["t (s)"].to_numpy(), one.frame["x (px)"].to_numpy()
        away = x - np.median(x)
        turns = times[1:][np.diff(np.signbit(away).astype(int)) != 0]
        # wider than small swings by (1 + a²/16)
        assert 2 * np.median(np.diff(turns)) == pytest.approx(2 * np.pi / scene.omega, rel=0.03)


def test_light_that_changes_over_half_the_picture_is_no_bob(films, tmp_path):
    scene = SCENE._replace(noise=0.5)
    path, angles = films(scene)

    def flickering(k, frame):
        half = frame.astype(np.int16)
        half[: frame.shape[0] // 2] += round(9 * np.sin(k / 7))
        return np.clip(half, 0, 255).astype(np.uint8)

    _, found, seen = followed(remade(tmp_path / "light.avi", [path], flickering))
    assert seen.mean() > 0.9
    assert np.corrcoef(found, angles[: seen.size][seen])[0, 1] > 0.999


def test_of_areas_those_that_stand_out_are_not_the_bobs():
    """Areas that scatter as much as a shining bob's: twice their deviation from the usual one is one of them, four times is none."""
    random = np.random.default_rng(0)
    xy = np.column_stack([100 * np.sin(np.arange(400) / 9), np.zeros(400)])
    areas = 900 * (1 + 0.12 * random.standard_normal(400))
    areas[10], areas[20], areas[30] = 900 * (1 + np.array([0.12 * 2, 0.12 * 4.2, -0.12 * 4.2]))
    kept = video._of_usual_area(xy, areas)
    assert kept[10] and not kept[20] and not kept[30] and kept.mean() > 0.97


def test_of_places_those_on_the_bobs_circle_are_the_bobs():
    """An arc of forty degrees to each side; a tenth as many places lie all over the picture, within a circle so large that it is a line."""
    random = np.random.default_rng(3)
    swing = np.radians(40) * np.sin(np.arange(300) / 9)
    arc = np.column_stack([320 + 300 * np.sin(swing), 60 + 300 * np.cos(swing)])
    other = random.uniform((0, 0), (640, 480), (30, 2))
    off = np.abs(np.hypot(*(other - (320, 60)).T) - 300)
    kept = video._on_circle(np.concatenate([arc, other, [[np.nan, np.nan]]]), 10.0, "film")
    assert kept[:300].all() and not kept[300:330][off > 12].any() and not kept[330]


def test_three_places_on_a_circle_tell_all_others_of_it():
    """However unevenly they lie on it."""
    turned = np.radians(np.arange(-60, 61, 2))
    arc = np.column_stack([320 + 300 * np.sin(turned), 60 + 300 * np.cos(turned)])
    for chosen in ((0, 30, 60), (0, 5, 60), (0, 55, 60), (20, 60, 1)):
        assert video._near_circle(arc, 5.0, *arc[list(chosen)]).all()
        assert not video._near_circle(1.1 * arc, 5.0, *arc[list(chosen)]).all()


def test_a_film_whose_frames_bear_no_times_has_those_of_its_rate():
    assert list(video._increasing([0.0, 0.0, 0.0], 25.0, "film")) == [0.0, 0.04, 0.08]
    assert list(video._increasing([0.0, 0.05, 0.08], 25.0, "film")) == [0.0, 0.05, 0.08]
    with pytest.raises(InputError, match="neither the times of its frames nor their rate"):
        video._increasing([0.0, 0.0, 0.0], 0.0, "film")
