"""Recording from hardware: wire formats, the device's clock, losses, and how a recording ends.

``formats`` turns bytes into samples, ``order`` puts them on the device's clock and finds what is missing, ``recorder`` waits
for the release and tells how it ended, ``journal`` keeps every byte on disk as it arrives, ``session`` ties these to a port
and writes the recording, ``sheets`` adds it to the sample sheet. Only here is a serial port opened.
"""
