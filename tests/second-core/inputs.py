"""The two inputs: the image, an ELF file, and the trace that `cargo board --trace` writes."""

import bisect
import struct
from typing import NamedTuple

MAGIC = b"limpid trace  1\n"
LOAD, READ, WRITE, ENTRY, HOST_WRITE, HOST_READ, RESET, END = range(1, 9)
WITH_BYTES = (LOAD, HOST_WRITE, HOST_READ)


class Unusable(Exception):
    """An input that cannot be used."""


class Event(NamedTuple):
    """A record of the trace; virtual-board/src/trace.rs describes it."""

    kind: int
    size: int
    number: int
    address: int
    value: int
    count: int
    bytes: bytes = b""


def fnv1a(data):
    """FNV-1a, 64 bits."""
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


def read_file(path):
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError as error:
        raise Unusable(f"{path}: {error.strerror}") from error


def read_trace(path, image_hash):
    """The events of a trace; `image_hash` is that of its image, or None for any image."""
    data = read_file(path)
    if data[:16] != MAGIC or len(data) < 24:
        raise Unusable(f"{path}: not a trace of this version; write one with cargo board --trace")
    (of,) = struct.unpack_from("<Q", data, 16)
    if image_hash is not None and of != image_hash:
        raise Unusable(f"{path}: the trace of another image; write one with cargo board --trace")
    events, at = [], 24
    while at < len(data):
        try:
            record = struct.unpack_from("<BBHIIQ", data, at)
        except struct.error:
            raise Unusable(f"{path}: ends inside the record at byte {at}") from None
        kind, length = record[0], record[4]
        if not LOAD <= kind <= END or (kind in (READ, WRITE) and record[1] not in (1, 2, 4)):
            raise Unusable(f"{path}: no record at byte {at}")
        at += 20
        if kind in WITH_BYTES:
            events.append(Event(*record, data[at : at + length]))
            at += length
        else:
            events.append(Event(*record))
    if at != len(data) or not events or events[-1].kind != END:
        raise Unusable(f"{path}: the end is missing; write it again with cargo board --trace")
    return events


class Image:
    """The segments and symbols of a 32-bit little-endian ELF file."""

    def __init__(self, path, data=None):
        self.data = read_file(path) if data is None else data
        try:
            self._parse()
        except (struct.error, IndexError, ValueError):
            raise Unusable(f"{path}: not an ELF file of the firmware") from None

    def _parse(self):
        data = self.data
        if data[:6] != b"\x7fELF\x01\x01":
            raise ValueError
        program, sections = struct.unpack_from("<II", data, 28)
        size, count, section_size, section_count = struct.unpack_from("<HHHH", data, 42)
        # Physical address, offset in the file, length.
        self.segments = []
        for header in range(program, program + size * count, size):
            kind, offset, _, address, length = struct.unpack_from("<IIIII", data, header)
            if kind == 1 and length > 0:
                self.segments.append((address, offset, length))
        self.symbols, functions = {}, []
        for header in range(sections, sections + section_size * section_count, section_size):
            kind, _, _, offset, length, link = struct.unpack_from("<IIIIII", data, header + 4)
            if kind != 2:
                continue
            (names,) = struct.unpack_from("<I", data, sections + section_size * link + 16)
            for entry in range(offset, offset + length, 16):
                name, value, _, info = struct.unpack_from("<IIIB", data, entry)
                text = data[names + name : data.index(b"\0", names + name)].decode()
                self.symbols[text] = value
                if info & 0xF == 2:
                    functions.append((value & ~1, text))
        self._functions = sorted(functions)
        if "_SEGGER_RTT" not in self.symbols:
            raise ValueError

    def name(self, pc):
        """The function that this address is in."""
        at = bisect.bisect_right(self._functions, (pc, "\x7f")) - 1
        return self._functions[at][1] if at >= 0 else "no function"

    def offset(self, address):
        """Where the byte at this address is in the file; None if nowhere."""
        for start, offset, length in self.segments:
            if start <= address < start + length:
                return offset + address - start
        return None
