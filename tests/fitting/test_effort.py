"""The work of fits is counted by each thread for itself."""

import threading

from swingdown.fitting import effort


def test_work_adds_up_and_each_thread_counts_its_own():
    before = effort.done()
    effort.add(3)
    effort.add(4)
    assert effort.done() == before + 7
    seen = []

    def elsewhere():
        effort.add(5)
        seen.append(effort.done())

    other = threading.Thread(target=elsewhere)
    other.start()
    other.join()
    assert seen == [5] and effort.done() == before + 7
