"""The port: found by path, USB identity or URL; what cannot be opened is told with the ports there are and the mend."""

import os
import socket
import threading
import time
from types import SimpleNamespace

import pytest
import serial
import serial.rfc2217
from serial.tools import list_ports
from traffic import Line, frames

from swingdown.capture import port as ports
from swingdown.errors import InputError

UNO = SimpleNamespace(
    device="/dev/ttyACM0", vid=0x2341, pid=0x0043, serial_number="5573", product="Arduino Uno"
)
OTHER = SimpleNamespace(device="/dev/ttyACM3", vid=0x2341, pid=0x0043, serial_number="9a01", product=None)
PLAIN = SimpleNamespace(device="/dev/ttyS0", vid=None, pid=None, serial_number=None, product=None)


@pytest.fixture
def plugged(monkeypatch):
    def plug(*boards):
        monkeypatch.setattr(list_ports, "comports", lambda: list(boards))

    plug(UNO, PLAIN)
    return plug


@pytest.fixture
def line():
    made = Line()
    yield made
    made.close()


def read_all(connection, size, seconds=5):
    data, end = b"", time.monotonic() + seconds
    while len(data) < size and time.monotonic() < end:
        data += connection.read()
    return data


def test_a_board_is_found_by_its_usb_identity(plugged):
    assert ports.find("2341:0043") == "/dev/ttyACM0"
    plugged(UNO, OTHER)
    assert ports.find("2341:0043:9a01") == "/dev/ttyACM3"


def test_a_lone_board_is_found_by_itself(plugged):
    assert ports.find(None) == "/dev/ttyACM0"
    plugged(PLAIN)
    with pytest.raises(InputError, match="no port is named, and no boards are plugged in"):
        ports.find(None)


@pytest.mark.parametrize(
    ("name", "boards", "told"),
    [
        ("2341:0043", (UNO, OTHER), ["2 boards are", "VID:PID:serial"]),
        ("2341:0043:77", (UNO,), ["no board 2341:0043:77", "plug it in"]),
        ("/dev/ttyUSB7", (UNO, PLAIN), ["no port /dev/ttyUSB7", "/dev/ttyS0"]),
        (None, (UNO, OTHER), ["no port is named, and 2 boards", "set capture.port"]),
    ],
)
def test_a_port_that_is_not_there_is_told_with_those_that_are(plugged, name, boards, told):
    plugged(*boards)
    with pytest.raises(InputError) as caught:
        ports.connect(name, 115200)
    for part in [*told, "/dev/ttyACM0 (2341:0043:5573, Arduino Uno)"]:
        assert part in str(caught.value)


def test_no_port_at_all(plugged):
    plugged()
    with pytest.raises(InputError, match=r"none \(is the board plugged in"):
        ports.find("/dev/ttyUSB7")


def test_a_busy_port_is_told(plugged, line):
    first = ports.connect(line.port, 115200)
    with pytest.raises(InputError) as caught:
        ports.connect(line.port, 115200)
    first.close()
    for part in ("in use by another program", f"fuser {line.port}", "/dev/ttyACM0"):
        assert part in str(caught.value)


def test_a_port_one_may_not_open_is_told(plugged, line):
    root = os.geteuid() == 0
    os.chmod(line.port, 0o600 if root else 0)
    if root:
        os.seteuid(65534)
    try:
        with pytest.raises(InputError) as caught:
            ports.connect(line.port, 115200)
    finally:
        if root:
            os.seteuid(0)
    for part in ("may not be opened by you", "usermod -aG dialout", "/dev/ttyACM0"):
        assert part in str(caught.value)


def test_something_that_is_no_port(plugged, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be opened"):
        ports.connect(tmp_path / "file", 115200)
    with pytest.raises(InputError, match="is no port"):
        ports.connect("nonsense://x", 115200)


def test_only_the_schemes_of_the_table_are_opened(tmp_path):
    """pyserial's spy:// writes what passes through to any file."""
    with pytest.raises(InputError, match="socket://HOST:PORT or rfc2217://HOST:PORT"):
        ports.connect(f"spy:///dev/ptmx?file={tmp_path / 'log'}", 115200)
    assert not (tmp_path / "log").exists()


def test_a_pseudo_terminal_is_read(line):
    connection = ports.connect(line.port, 115200)
    line.send(frames(range(10)))
    assert read_all(connection, 80) == frames(range(10))
    assert connection.read() == b""
    connection.close()


def test_an_unplugged_port_raises_what_is_caught(line):
    connection = ports.connect(line.port, 115200)
    line.unplug()
    with pytest.raises(ports.GONE):
        for _ in range(10):
            connection.read()
    connection.close()


@pytest.mark.parametrize("scheme", ["socket", "rfc2217"])
def test_a_port_over_the_network(scheme):
    """socket:// as ser2net gives it, and rfc2217:// with its negotiation, both on this machine."""
    server = socket.create_server(("127.0.0.1", 0))

    def serve():
        peer, _ = server.accept()
        stop = threading.Event()
        if scheme == "rfc2217":
            wire = SimpleNamespace(write=peer.sendall)
            behind = serial.serial_for_url("loop://")
            manager = serial.rfc2217.PortManager(behind, wire)

            def answer():
                while not stop.is_set() and (asked := peer.recv(1024)):
                    b"".join(manager.filter(asked))

            threading.Thread(target=answer, daemon=True).start()
            time.sleep(1)
            peer.sendall(b"".join(manager.escape(frames(range(200, 260)))))
        else:
            time.sleep(0.3)  # opening empties the port
            peer.sendall(frames(range(200, 260)))
        time.sleep(2)
        stop.set()
        peer.close()

    threading.Thread(target=serve, daemon=True).start()
    connection = ports.connect(f"{scheme}://127.0.0.1:{server.getsockname()[1]}", 115200)
    assert read_all(connection, 480) == frames(range(200, 260))
    connection.close()
    server.close()


@pytest.mark.parametrize("count", [200, 5000])
def test_a_socket_keeps_up_with_the_board(count):
    """Two bytes a call would be 50 lines a second; here a second of frames has to come within that second."""
    server = socket.create_server(("127.0.0.1", 0))

    def serve():
        peer, _ = server.accept()
        time.sleep(0.3)
        due = time.monotonic()
        for k in range(0, count, count // 100):
            peer.sendall(frames([7] * (count // 100), k))
            due += 0.01
            time.sleep(max(due - time.monotonic(), 0))
        time.sleep(1)
        peer.close()

    threading.Thread(target=serve, daemon=True).start()
    connection = ports.connect(f"socket://127.0.0.1:{server.getsockname()[1]}", 115200)
    got = read_all(connection, 8 * count, seconds=1.9)
    assert got == frames([7] * count)
    connection.close()
    server.close()


def test_a_network_port_that_is_not_there():
    with pytest.raises(InputError, match="cannot be opened"):
        ports.connect("socket://127.0.0.1:1", 115200)
