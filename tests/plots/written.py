"""What is written in a figure, and what of it lies on other words or leaves the figure."""

from unittest.mock import patch

from matplotlib.text import Text


def boxes(figure):
    """(text, box in pixels) of all that is written in a figure, once its layout is settled."""
    figure.draw_without_rendering()
    written, plain = [], Text.draw
    with patch.object(Text, "draw", lambda self, renderer: (written.append(self), plain(self, renderer))):
        figure.draw_without_rendering()
    return [(text.get_text(), Text.get_window_extent(text)) for text in written if text.get_text().strip()]


def in_the_way(figure):
    """Pairs of texts of which one lies on the other, and each text that leaves the figure, beside None."""
    found, there = [], boxes(figure)
    width, height = figure.bbox.width, figure.bbox.height
    assert len(there) > 10
    for number, (one, box) in enumerate(there):
        if min(box.x0, box.y0, width - box.x1, height - box.y1) < -1:
            found.append((one, None))
        for other, rival in there[number + 1 :]:
            wide = min(box.x1, rival.x1) - max(box.x0, rival.x0)
            high = min(box.y1, rival.y1) - max(box.y0, rival.y0)
            if min(wide, high) >= 3:
                found.append((one, other))
    return found
