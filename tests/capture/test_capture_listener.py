"""A source is read all the time, and what came is kept with the time at which it did."""

import time

from swingdown.capture import source
from swingdown.capture.listener import Listener


class Opened:
    """A source that gives these pieces, and then nothing or an error."""

    def __init__(self, *pieces, end=None):
        self.pieces, self.end, self.closed = list(pieces), end, False

    def read(self):
        if self.pieces:
            return self.pieces.pop(0)
        if self.end:
            raise self.end
        time.sleep(0.005)
        return b""

    def close(self):
        self.closed = True


def test_pieces_are_taken_in_their_order_with_the_host_s_time():
    before = time.time()
    opened = Opened(b"one", b"two")
    listener = Listener(opened)
    (first, one), (second, two) = listener.take(), listener.take()
    assert (one, two) == (b"one", b"two") and before - 0.1 < first <= second < time.time() + 0.1
    assert before - 0.1 < listener.began <= listener.now() < time.time() + 0.1
    listener.close()
    assert opened.closed and listener.gone is None


def test_a_source_that_went_away_is_told_after_all_that_it_sent():
    end = source.GONE[0]("gone") if isinstance(source.GONE, tuple) else source.GONE("gone")
    listener = Listener(Opened(b"one", end=end))
    for _ in range(100):
        if listener.behind == 2:
            break
        time.sleep(0.005)
    assert listener.behind == 2 and listener.gone is None
    assert listener.take()[1] == b"one"
    assert listener.take()[1] is end and listener.gone is end
    assert listener.take()[1] is end  # and from then on
    listener.close()


def test_while_nothing_comes_nothing_is_taken():
    class Silent(Opened):
        def read(self):
            time.sleep(0.2)
            return b""

    listener = Listener(Silent())
    assert listener.take() is None
    listener.close()
