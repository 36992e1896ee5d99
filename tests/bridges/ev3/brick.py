"""An emulated Lego EV3 brick: motors that turn, sensors, faults; beacon, TCP, a USB cable on the loopback.

Its thread serves the loopback. A `Wire` needs none: what is sent by it has been answered when `send` returns.

Written from the brick's documentation, not from the package's codec: the two check each other,
and ev3-dc's classes check this one. It is strict: whatever a real brick would not take, or would
take for something else, stands in `violations`. Its motors obey as the source of the firmware
(`d_pwm.c`) does: a timed command starts at once, and `start` concerns motors that stand.
"""

from __future__ import annotations

import math
import re
import select
import socket
import struct
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from io import FileIO

from lrp_jupyter.bridges.ev3.lines import WAIT, Line

NAN = float("nan")
NO_DEVICE = 126
DEGREES_PER_PERCENT = 10.0  # a large motor at full speed: about 1000 degrees a second

# What follows an operation: words name constants it reads, `>x` are places it writes (struct codes)
OPERATIONS: dict[bytes, tuple[str, str]] = {
    b"\xa2": ("reset", "layer ports"),
    b"\xa3": ("stop", "layer ports flag"),
    b"\xa4": ("power", "layer ports percent"),
    b"\xa5": ("speed", "layer ports percent"),
    b"\xa6": ("start", "layer ports"),
    b"\xa8": ("read", "layer motor >b >i"),
    b"\xa9": ("test", "layer ports >b"),
    b"\xad": ("time_power", "layer ports percent steps steps steps flag"),
    b"\xae": ("step_speed", "layer ports percent steps steps steps flag"),
    b"\xaf": ("time_speed", "layer ports percent steps steps steps flag"),
    b"\xb2": ("clear_count", "layer ports"),
    b"\xb3": ("get_count", "layer motor >i"),
    b"\x99\x05": ("type_mode", "layer input >b >b"),
    b"\x99\x1b": ("ready_percent", "layer input type mode count >b"),
    b"\x99\x1c": ("ready_raw", "layer input type mode count >i"),
    b"\x99\x1d": ("ready_si", "layer input type mode count >f"),
    b"\x9d": ("read_si", "layer input type mode >f"),
    b"\x94\x01": ("tone", "volume frequency steps"),
    b"\x84\x00": ("update", ""),
    b"\x84\x05": ("write", "colour column row string"),
    b"\x84\x11": ("font", "font"),
    b"\x84\x13": ("fill_window", "colour row row"),
    b"\x81\x01": ("voltage", ">f"),
    b"\x81\x02": ("current", ">f"),
    b"\x81\x03": ("text", "length >s"),
    b"\x81\x09": ("text", "length >s"),
    b"\x81\x0a": ("text", "length >s"),
    b"\x81\x0b": ("text", "length >s"),
    b"\x81\x0c": ("text", "length >s"),
    b"\x81\x12": ("battery", ">B"),
    b"\xc5": ("memory", ">i >i"),
    b"\x7c\x04": ("volume", ">b"),
    b"\x7c\x06": ("minutes", ">b"),
    b"\xd3\x0d": ("name", "length >s"),
    b"\xd3\x0e": ("network", "hardware length >s >s >s"),
}
RANGES = {
    "layer": range(1), "ports": range(1, 16), "motor": range(4), "flag": range(2),
    "percent": range(-100, 101), "steps": range(2**31), "input": (*range(4), *range(16, 20)),
    "type": range(128), "mode": range(-1, 8), "count": range(1, 9), "length": range(1, 256),
    "colour": range(2), "column": range(178), "row": range(128), "font": range(4),
    "volume": range(101), "frequency": range(250, 10001), "hardware": range(1, 4),
}  # fmt: skip


class RefusedError(Exception):
    """The brick cannot execute this."""


@dataclass
class EmulatedMotor:
    """A motor whose angle is computed from its start time: no time step, no drift."""

    clock: Callable[[], float]
    type: int = 7
    setting: float = 0.0  # percent that it will turn with when it is started
    percent: float = 0.0
    regulated: bool = True
    brakes_then: bool = False
    starts: int = 0  # commands that made it turn
    base: float = 0.0  # degrees when it was started
    zero: float = 0.0  # degrees that count as 0
    tacho_zero: float = 0.0  # the same of the other count, which only `reset` clears
    begun: float = 0.0
    lasting: float = 0.0
    is_held: bool = False  # by something stronger

    def hold(self, is_held: bool) -> None:
        self.base, self.is_held = self.angle, is_held
        self.begun, self.lasting = self.clock(), max(0.0, self.ends - self.clock())

    @property
    def angle(self) -> float:
        if self.is_held:
            return self.base
        elapsed = min(self.clock() - self.begun, self.lasting)
        return self.base + (self.percent * DEGREES_PER_PERCENT * elapsed if self.percent else 0.0)

    @property
    def turning(self) -> float:
        """Percent that it turns with now."""
        return self.percent if self.clock() - self.begun < self.lasting else 0.0

    @property
    def ends(self) -> float:
        """When it stops, or stopped, by the clock."""
        return self.begun + self.lasting

    @property
    def braked(self) -> bool:
        return self.brakes_then and not self.turning

    def start(self) -> None:
        if not self.turning:
            self.run(self.setting, math.inf, False)

    def run(self, percent: float, seconds: float, brake: bool, regulated: bool = True) -> None:
        self.base, self.begun = self.angle, self.clock()
        self.percent, self.lasting, self.brakes_then, self.regulated = percent, seconds, brake, regulated
        self.starts += 1

    def stop(self, brake: bool) -> None:
        self.base, self.begun = self.angle, self.clock()
        self.percent, self.lasting, self.brakes_then = 0.0, 0.0, brake


@dataclass
class EmulatedSensor:
    """A sensor: type number, and the value that each mode measures."""

    type: int = NO_DEVICE
    values: dict[int, float] = field(default_factory=dict)
    mode: int = 0

    @property
    def value(self) -> float:
        return NAN if self.type == NO_DEVICE else self.values.get(self.mode, NAN)


class Cable:
    """The brick's end of a USB cable: frames in reports of 1024 bytes; it pads them with anything."""

    def __init__(self, end: socket.socket, violations: list[str]) -> None:
        self._end, self._violations = end, violations

    def fileno(self) -> int:
        return self._end.fileno()

    def recv(self, _size: int) -> bytes:
        written = self._end.recv(4096)
        if not written:
            return b""
        frame = written[1 : 3 + int.from_bytes(written[1:3], "little")]
        if written != b"\0" + frame.ljust(1024, b"\0"):
            self._violations.append(f"a report of {len(written)} bytes: {written[:20].hex(' ')}")
        return frame

    def sendall(self, data: bytes) -> None:
        if data:
            self._end.sendall(data.ljust(1024, b"\xaa"))

    def close(self) -> None:
        self._end.close()


class Wire(Line):
    """A connection that takes no time; where nothing has arrived, the time of waiting for it has passed."""

    def __init__(self, brick: Brick, clock: Hands) -> None:
        super().__init__("127.0.0.1", brick.serial)
        self.brick, self.clock = brick, clock
        self.arrived: list[bytes] = []
        self.is_cut = self.has_ended = False

    def send(self, data: bytes) -> int:
        if self.brick.plugged and not self.has_ended:
            with self.brick.hearing:
                self.brick.take(data)
        return len(data)

    def receive(self) -> bytes:
        if self.arrived:
            return self.arrived.pop(0)
        if self.has_ended:
            return b""
        self.brick.waits()
        self.clock.now += WAIT
        raise TimeoutError

    def cut(self) -> None:
        self.is_cut = True

    def close(self) -> None:
        if not self.has_ended:
            self.has_ended = True
            self.brick.left(self.is_cut)

    def sendall(self, data: bytes) -> None:
        """Send, as the brick does."""
        if data:
            self.arrived.append(data)

    def hang_up(self) -> None:
        """Close it, as the brick does."""
        self.has_ended = True


class Hands:
    """A clock that a test moves."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


class Brick:
    """The brick; it has one connection at a time, as the real one does.

    Parameters
    ----------
    beacon_port : int
        UDP port on the loopback that its beacon goes to; 0: no beacon, TCP is open at once.
    clock : callable
        The motors' time in seconds.
    for_ev3_dc : bool
        Where ev3-dc connects: it answers a beacon at the number of the TCP port, and does not wait
        until the brick has received it.
    tcp_port : int
        0: any free one.
    locked : bool
        Whether TCP expects the unlocking text; otherwise it stands for Bluetooth.
    serves : bool
        Whether it is on the loopback; otherwise it is reached by a wire only.
    """

    def __init__(
        self,
        beacon_port: int = 0,
        clock: Callable[[], float] = time.monotonic,
        for_ev3_dc: bool = False,
        tcp_port: int = 0,
        locked: bool = True,
        serves: bool = True,
    ) -> None:
        self.serial = "0016535a1b2c"
        self.name = "SLOWPOKE"
        self.motors = [EmulatedMotor(clock) for _ in range(4)]
        self.sensors = [EmulatedSensor() for _ in range(4)]
        self.battery = 87
        self.tones: list[tuple[int, int, int]] = []
        self.drawn: list[str] = []  # on the display, which shows it after an update
        self.shown: list[str] = []
        self.frames: list[bytes] = []
        self.commands: list[bytes] = []
        self.violations: list[str] = []
        self.greetings: list[bytes] = []
        self.connections = self.resets = self.goodbyes = self.beacons = self.answers = 0
        self.fault = ""
        """split, half, silent, close, refuse, merge, noise, other size: what happens to replies."""
        self.plugged = True
        self._locked = locked
        self._beacon_port = beacon_port
        self._for_ev3_dc = for_ev3_dc
        self._closing = False
        self.hearing = threading.Lock()
        self.waits: Callable[[], object] = lambda: None  # called when a wait for it times out
        self.port = tcp_port
        self._thread: threading.Thread | None = None
        self._voice: socket.socket | None = None
        self._listener: socket.socket | None = None
        self._connection: socket.socket | Cable | Wire | None = None
        self._buffer = b""
        self._unlocked = False
        if not serves:
            return
        self._door = self._hang_door()  # bound, but not listening: connections are refused
        self._next_beacon = 0.0
        self._work: list[Callable[[], None]] = []
        self._thread = threading.Thread(target=self._serve, name="emulated brick")
        self._start_services()
        self._thread.start()

    # what a person does to it

    def unplug(self) -> None:
        """The WiFi stick is unplugged: nothing is sent or received, and the motors keep turning."""
        self._do(self._stop_services)

    def plug_in(self) -> None:
        """The WiFi stick is back: connections are forgotten, and the beacon restarts."""
        self._do(self._start_services)

    def hang_up(self) -> None:
        """Close the connection in good order."""
        self._do(self._drop)

    def insert(self, left_over: bytes = b"") -> FileIO:
        """A USB cable is plugged in; return this computer's end of it, open as a device is."""
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        cable = Cable(theirs, self.violations)
        if left_over:
            cable.sendall(left_over)

        def connect() -> None:
            self._drop()
            self._connection, self._unlocked = cable, True
            self.connections += 1

        self._do(connect)
        return FileIO(ours.detach(), "r+")

    def wire(self, clock: Hands) -> Wire:
        """Connect to it without a network."""
        self._drop()
        wire = Wire(self, clock)
        self._connection, self._unlocked = wire, True
        self.connections += 1
        return wire

    def left(self, is_cut: bool) -> None:
        """The other end of the wire has closed it."""
        self.resets, self.goodbyes = self.resets + is_cut, self.goodbyes + (not is_cut)
        self._drop()

    def close(self) -> None:
        self._closing = True
        if self._thread is not None:
            self._thread.join(60)
            assert not self._thread.is_alive()

    def _do(self, work: Callable[[], None]) -> None:
        if self._thread is None:
            work()
            return
        done = threading.Event()
        self._work += [work, done.set]
        assert done.wait(60)

    # its thread

    def _serve(self) -> None:
        try:
            while not self._closing:
                while self._work:
                    self._work.pop(0)()
                self._send_beacon()
                if not self.plugged:
                    time.sleep(0.002)
                    continue
                ears = [s for s in (self._listener, self._voice, self._connection) if s is not None]
                for ready in select.select(ears, [], [], 0.005)[0]:
                    if ready is self._voice:
                        self._hear_answer()
                    elif ready is self._listener:
                        self._accept()
                    elif ready is self._connection:
                        self._receive()
        finally:
            self._stop_services()
            self._drop()
            self._door.close()

    def _start_services(self) -> None:
        self._drop()
        self.plugged = True
        if self._thread is None:
            return
        if self._beacon_port:
            self._voice = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self._voice.bind(("127.0.0.1", self.port if self._for_ev3_dc else 0))
            self._next_beacon = 0.0
        if not self._beacon_port or self._for_ev3_dc:
            self._listen()

    def _stop_services(self) -> None:
        self.plugged = False
        if self._voice is not None:
            self._voice.close()
        if self._listener is not None:
            self._listener.close()
            self._door = self._hang_door()
        self._voice = self._listener = None

    def _hang_door(self) -> socket.socket:
        door = socket.socket()
        door.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        door.bind(("127.0.0.1", self.port))
        self.port = door.getsockname()[1]
        return door

    def _listen(self) -> None:
        if self._listener is None:
            self._listener = self._door
            self._listener.listen(1)

    def _drop(self) -> None:
        if isinstance(self._connection, Wire):
            self._connection.hang_up()
        elif self._connection is not None:
            self._connection.close()
        self._connection, self._buffer, self._unlocked = None, b"", False

    def _send_beacon(self) -> None:
        if self._voice is None or self._connection is not None or time.monotonic() < self._next_beacon:
            return
        self._next_beacon = time.monotonic() + 0.03
        text = f"Serial-Number: {self.serial}\r\nPort: {self.port}\r\nName: {self.name}\r\nProtocol: EV3\r\n"
        with suppress(OSError):
            self._voice.sendto(text.encode(), ("127.0.0.1", self._beacon_port))
            self.beacons += 1

    def _hear_answer(self) -> None:
        assert self._voice is not None
        with suppress(OSError):  # an earlier beacon found no listener
            if len(self._voice.recv(100)) == 1:
                self.answers += 1
                self._listen()

    def _accept(self) -> None:
        assert self._listener is not None
        connection, _ = self._listener.accept()
        if self._connection is not None:
            connection.close()
            return
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._connection, self._unlocked = connection, not self._locked
        self.connections += 1

    def _receive(self) -> None:
        assert isinstance(self._connection, (socket.socket, Cable))
        try:
            data = self._connection.recv(4096)
        except ConnectionResetError:
            self.resets += 1
            self._drop()
            return
        if not data:
            self.goodbyes += 1
            self._drop()
            return
        self.take(data)

    def take(self, data: bytes) -> None:
        """Hear some bytes."""
        self._buffer += data
        if not self._unlocked:
            self._unlock()
            return
        while self._connection is not None and len(self._buffer) >= 2:
            end = 2 + int.from_bytes(self._buffer[:2], "little")
            if not 8 <= end <= 1024:
                self.violations.append(f"a frame of {end} bytes")
                self._drop()
            if len(self._buffer) < end:
                return
            received, self._buffer = self._buffer[:end], self._buffer[end:]
            self._obey(received)

    def _unlock(self) -> None:
        assert self._connection is not None
        if b"Protocol: EV3" not in self._buffer:
            return
        self.greetings.append(self._buffer)
        if not re.fullmatch(rb"GET /target\?sn=[\w:]*? ?VMTP1.0\r?\nProtocol: EV3", self._buffer):
            self.violations.append(f"unlocked with {self._buffer!r}")
            self._drop()
            return
        self._buffer, self._unlocked = b"", True
        with suppress(OSError):
            self._connection.sendall(b"Accept:EV340\r\n\r\n")

    def _obey(self, received: bytes) -> None:
        counter, kind, memory = struct.unpack_from("<HBH", received, 2)
        wants_reply, size = kind == 0, memory & 0x3FF
        self.frames.append(received)
        if not wants_reply:
            self.commands.append(received)
        if kind not in (0x00, 0x80):
            self.violations.append(f"a frame of type 0x{kind:02x}")
        if size and not wants_reply:
            self.violations.append("results without a reply")
        try:
            if self.fault == "refuse":
                raise RefusedError("told to refuse")
            results = run_code(self, received[7:], size)
            ok = True
        except RefusedError as error:
            if self.fault != "refuse":
                self.violations.append(f"{error} in {received.hex(' ')}")
            results, ok = b"", False
        if wants_reply:
            self._reply(struct.pack("<HHB", len(results) + 3, counter, 2 if ok else 4) + results, counter)

    def _reply(self, reply: bytes, counter: int) -> None:
        connection = self._connection
        assert connection is not None
        if self.fault == "close":
            self._drop()
            return
        if self.fault == "other size":
            reply = struct.pack("<HHB", 4, counter, 2) + b"\0"
        elif self.fault == "noise":
            reply = b"\xff\xff" + reply
        elif self.fault == "merge":
            reply = struct.pack("<HHB", 3, (counter - 1) % 65536, 4) + reply
        if self.fault == "silent":
            reply = b""
        elif self.fault == "half":
            reply = reply[: len(reply) // 2]
        pieces = [reply[i : i + 1] for i in range(len(reply))] if self.fault == "split" else [reply]
        with suppress(OSError):
            for piece in pieces:
                connection.sendall(piece)


def run_code(brick: Brick, code: bytes, size: int) -> bytes:
    """Decode and execute a byte code; return the globals that it wrote."""
    results = bytearray(size)
    at = 0
    while at < len(code):
        head = code[at : at + 1] if code[at : at + 1] in OPERATIONS else code[at : at + 2]
        if head not in OPERATIONS:
            raise RefusedError(f"unknown operation {head.hex()}")
        at += len(head)
        name, shape = OPERATIONS[head]
        arguments: list[int | str] = []
        named: dict[str, int] = {}
        places: list[tuple[str, int]] = []
        for word in shape.split():
            if word == "string":
                end = code.find(b"\0", at)
                if code[at : at + 1] != b"\x84" or end < 0:
                    raise RefusedError(f"{name}: no string")
                arguments.append(code[at + 1 : end].decode("ascii"))
                at = end + 1
                continue
            times = named.get("count", 1) if word.startswith(">") else 1
            for _ in range(times):
                where, value, at = decode_parameter(code, at)
                if word.startswith(">"):
                    if where != "global":
                        raise RefusedError(f"{name} writes into a {where}")
                    places.append((word[1:].replace("s", f"{named.get('length', 0)}s"), value))
                else:
                    if where != "constant":
                        raise RefusedError(f"{name} reads a {where}")
                    if value not in RANGES[word]:
                        raise RefusedError(f"{name}: {word} is {value}")
                    named[word] = value
                    arguments.append(value)
        values = getattr(Operations, name)(brick, *arguments) or ()
        for (kind, place), value in zip(places, values, strict=True):
            if place + struct.calcsize("<" + kind) > size:
                raise RefusedError(f"{name} writes beyond the {size} bytes of its reply")
            if kind in "if" and place % 4:
                raise RefusedError(f"{name} writes 32 bits at the odd place {place}")
            struct.pack_into("<" + kind, results, place, value)
    return bytes(results)


def decode_parameter(code: bytes, at: int) -> tuple[str, int, int]:
    """Read one parameter: what it is, its value, and where the next one begins."""
    if at >= len(code):
        raise RefusedError("the code ends within an operation")
    first = code[at]
    kind = ("global" if first & 0x20 else "local") if first & 0x40 else "constant"
    if not first & 0x80:
        if kind == "constant":
            return kind, (first & 0x3F) - ((first & 0x20) << 1), at + 1
        return kind, first & 0x1F, at + 1
    length = {1: 1, 2: 2, 3: 4}.get(first & 0x07, 0)
    data = code[at + 1 : at + 1 + length]
    if not length or len(data) < length:
        raise RefusedError(f"parameter 0x{first:02x} is cut or unknown")
    value = int.from_bytes(data, "little", signed=kind == "constant")
    if kind == "constant" and value == -(1 << (8 * length - 1)):
        raise RefusedError(f"{value} in {length} bytes is the brick's NaN")
    return kind, value, at + 1 + length


class Operations:
    """The operations: each gets the brick and its constants, and returns its results."""

    @staticmethod
    def _chosen(brick: Brick, ports: int) -> list[EmulatedMotor]:
        return [motor for i, motor in enumerate(brick.motors) if ports & 1 << i]

    def speed(brick, layer, ports, percent):  # noqa: N805
        for motor in Operations._chosen(brick, ports):
            motor.setting = percent
            if motor.turning:
                motor.run(percent, motor.ends - motor.clock(), motor.brakes_then)

    power = speed

    def start(brick, layer, ports):  # noqa: N805
        for motor in Operations._chosen(brick, ports):
            motor.start()

    def stop(brick, layer, ports, brake):  # noqa: N805
        for motor in Operations._chosen(brick, ports):
            motor.stop(bool(brake))

    def step_speed(brick, layer, ports, percent, up, steady, down, brake):  # noqa: N805
        seconds = (up + steady + down) / (abs(percent) * DEGREES_PER_PERCENT) if percent else 0.0
        for motor in Operations._chosen(brick, ports):
            motor.run(percent, seconds, bool(brake))

    def time_speed(brick, layer, ports, percent, up, steady, down, brake):  # noqa: N805
        for motor in Operations._chosen(brick, ports):
            motor.run(percent, (up + steady + down) / 1000, bool(brake))

    def time_power(brick, layer, ports, percent, up, steady, down, brake):  # noqa: N805
        for motor in Operations._chosen(brick, ports):
            motor.run(percent, (up + steady + down) / 1000, bool(brake), False)

    def reset(brick, layer, ports):  # noqa: N805
        for motor in Operations._chosen(brick, ports):
            motor.tacho_zero = motor.angle

    def clear_count(brick, layer, ports):  # noqa: N805
        for motor in Operations._chosen(brick, ports):
            motor.zero = motor.angle

    def get_count(brick, layer, number):  # noqa: N805
        return (round(brick.motors[number].angle - brick.motors[number].zero),)

    def read(brick, layer, number):  # noqa: N805
        motor = brick.motors[number]
        return round(0 if motor.is_held else motor.turning), round(motor.angle - motor.tacho_zero)

    def test(brick, layer, ports):  # noqa: N805
        return (int(any(motor.turning for motor in Operations._chosen(brick, ports))),)

    def type_mode(brick, layer, number):  # noqa: N805
        if number >= 16:
            return brick.motors[number - 16].type, 0
        return brick.sensors[number].type, brick.sensors[number].mode

    def read_si(brick, layer, number, kind, mode):  # noqa: N805
        if number >= 16:
            motor = brick.motors[number - 16]
            return (motor.angle - motor.zero,)
        sensor = brick.sensors[number]
        if kind not in (0, sensor.type):
            raise RefusedError(f"sensor type {kind} is wanted, {sensor.type} is there")
        if mode >= 0:
            sensor.mode = mode
        return (sensor.value,)

    def ready_si(brick, layer, number, kind, mode, count):  # noqa: N805
        return Operations.read_si(brick, layer, number, kind, mode) * count

    def ready_percent(brick, layer, number, kind, mode, count):  # noqa: N805
        return tuple(map(round, Operations.ready_si(brick, layer, number, kind, mode, count)))

    ready_raw = ready_percent

    def tone(brick, volume, frequency, duration):  # noqa: N805
        brick.tones.append((volume, frequency, duration))

    def fill_window(brick, colour, first, height):  # noqa: N805
        assert (colour, first, height) == (0, 0, 0), "all of it, white"
        brick.drawn = []

    def font(brick, number):  # noqa: N805
        pass

    def write(brick, colour, column, row, text):  # noqa: N805
        if len(text) * 8 + column > 178 or row + 9 > 128:
            raise RefusedError(f"{text!r} does not fit on the display")
        brick.drawn.append(text)

    def update(brick):  # noqa: N805
        brick.shown = list(brick.drawn)

    def voltage(brick):  # noqa: N805
        return (7.5,)

    def current(brick):  # noqa: N805
        return (0.2,)

    def battery(brick):  # noqa: N805
        return (brick.battery,)

    def text(brick, length):  # noqa: N805
        return (b"V1.09H",)

    def memory(brick):  # noqa: N805
        return 6000, 1000

    def volume(brick):  # noqa: N805
        return (50,)

    def minutes(brick):  # noqa: N805
        return (30,)

    def name(brick, length):  # noqa: N805
        return (brick.name.encode()[: length - 1],)

    def network(brick, hardware, length):  # noqa: N805
        return b"school", b"0016535a1b2c", b"127.0.0.1"
