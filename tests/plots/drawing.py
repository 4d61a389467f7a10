"""What is drawn on axes, as numbers."""


def drawn(axes):
    """The curves of axes, in their order, but for those without points."""
    return [line.get_xydata() for line in axes.get_lines() if len(line.get_xdata())]


def bars(axes):
    """Of each mean with its bar, by its place, the mean, and how far the bar reaches to both sides."""
    found = {}
    for one in axes.containers:
        (x, y), (segment,) = one[0].get_xydata()[0], one[2][0].get_segments()
        found[round(float(x), 3)] = (float(y), y - segment[0, 1], segment[1, 1] - y)
    return found


def said(figure):
    """All that is written on a figure."""
    return " ".join(text.get_text() for text in figure.findobj(lambda one: hasattr(one, "get_text")))
