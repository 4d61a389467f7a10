"""What trials said, as it is drawn."""

import numpy as np
import pandas as pd
import pytest

from swingdown.plots.trials import confusion, detection

pytestmark = pytest.mark.usefixtures("frozen")


def test_the_confusion_matrix_has_per_cent_of_each_row_where_something_was_said():
    matrix = pd.DataFrame(
        {"hidden": ["viscous", "magnet"], "viscous": [0.71, 0.0], "magnet": [0.0, 0.69], "unknown": [0.29, 0.31], "backlash": 0.0}
    )  # fmt: skip
    (axes,) = confusion(matrix).axes
    assert [one.get_text() for one in axes.get_xticklabels()] == ["viscous", "magnet", "unknown"]
    assert [one.get_text() for one in axes.get_yticklabels()] == ["viscous", "magnet"]
    said = {text.get_position(): (text.get_text(), text.get_color()) for text in axes.texts}
    ink = said[2, 0][1]
    assert said == {(0, 0): ("71", "white"), (2, 0): ("29", ink), (1, 1): ("69", ink), (2, 1): ("31", ink)}


def test_the_shares_of_trials_stand_beside_their_kinds():
    single = [
        {
            "kind": "single",
            "ratio": ratio,
            "exact": k < 2,
            "inside": k < 3,
            "wrong": k == 3,
            "seconds": 10.0 + k,
        }
        for ratio in (1.3, 2.0)
        for k in range(4)
    ]
    others = [{"kind": kind, "alarm": k < 1, "right": k < 3, "inside": k < 2, "seconds": 20.0 * (k + 1)}
              for kind in ("null", "pair", "removed") for k in range(4)]  # fmt: skip
    by_size, kinds, times = detection(pd.DataFrame(single + others)).axes
    for line, share in zip(by_size.lines, (50, 75, 25), strict=True):
        np.testing.assert_allclose(line.get_xydata(), [[1.3, share], [2.0, share]])
    assert [bar.get_width() for bar in kinds.patches] == [25, 75, 50]
    assert [text.get_text() for text in kinds.texts] == [
        "nothing hidden: false alarms, 1 of 4", "taken out of the catalogue: unknown, 3 of 4", "two hidden: both named, 2 of 4",
    ]  # fmt: skip
    assert all(bar.get_y() < text.xy[1] + 0.3 for bar, text in zip(kinds.patches, kinds.texts, strict=True))
    assert [one.get_text() for one in times.get_yticklabels()] == ["nothing hidden", "one effect", "two effects", "taken out"]  # fmt: skip
    medians = [line.get_xdata()[0] for line in times.lines if line.get_linestyle() == "-"]
    assert medians == [50, 11.5, 50, 50]
