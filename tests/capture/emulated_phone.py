"""An EMULATED telephone: what phyphox answers over its remote interface, written from its documentation, with faults on request."""

import json
import math
import threading
import time
import urllib.parse
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

RATE = 100.0  # samples a second
TITLE = "Gyroscope (rotation rate)"
INPUT = {"source": "gyroscope", "outputs": [{"x": "gyrX"}, {"y": "gyrY"}, {"z": "gyrZ"}, {"t": "gyr_time"}]}
EXPORT = [{"set": "Raw Data", "sources": [{"label": "Time (s)", "buffer": "gyr_time"}, *({"label": f"Gyroscope {a} (rad/s)", "buffer": f"gyr{a.upper()}"} for a in "xyz")]}]  # fmt: skip


class Telephone:
    """It records from ``start`` on, in real time: y swings, x and z tremble. ``port`` is what a capture opens.

    Faults: ``mute`` drops connections from the first to the second time (s since the start); ``slow`` (s) before each answer; ``text`` stands
    in the place of all answers to /get from a time on; ``lacking`` times without a value; ``hole`` times without a sample; ``jumps`` (at, by).
    """

    def __init__(self):
        self.config = {
            "crc32": "44c5dc97",
            "title": TITLE,
            "buffers": [],
            "inputs": [INPUT],
            "export": EXPORT,
        }
        self.session, self.measuring, self.timed = "abcdef", False, False
        self.asked, self.commands, self.force_full = [], [], False
        self.foreign = False  # another experiment is open, whose buffers have other names
        self.iphone = False  # it answers with what is new also after its data were cleared
        self.begun, self.stopped, self.paused, self.marks = None, None, 0.0, []
        self.mute, self.slow, self.text = (math.inf, math.inf), 0.0, (math.inf, "")
        self.lacking, self.hole, self.jumps = (math.inf, math.inf), (math.inf, math.inf), (math.inf, 0.0)
        self.still_until, self.omega = 0.0, 6.0  # s, rad/s; y rests before, and is let go then
        self.events = []  # (s since the start, what is done then)
        made = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self):
                made.answer(self)

            def log_message(self, *_):
                pass

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._server.daemon_threads = True
        self.port = f"phyphox://127.0.0.1:{self._server.server_port}"
        threading.Thread(target=self._server.serve_forever, args=(0.05,), daemon=True).start()

    def close(self):
        self._server.shutdown()
        self._server.server_close()

    @property
    def seconds(self):
        return (self.stopped or time.monotonic()) - self.begun - self.paused if self.begun else 0.0

    def rate_of_y(self, at):
        at -= self.still_until
        return -1.8 * math.exp(-0.02 * at) * math.sin(self.omega * at) if at > 0 else 0.0

    def samples(self):
        found = []
        for k in range(int(self.seconds * RATE)):
            at = k / RATE
            if self.hole[0] <= at < self.hole[1]:
                continue
            told = at + (self.jumps[1] if at >= self.jumps[0] else 0.0)
            y = None if self.lacking[0] <= at < self.lacking[1] else self.rate_of_y(at)
            found.append((told, 0.003 * math.sin(17 * at), y, 0.002 * math.cos(11 * at)))
        return found

    def command(self, name):
        self.commands.append(name)
        if name == "start" and not self.measuring:
            if self.stopped:
                self.paused += time.monotonic() - self.stopped
            self.measuring, self.begun, self.stopped = True, self.begun or time.monotonic(), None
            self._mark("START")
        elif name == "stop" and self.measuring:
            self.measuring, self.stopped = False, time.monotonic()
            self._mark("PAUSE")
        elif name == "clear":
            self.measuring, self.begun, self.stopped, self.paused = False, None, None, 0.0
            self.force_full, self.marks = not self.iphone, []
        return True

    def _mark(self, event):
        self.marks.append({"event": event, "experimentTime": self.seconds, "systemTime": time.time()})

    def answer(self, request):
        path, _, query = request.path.partition("?")
        parameters = dict(urllib.parse.parse_qsl(query, keep_blank_values=True))
        self.asked.append((path, parameters))
        while self.events and self.events[0][0] <= self.seconds:
            self.events.pop(0)[1]()
        time.sleep(self.slow)
        if self.mute[0] <= self.seconds < self.mute[1] and path != "/control":
            request.close_connection = True
            request.connection.close()
            return
        if path == "/config":
            text = self.config if isinstance(self.config, str) else json.dumps(self.config)
        elif path == "/control":
            text = json.dumps({"result": self.command(parameters["cmd"])})
        elif path == "/time":
            text = json.dumps(self.marks)
        elif path == "/get":
            text = self.text[1] if self.seconds >= self.text[0] else self._get(parameters)
        else:
            request.send_error(404)
            return
        body = text.encode()
        request.send_response(200)
        request.send_header("Content-Type", "application/json")
        request.send_header("Content-Length", str(len(body)))
        request.end_headers()
        request.wfile.write(body)

    def _get(self, parameters):
        samples, columns = self.samples(), {"gyr_time": 0, "gyrX": 1, "gyrY": 2, "gyrZ": 3}
        buffers = {}
        for name, since in parameters.items():
            if name not in columns or self.foreign:
                continue
            if not since:
                mode, rows = "single", samples[-1:]
            elif since == "full" or self.force_full:
                mode, rows = "full", samples
            else:
                least = float(since.partition("|")[0])
                least += 10 ** math.floor(math.log10(abs(least) / 1e7)) if least else 0.0
                mode, rows = "partial", [row for row in samples if row[0] > least]
            written = ["null" if row[columns[name]] is None else f"{row[columns[name]]:.7E}" for row in rows]
            buffers[name] = f'"{name}":{{"size":0,"updateMode":"{mode}", "buffer":[{",".join(written)}]}}'
        self.force_full = self.force_full and not parameters
        status = {
            "session": self.session,
            "measuring": self.measuring,
            "timedRun": self.timed,
            "countDown": 0,
        }
        return f'{{"buffer":{{\n{",".join(buffers.values())}\n}},\n"status":{json.dumps(status)}}}'
